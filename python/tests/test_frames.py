"""Frames in memory, judged by the packages that they are made for."""

from __future__ import annotations

import lennard
import numpy as np
import pytest


@pytest.fixture(scope="module")
def run():
    simulation = lennard.Simulation.liquid(density=0.7, temperature=1.2, n=256, seed=5)
    simulation.equilibrate(200)
    # The program takes g(r) from the same frames.
    return simulation.run(400, trajectory_every=20, measure=[lennard.observable.rdf(every=20)])


def test_frames_are_states(run):
    frames = run.frames
    assert len(frames) == 20 and frames.positions.shape == (20, 256, 3)
    assert frames.velocities.shape == frames.positions.shape and frames.forces is None
    assert list(frames.step[:2]) == [220, 240]
    assert np.all(frames.wrapped >= 0) and np.all(frames.wrapped <= frames.box[:, None, :])
    kinetic = 0.5 * (frames.velocities[-1] ** 2).sum() / 256
    temperature = 2 * 256 * kinetic / (3 * 256 - 3)
    assert temperature == pytest.approx(run.thermo["temperature"][-1], rel=1e-12)


def test_frames_makes_a_stage():
    simulation = lennard.Simulation.liquid(density=0.7, temperature=1.2, n=108, r_cut=2.2)
    frames = simulation.frames(every=10, n=7, output={"forces": True})
    assert len(frames) == 7 and frames.forces.shape == (7, 108, 3)
    assert np.array_equal(frames.forces[-1], simulation.forces)


def counts(distances: np.ndarray, edges: np.ndarray) -> np.ndarray:
    return np.histogram(distances, edges)[0]


def edges_of(run) -> np.ndarray:
    r = run.rdf["r"]
    half = 0.5 * (r[1] - r[0])
    return np.append(r - half, r[-1] + half)


def pair_function(found: np.ndarray, run, edges: np.ndarray) -> np.ndarray:
    n, volume = 256, float(np.prod(run.frames.box[0]))
    shells = 4 / 3 * np.pi * np.diff(edges**3)
    return found / len(run.frames) / (0.5 * n * (n - 1) / volume * shells)


def test_mdtraj_finds_our_g_of_r(run):
    mdtraj = pytest.importorskip("mdtraj")
    trajectory = run.frames.to_mdtraj()
    assert trajectory.n_frames == 20 and trajectory.n_atoms == 256
    assert np.allclose(trajectory.time, run.frames.time)
    pairs = trajectory.topology.select_pairs("all", "all")
    edges = edges_of(run)
    found = counts(mdtraj.compute_distances(trajectory, pairs).ravel(), edges)
    judge(run, pair_function(found, run, edges))


def test_mdanalysis_finds_our_g_of_r(run):
    pytest.importorskip("MDAnalysis")
    from MDAnalysis.lib.distances import self_distance_array

    universe = run.frames.to_mdanalysis()
    assert len(universe.trajectory) == 20 and len(universe.atoms) == 256
    edges = edges_of(run)
    found = np.zeros(len(edges) - 1)
    for k, step in enumerate(universe.trajectory):
        assert step.time == pytest.approx(run.frames.time[k], rel=1e-6)
        found += counts(self_distance_array(universe.atoms.positions, box=universe.dimensions), edges)
    assert np.allclose(universe.trajectory[-1].velocities, run.frames.velocities[-1], atol=1e-6)
    judge(run, pair_function(found, run, edges))


def test_ase_finds_our_g_of_r(run):
    pytest.importorskip("ase")
    images = run.frames.to_ase(sigma=3.405)
    assert len(images) == 20 and images[0].get_chemical_formula() == "Ar256"
    edges = edges_of(run)
    found = np.zeros(len(edges) - 1)
    for atoms in images:
        distances = atoms.get_all_distances(mic=True)[np.triu_indices(256, 1)]
        found += counts(distances / 3.405, edges)
    judge(run, pair_function(found, run, edges))


def judge(run, g: np.ndarray) -> None:
    """Equal but for pairs that single precision moves over the edge of a bin."""
    ours = run.rdf["g"]
    one_pair = pair_function(np.ones(len(ours)), run, edges_of(run))
    inside = run.rdf["r"] > 0.8
    assert np.abs(g - ours)[inside].max() <= 3 * one_pair[inside].max()
    assert np.median(np.abs(g - ours)[inside]) < 1e-9


@pytest.mark.parametrize("whole", [True, False])
def test_molecules_stay_whole_in_frames_unless_the_scene_says_otherwise(whole):
    simulation = lennard.Simulation.liquid(
        density=0.4, temperature=2.0, n=108, r_cut=2.5, molecule={"bond_length": 0.67}, output={"whole": whole}
    )
    simulation.equilibrate(600)
    frames = simulation.frames(every=50, n=4)

    def longest(positions: np.ndarray) -> float:
        return float(np.linalg.norm(positions[:, ::2] - positions[:, 1::2], axis=-1).max())

    assert longest(frames.positions) < 0.68
    assert (longest(frames.wrapped) < 0.68) == whole
    inside = frames.wrapped[:, ::2] / frames.box[:, None, :]
    assert inside.min() >= 0 and inside.max() <= 1
    mdtraj = pytest.importorskip("mdtraj")
    assert isinstance(frames.to_mdtraj(), mdtraj.Trajectory)
    assert (longest(frames.to_mdtraj().xyz) < 0.68) == whole
