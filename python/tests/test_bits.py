"""The package and the command line compute the same bits."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import lennard
import numpy as np
import pytest

from scenes import SCENES

FILES = ["thermo.csv", "final.xyz", "scene.toml", "trajectory.xyz", "rdf.csv", "msd.csv"]


@pytest.fixture(scope="module")
def by_command_line(tmp_path_factory, command_line):
    """The folder of a scene's run from the command line."""
    made: dict[str, tuple[Path, Path]] = {}

    def folder(name: str) -> tuple[Path, Path]:
        if name not in made:
            at = tmp_path_factory.mktemp(name)
            scene = at / f"{name}.toml"
            scene.write_text(SCENES[name])
            command_line("run", scene, "--out", at / "run", "--threads", 1, "--quiet")
            made[name] = (scene, at / "run")
        return made[name]

    return folder


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("name", SCENES)
def test_files_are_equal_byte_for_byte(name, threads, by_command_line, tmp_path):
    scene, folder = by_command_line(name)
    lennard.Simulation(scene, threads=threads).run_in_folder(tmp_path / "run")
    compared = 0
    for file in FILES:
        if (folder / file).exists():
            assert (tmp_path / "run" / file).read_bytes() == (folder / file).read_bytes(), file
            compared += 1
    assert compared >= 3
    assert (tmp_path / "run" / "report.html").exists() == (folder / "report.html").exists()


@pytest.mark.parametrize("name", SCENES)
def test_a_run_in_memory_measures_the_same(name, by_command_line):
    scene, folder = by_command_line(name)
    run = lennard.Simulation(scene).run()
    record = json.loads((folder / "run.json").read_text())
    assert run.record["averages"] == record["averages"]
    assert run.record["comparison"] == record["comparison"]
    assert run.record["neighbor"] == record["neighbor"]
    rows = np.genfromtxt(folder / "thermo.csv", delimiter=",", names=True)
    assert list(run.thermo["step"]) == list(rows["step"])
    assert {"time", "temperature", "potential_energy", "pressure"} <= set(rows.dtype.names)
    for column in rows.dtype.names:
        assert np.array_equal(run.thermo[column], rows[column], equal_nan=True), column


def last_state(file: Path) -> np.ndarray:
    return np.array([line.split()[1:4] for line in file.read_text().splitlines()[2:]], dtype=float)


@pytest.mark.parametrize("name", SCENES)
def test_pieces_saves_and_copies_keep_the_bits(name, tmp_path):
    whole = lennard.Simulation(SCENES[name], threads=2)
    expected = whole.run()
    pieces = lennard.Simulation(SCENES[name], threads=1)
    pieces.step(97)
    pieces.save(tmp_path / "half.lennard")
    pieces = lennard.Simulation.load(tmp_path / "half.lennard")
    pieces.step(60)
    pieces = pickle.loads(pickle.dumps(pieces))
    assert pieces.steps_done == 157
    found = pieces.run()
    assert np.array_equal(pieces.positions, whole.positions)
    assert np.array_equal(pieces.velocities, whole.velocities)
    assert np.array_equal(pieces.forces, whole.forces)
    assert found.record["averages"] == expected.record["averages"]


def test_stages_added_one_by_one_are_a_scene_of_the_command_line(liquid, tmp_path, command_line):
    simulation = lennard.Simulation(liquid)
    simulation.equilibrate(150, temperature=1.3)
    first = simulation.run(100, measure=["rdf"], thermostat=lennard.thermostat.bussi(tau=0.4))
    second = simulation.run(130, measure=[lennard.observable.msd(every=5)], dt=0.002, trajectory_every=50)
    for k, run in enumerate([first, second]):
        scene = tmp_path / f"{k}.toml"
        scene.write_text(run.scene)
        command_line("run", scene, "--out", tmp_path / f"run-{k}", "--quiet")
        record = json.loads((tmp_path / f"run-{k}" / "run.json").read_text())
        assert run.record["averages"] == record["averages"]
        assert run.record["neighbor"]["skin"] == record["neighbor"]["skin"]
    assert list(second.frames.step) == [300, 350]
    final = last_state(tmp_path / "run-1" / "final.xyz")
    box = simulation.box
    folded = simulation.positions - box * np.floor(simulation.positions / box)
    assert np.abs(folded - final).max() < 1e-13


def test_a_start_from_arrays_is_one_of_the_command_line(tmp_path, command_line):
    start = lennard.Simulation.liquid(density=0.7, temperature=1.1, n=256, seed=9)
    start.equilibrate(50)
    simulation = lennard.Simulation.from_arrays(start.positions, start.box, start.velocities, temperature=1.1)
    simulation.run(80)
    scene = simulation.export(tmp_path / "there")
    command_line("run", scene, "--out", tmp_path / "run", "--quiet")
    text = (tmp_path / "run" / "thermo.csv").read_text().splitlines()
    energy = float(text[-1].split(",")[5])
    assert simulation.results().thermo["potential_energy"][-1] == energy
    assert simulation.potential_energy == pytest.approx(energy, abs=1e-14)


def test_threads_do_not_matter(liquid):
    states = []
    for threads in (1, 2, 3):
        simulation = lennard.Simulation(liquid, threads=threads)
        simulation.step(60)
        states.append(simulation.positions)
    assert all(np.array_equal(states[0], other) for other in states[1:])
