"""Our trajectory and our g(r), judged by mdtraj."""

from __future__ import annotations

import mdtraj
import numpy as np

import lennard_validation as lv

#: Relative spacing of the single-precision numbers that mdtraj holds.
SINGLE = float(np.finfo(np.float32).eps)


def test_frames_positions_cell_and_times_are_those_of_the_file(every_step):
    trajectory = lv.load_trajectory(every_step.folder)
    frames = lv.load_frames(every_step.folder)
    assert trajectory.n_frames == len(frames) == 40
    assert trajectory.n_atoms == 400
    positions = np.array([frame.positions for frame in frames])
    # One rounding to single precision and one division by ten.
    np.testing.assert_allclose(trajectory.xyz, positions / 10.0, rtol=2 * SINGLE, atol=0.0)
    np.testing.assert_allclose(
        trajectory.unitcell_lengths, np.tile([0.68, 0.85, 0.825], (40, 1)), rtol=2 * SINGLE
    )
    np.testing.assert_allclose(trajectory.unitcell_angles, 90.0, rtol=2 * SINGLE)
    np.testing.assert_array_equal(trajectory.time, [frame.info["Time"] for frame in frames])


def test_topology_names_argon_and_the_box(every_step):
    structure = mdtraj.load(str(every_step.folder / "topology.gro"))
    assert structure.n_atoms == structure.n_residues == 400
    assert {atom.element.symbol for atom in structure.topology.atoms} == {"Ar"}
    # The GRO format has five decimals.
    np.testing.assert_allclose(structure.unitcell_lengths, [[0.68, 0.85, 0.825]], atol=1e-5)


def pair_distribution(run: lv.Run) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """r (in sigma) and g(r) by mdtraj, and g(r) by us, in the same bins from the same frames."""
    trajectory = lv.load_trajectory(run.folder)
    options = next(o for o in run.scene["observable"] if o["kind"] == "rdf")
    pairs = trajectory.topology.select_pairs("all", "all")
    r, g = mdtraj.compute_rdf(
        trajectory, pairs, r_range=(0.0, options["r_max"] / 10.0), n_bins=options["bins"]
    )
    return 10.0 * r, g, np.array(run.table("rdf")["g"])


def pairs_in_bins(run: lv.Run) -> np.ndarray:
    """Pairs that each bin of our g(r) has counted, over all frames."""
    table = run.table("rdf")
    r, g = np.array(table["r"]), np.array(table["g"])
    width = r[1] - r[0]
    n = run.record["atoms"]
    volume = n / 0.8442
    shell = 4.0 / 3.0 * np.pi * ((r + width / 2) ** 3 - (r - width / 2) ** 3)
    return g * len(lv.expected_steps(run)) * n * (n - 1) / 2.0 * shell / volume


def test_radial_distribution_function_is_mdtrajs(sampled):
    r, theirs, ours = pair_distribution(sampled)
    np.testing.assert_allclose(sampled.table("rdf")["r"], r, rtol=1e-5)
    # Coordinates of up to 0.84 nm are rounded to half a spacing of 6e-8, so a distance moves by less than
    # 1e-6 sigma. This fraction of the pairs in a bin of 0.025 sigma may change over to the next bin.
    counted = pairs_in_bins(sampled)
    scale = np.divide(theirs, counted, out=np.zeros_like(theirs), where=counted > 0)
    moved = 2.0 * (1e-6 / 0.025) * counted
    # Such a number of rare events scatters by its root; four of these, and one for an empty bin.
    allowed = (moved + 4.0 * np.sqrt(moved) + 1.0) * scale
    assert (np.abs(ours - theirs) <= allowed + 1e-6 * theirs).all()
    # And it is a liquid's: excluded core, first shell, second shell.
    assert ours[r < 0.8].max() == 0.0
    assert 2.5 < ours.max() < 3.2 and 1.0 < r[ours.argmax()] < 1.15
    assert allowed.max() < 0.01 * ours.max()


def test_coordination_number_is_the_integral_of_the_same_curve(sampled):
    r, g, _ = pair_distribution(sampled)
    width = r[1] - r[0]
    shell = 4.0 / 3.0 * np.pi * ((r + width / 2) ** 3 - (r - width / 2) ** 3)
    n = sampled.record["atoms"]
    inside = np.cumsum(g * shell) * 0.8442 * (n - 1) / n
    minimum = np.argmax(r > 1.3) + g[(r > 1.3) & (r < 1.8)].argmin()
    ours = sampled.averages["coordination_number"]["mean"]
    # The place of the flat minimum is uncertain by two bins.
    assert inside[minimum - 2] < ours < inside[minimum + 2]
