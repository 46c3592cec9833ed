"""Trajectories of every format, read by ase, mdtraj, MDAnalysis and OVITO; files of other programs as starts.

Every reader that `docs/formats.md` names is asked for what that page says it gets.
"""

from __future__ import annotations

import warnings
from pathlib import Path

import ase.io
import ase.units
import mdtraj
import numpy as np
import pytest

import lennard_validation as lv
from conftest import Scene

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import MDAnalysis

#: Relative spacing of single-precision numbers.
SINGLE = float(np.finfo(np.float32).eps)

#: OVITO takes digits for numbers with roundings of its own.
PARSED = 1e-15

SIDES = (6.8, 8.5, 8.25)
FRAMES = 5
FILES = {
    "xyz": "trajectory.xyz",
    "xyz.gz": "trajectory.xyz.gz",
    "lammps-dump": "trajectory.lammpstrj",
    "xtc": "trajectory.xtc",
}


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> dict[str, lv.Run]:
    """The same short run of a mixture with its trajectory in each format."""
    folder = tmp_path_factory.mktemp("formats")
    scene = Scene(
        n_atoms=400,
        box=SIDES,
        equilibrate=200,
        steps=100,
        truncation='kind = "shift"\nr_cut = 2.5',
        output="trajectory_every = 20",
        extra='[[species]]\nname = "Ar"\nfraction = 0.75\n[[species]]\nname = "Kr"\nfraction = 0.25\nmass = 2.1\n'
        '[mixing]\nrule = "lorentz-berthelot"\n',
    )
    path = scene.write(folder)

    def run(form: str, **settings) -> lv.Run:
        settings = {f"output.{key}": value for key, value in settings.items()}
        return lv.run(path, out=folder / form, settings={"output.format": form.split("-for-")[0]} | settings)

    return {
        "xyz": run("xyz", forces="true"),
        "xyz.gz": run("xyz.gz", forces="true"),
        "lammps-dump": run("lammps-dump", forces="true"),
        "xtc": run("xtc", precision="1e5"),
        "xyz-for-ase": run("xyz-for-ase", forces="true", ase="true"),
    }


@pytest.fixture(scope="module")
def frames(runs) -> list[ase.Atoms]:
    """The frames as text has them, with every digit."""
    frames = ase.io.read(runs["xyz"].folder / "trajectory.xyz", index=":", format="extxyz")
    assert len(frames) == FRAMES
    return frames


def path(runs: dict[str, lv.Run], form: str) -> str:
    return str(runs[form].folder / FILES[form])


def topology(runs: dict[str, lv.Run], form: str) -> str:
    return str(runs[form].folder / "topology.gro")


def universe(runs: dict[str, lv.Run], form: str, reader: str):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return MDAnalysis.Universe(topology(runs, form), path(runs, form), format=reader)


def of(frames: list[ase.Atoms], get) -> np.ndarray:
    return np.array([get(frame) for frame in frames])


def test_ase_reads_from_gzip_what_it_reads_from_text(runs, frames):
    compressed = ase.io.read(path(runs, "xyz.gz"), index=":", format="extxyz")
    assert len(compressed) == FRAMES
    for ours, theirs in zip(compressed, frames, strict=True):
        assert ours == theirs and ours.info == theirs.info
        np.testing.assert_array_equal(ours.arrays["velo"], theirs.arrays["velo"])
        np.testing.assert_array_equal(ours.get_forces(), theirs.get_forces())


def test_the_helpers_read_gzip_and_refuse_what_has_no_headers(runs, frames):
    helped = lv.load_frames(runs["xyz.gz"].folder)
    assert [frame.info["Step"] for frame in helped] == [frame.info["Step"] for frame in frames]
    assert lv.load_trajectory(runs["xyz.gz"].folder).n_frames == FRAMES
    with pytest.raises(lv.BadTrajectory, match="in the format xtc; this reads xyz and xyz.gz"):
        lv.load_frames(runs["xtc"].folder)


def test_mdtraj_and_mdanalysis_read_positions_from_gzip(runs, frames):
    positions = of(frames, lambda frame: frame.positions)
    trajectory = mdtraj.load(path(runs, "xyz.gz"), top=topology(runs, "xyz.gz"))
    np.testing.assert_allclose(trajectory.xyz, positions / 10.0, rtol=2 * SINGLE)
    read = universe(runs, "xyz.gz", "XYZ")
    found = np.array([step.positions.copy() for step in read.trajectory])
    np.testing.assert_allclose(found, positions, rtol=SINGLE)


def test_ase_reads_a_dump(runs, frames):
    read = ase.io.read(path(runs, "lammps-dump"), index=":", format="lammps-dump-text")
    assert len(read) == FRAMES
    for ours, theirs in zip(read, frames, strict=True):
        np.testing.assert_array_equal(ours.positions, theirs.positions)
        np.testing.assert_array_equal(ours.cell.lengths(), SIDES)
        assert ours.pbc.all() and ours.symbols.get_chemical_formula() == theirs.symbols.get_chemical_formula()
        np.testing.assert_array_equal(ours.get_forces(), theirs.get_forces())
        # It takes velocities for angstrom per picosecond.
        picosecond = 1000.0 * ase.units.fs
        np.testing.assert_allclose(ours.get_velocities() * picosecond, theirs.arrays["velo"], rtol=1e-14)


def test_mdtraj_reads_a_dump_with_its_box(runs, frames):
    read = mdtraj.load(path(runs, "lammps-dump"), top=topology(runs, "lammps-dump"))
    positions = of(frames, lambda frame: frame.positions)
    np.testing.assert_allclose(read.xyz, positions / 10.0, rtol=2 * SINGLE)
    np.testing.assert_allclose(read.unitcell_lengths, np.tile(SIDES, (FRAMES, 1)) / 10.0, rtol=2 * SINGLE)


def test_mdanalysis_reads_a_dump_with_box_velocities_and_forces(runs, frames):
    read = universe(runs, "lammps-dump", "LAMMPSDUMP")
    assert len(read.trajectory) == FRAMES
    for step, frame in zip(read.trajectory, frames, strict=True):
        np.testing.assert_allclose(step.positions, frame.positions, rtol=SINGLE)
        np.testing.assert_allclose(step.velocities, frame.arrays["velo"], rtol=SINGLE)
        np.testing.assert_allclose(step.forces, frame.get_forces(), rtol=SINGLE)
        np.testing.assert_allclose(step.dimensions, [*SIDES, 90.0, 90.0, 90.0], rtol=SINGLE)
        assert step.data["step"] == frame.info["Step"]


def ovito_frames(runs: dict[str, lv.Run], form: str) -> list:
    """Every frame as OVITO has it."""
    reader = pytest.importorskip("ovito.io", reason="OVITO is not installed (pip install ovito)")
    pipeline = reader.import_file(path(runs, form))
    return [pipeline.compute(k) for k in range(pipeline.source.num_frames)]


@pytest.mark.parametrize("form", ["xyz", "lammps-dump"])
def test_ovito_reads_text(runs, frames, form):
    read = ovito_frames(runs, form)
    assert len(read) == FRAMES
    for data, frame in zip(read, frames, strict=True):
        found = data.particles
        np.testing.assert_allclose(found.positions[...], frame.positions, rtol=PARSED)
        np.testing.assert_allclose(found["Velocity"][...], frame.arrays["velo"], rtol=PARSED)
        np.testing.assert_allclose(found["Force"][...], frame.get_forces(), rtol=PARSED)
        np.testing.assert_array_equal(found["Periodic Image"][...], frame.arrays["map_shift"])
        np.testing.assert_array_equal(data.cell[...], np.c_[np.diag(SIDES), np.zeros(3)])
        names = [found.particle_types.type_by_id(kind).name for kind in found.particle_types[...]]
        # A dump has its types as numbers: the species in the order of the scene.
        wanted = frame.get_chemical_symbols()
        assert names == wanted or found.particle_types[...].tolist() == [1 + (w == "Kr") for w in wanted]
        step = data.attributes["Step" if form == "xyz" else "Timestep"]
        assert step == frame.info["Step"]


def test_ovito_reads_the_first_frame_of_gzip_alone(runs, frames):
    (data,) = ovito_frames(runs, "xyz.gz")
    np.testing.assert_allclose(data.particles.positions[...], frames[0].positions, rtol=PARSED)


def test_ovito_reads_xtc_with_its_box(runs, frames):
    read = ovito_frames(runs, "xtc")
    assert len(read) == FRAMES
    for data, frame in zip(read, frames, strict=True):
        # It takes a unit of length for a nanometre, and has the box around the origin.
        cell = data.cell[...]
        np.testing.assert_allclose(cell[:, :3], 10.0 * np.diag(SIDES), rtol=2 * SINGLE)
        found = (data.particles.positions[...] - cell[:, 3]) / 10.0
        assert np.abs(found - frame.positions).max() < 0.5e-5 + 2 * max(SIDES) * SINGLE
        assert data.attributes["Timestep"] == frame.info["Step"]


def test_mdtraj_and_mdanalysis_read_xtc_within_half_its_precision(runs, frames):
    positions = of(frames, lambda frame: frame.positions)
    times = of(frames, lambda frame: frame.info["Time"])
    # Half a multiple of 1e-5, and a rounding of numbers up to the box.
    allowed = 0.5e-5 + max(SIDES) * SINGLE
    trajectory = mdtraj.load(path(runs, "xtc"), top=topology(runs, "xtc"))
    assert np.abs(trajectory.xyz - positions).max() < allowed
    np.testing.assert_array_equal(trajectory.unitcell_lengths, np.tile(np.float32(SIDES), (FRAMES, 1)))
    np.testing.assert_allclose(trajectory.time, times, rtol=SINGLE)
    assert [atom.element.symbol for atom in trajectory.topology.atoms] == frames[0].get_chemical_symbols()
    # It takes a unit of length for a nanometre and turns it into ten angstrom.
    read = universe(runs, "xtc", "XTC")
    found = np.array([step.positions.copy() for step in read.trajectory]) / 10.0
    assert np.abs(found - positions).max() < allowed + max(SIDES) * SINGLE
    np.testing.assert_allclose(read.dimensions, [*np.multiply(SIDES, 10.0), 90.0, 90.0, 90.0], rtol=2 * SINGLE)
    assert np.abs(trajectory.xyz - positions).max() > 1e-6, "positions are rounded"


def test_xtc_takes_less_than_eight_bytes_an_atom(runs):
    size = Path(path(runs, "xtc")).stat().st_size
    assert size < 8.0 * FRAMES * 400
    assert size < Path(path(runs, "xyz")).stat().st_size / 15


def test_the_topology_has_the_start_positions(runs):
    start = mdtraj.load(topology(runs, "xyz"))
    read = ase.io.read(topology(runs, "xyz"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        third = MDAnalysis.Universe(topology(runs, "xyz"))
    assert start.xyz.std() > 0.1
    np.testing.assert_allclose(read.positions, 10.0 * start.xyz[0], atol=1e-5)
    np.testing.assert_allclose(third.atoms.positions, 10.0 * start.xyz[0], atol=1e-5)
    # Sites of an fcc lattice, to the three decimals of the format in nm.
    height = np.unique(np.round(read.positions[:, 2], 2))
    assert len(height) == 10


def test_ase_has_momenta_masses_and_energies_where_asked_for(runs, frames):
    asked = ase.io.read(runs["xyz-for-ase"].folder / "trajectory.xyz", index=":", format="extxyz")
    for ours, plain in zip(asked, frames, strict=True):
        masses = np.where(np.array(plain.get_chemical_symbols()) == "Kr", 2.1, 1.0)
        np.testing.assert_array_equal(ours.get_masses(), masses)
        np.testing.assert_allclose(ours.get_momenta(), masses[:, None] * plain.arrays["velo"], rtol=1e-15)
        assert ours.get_potential_energy() == plain.info["total_potential_energy"]
        assert ours.get_kinetic_energy() == pytest.approx(plain.info["total_kinetic_energy"], rel=1e-13)
        np.testing.assert_array_equal(ours.get_forces(), plain.get_forces())
        assert plain.get_kinetic_energy() == 0.0, "plain frames have no momenta"


def energy_of(runs: dict[str, lv.Run], configuration: Path, tmp_path: Path) -> dict:
    scene = runs["xyz"].folder.parent / "scene.toml"
    text = scene.read_text(encoding="utf-8")
    text = f'start = {{ kind = "file", file = "{configuration.as_posix()}" }}\n{text}'
    text = text.replace("n_atoms = 400\n", "").replace(f"box = {list(SIDES)}\n", "")
    text = text.replace("fraction = 0.75\n", "").replace("fraction = 0.25\n", "")
    changed = tmp_path / "start.toml"
    changed.write_text(text, encoding="utf-8")
    return lv.energy(changed)


def test_dumps_gzip_and_data_files_start_a_run_where_it_was(runs, frames, tmp_path):
    wanted = energy_of(runs, runs["xyz"].folder / "trajectory.xyz", tmp_path)
    for form in ("xyz.gz", "lammps-dump"):
        found = energy_of(runs, runs[form].folder / FILES[form], tmp_path)
        for key in ("potential_energy", "virial", "temperature"):
            assert found[key] == pytest.approx(wanted[key], rel=1e-11)
    # A data file that ase writes, whose types are the elements in the order of the scene.
    last = frames[-1]
    last.set_masses(np.where(np.array(last.get_chemical_symbols()) == "Kr", 2.1, 1.0))
    last.set_velocities(last.arrays["velo"])
    data = tmp_path / "ase.data"
    ase.io.write(data, last, format="lammps-data", specorder=["Ar", "Kr"], masses=True, velocities=True, units="metal")
    found = energy_of(runs, data, tmp_path)
    assert found["potential_energy"] == pytest.approx(wanted["potential_energy"], rel=1e-9)
    assert found["temperature"] == pytest.approx(wanted["temperature"] * (1000.0 * ase.units.fs) ** 2, rel=1e-6)
