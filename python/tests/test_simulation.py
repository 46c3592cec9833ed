"""Simulations in Python: state, errors, threads."""

from __future__ import annotations

import copy
import threading

import lennard
import numpy as np
import pytest


def test_the_state_before_the_first_step_has_forces_and_energy(liquid):
    simulation = lennard.Simulation(liquid)
    before = simulation.forces
    energy, pressure = simulation.potential_energy, simulation.pressure
    assert simulation.steps_done == 0 and simulation.steps_left == 0
    assert simulation.temperature == pytest.approx(0.722, abs=1e-12)
    assert simulation.density == pytest.approx(0.8442, abs=1e-12)
    assert np.abs(before).max() < 1e-10, "an fcc lattice is in balance"
    simulation.step(1)
    run = simulation.results()
    assert abs(energy - simulation.potential_energy) < 1e-2
    assert np.isfinite(pressure) and run.record["averages"] is not None
    apart = lennard.Simulation(liquid)
    apart.step(1)
    assert np.array_equal(simulation.positions, apart.positions), "a look changes no bit"


def test_a_scene_that_comes_with_the_program_is_found_by_its_name():
    simulation = lennard.Simulation("verlet-1967/triple-point", set={"system.n_atoms": 256})
    assert simulation.name == "triple-point" and len(simulation.positions) == 256
    with pytest.raises(lennard.SceneError, match="nearest: verlet-1967/triple-point"):
        lennard.Simulation("verlet-1967/tripel-point")


def test_copies_are_the_readers_own(liquid):
    simulation = lennard.Simulation(liquid)
    positions = simulation.positions
    positions[:] = 0.0
    assert np.abs(simulation.positions).max() > 1.0
    assert simulation.positions.shape == simulation.velocities.shape == (256, 3)
    assert simulation.box.shape == (3,)


def test_a_view_is_locked_and_outlives_its_block(liquid):
    simulation = lennard.Simulation(liquid)
    simulation.step(20)
    expected = simulation.positions
    with simulation.view() as state:
        kept = state.positions
        assert np.array_equal(kept, expected)
        with pytest.raises(ValueError, match="read-only"):
            kept[0, 0] = 1.0
        with pytest.raises(lennard.BusyError, match="a view of this simulation is open"):
            simulation.step(1)
        with pytest.raises(lennard.BusyError, match="view"):
            _ = simulation.positions
        first = state.positions.__array_interface__["data"]
        assert first == kept.__array_interface__["data"], "no copy"
        assert np.array_equal(state.velocities, state.velocities) and state.forces.shape == (256, 3)
    with pytest.raises(ValueError, match="the view is closed"):
        _ = state.positions
    simulation.step(50)
    assert np.array_equal(kept, expected), "the array keeps what it had"
    assert not np.array_equal(simulation.positions, expected)
    undisturbed = lennard.Simulation(liquid)
    undisturbed.step(70)
    assert np.array_equal(simulation.positions, undisturbed.positions)
    del simulation
    assert np.array_equal(kept, expected)


def test_stages_follow_each_other_and_measure_apart(liquid):
    simulation = lennard.Simulation(liquid)
    simulation.equilibrate(60)
    first = simulation.run(300)
    second = simulation.run(200, name="more", measure=[lennard.observable.rdf(every=10)])
    assert first.finished and first.steps == 360 and second.steps == 560
    names = [stage["name"] for stage in second.record["scene"]["stage"]]
    assert names == ["equilibration", "production", "more"]
    measured = [stage["measure"] for stage in second.record["scene"]["stage"]]
    assert measured == [False, False, True]
    assert second.thermo["step"][0] == 370 and len(second.thermo["step"]) == 20
    assert "rdf" in second.tables and "rdf" not in first.tables
    g = second.rdf
    assert g["r"].shape == g["g"].shape and g.units["r"] == "σ"


def test_steps_make_the_last_stage_longer_and_no_longer_than_asked(liquid):
    simulation = lennard.Simulation(liquid)
    simulation.step(10)
    simulation.step(15)
    assert (simulation.steps_done, simulation.steps_left) == (25, 0)
    assert "steps = 25" in simulation.scene
    simulation.equilibrate(20)
    assert list(simulation.results().thermo["stage"]) == [1.0, 1.0]
    run = simulation.results()
    assert not np.isfinite(run.averages["pressure"].value), "it is not measured"
    assert run.finished and len(run.record["scene"]["stage"]) == 2
    simulation.step(5)
    names = [stage["name"] for stage in simulation.results().record["scene"]["stage"]]
    assert names == ["production", "equilibration", "production-2"]


def test_a_scene_with_steps_left_takes_no_new_stage(liquid):
    simulation = lennard.Simulation(liquid, stage=[{"name": "a", "steps": 100}, {"name": "b", "steps": 50}])
    simulation.step(30)
    assert simulation.steps_left == 120
    with pytest.raises(RuntimeError, match="the scene has 120 steps left"):
        simulation.run(10)
    simulation.end_stage()
    assert simulation.steps_left == 0
    run = simulation.run(20)
    assert run.steps == 50
    with pytest.raises(TypeError, match="a new stage needs its number of steps"):
        simulation.run(dt=0.001)


def test_a_ramp_does_not_grow(liquid):
    ramp = {"name": "heat", "steps": 30, "thermostat": "bussi", "temperature": {"from": 0.7, "to": 1.2}}
    simulation = lennard.Simulation(liquid, stage=[ramp])
    simulation.step(30)
    with pytest.raises(lennard.SceneError, match="more steps of a ramp") as caught:
        simulation.step(5)
    assert caught.value.allowed == "a new stage: run(steps, …)"
    assert simulation.run(5, thermostat="bussi").steps == 35


def test_the_errors_are_the_errors_of_the_scene(liquid, tmp_path, command_line):
    file = tmp_path / "wrong.toml"
    file.write_text(liquid.replace("r_cut", "r_cutt") + '[[stage]]\nname = "a"\nsteps = 10\n')
    with pytest.raises(lennard.SceneError) as caught:
        lennard.Simulation(file)
    printed = command_line("plan", file, check=False).stderr
    assert str(caught.value) in printed
    error = caught.value
    assert (error.line, error.key, error.nearest) == (9, "truncation.r_cutt", "r_cut")
    assert error.file == str(file) and error.allowed
    with pytest.raises(lennard.SceneError, match="override `truncation.r_cut=9`"):
        lennard.Simulation(liquid, set={"truncation.r_cut": 9})
    with pytest.raises(lennard.SceneError) as caught:
        lennard.Simulation({"system": {"n_atoms": 250, "density": 0.8, "temperature": 1.0}})
    assert caught.value.line is None and caught.value.key == "system.n_atoms"
    assert "line" not in str(caught.value)
    with pytest.raises(lennard.SceneError, match="thermostat"):
        lennard.Simulation(liquid).run(10, thermostat="bussy")
    with pytest.raises(lennard.SceneError, match="holds no|has no|unknown|not"):
        lennard.Simulation(liquid).run(10, measure=[{"kind": "rdf", "evry": 5}])
    with pytest.raises(lennard.SceneError, match="cannot be read"):
        lennard.Simulation(tmp_path / "nowhere.toml")
    with pytest.raises(TypeError, match="found: object"):
        lennard.Simulation.liquid(density=0.8, temperature=object())  # type: ignore[arg-type]
    with pytest.raises(lennard.SceneError, match="not a finite number"):
        lennard.Simulation.liquid(density=float("nan"), temperature=1.0)


def test_a_failed_stage_changes_nothing(liquid):
    simulation = lennard.Simulation(liquid)
    simulation.equilibrate(40)
    scene = simulation.scene
    with pytest.raises(lennard.SceneError):
        simulation.run(10, dt=-1.0)
    assert simulation.scene == scene
    assert simulation.run(10).steps == 50


def test_one_method_is_measured_without_a_list(liquid):
    simulation = lennard.Simulation(liquid)
    assert simulation.run(20, measure="msd").msd.rows > 0
    assert simulation.run(20, measure=lennard.observable.rdf(every=10)).rdf.rows > 0
    for every, n in [(0, 2), (5, 0)]:
        with pytest.raises(ValueError, match=f"every={every}, n={n}"):
            simulation.frames(every, n)


def test_physics_that_fails_is_an_exception(liquid):
    simulation = lennard.Simulation(liquid, integrator={"dt": 0.1})
    with pytest.raises(lennard.PhysicsError, match="the run failed at step") as caught:
        simulation.run(5000)
    assert caught.value.step == simulation.steps_done
    assert caught.value.stage == "production"


def test_arrays_of_the_wrong_shape_or_kind_are_refused():
    with pytest.raises(ValueError, match=r"box has the shape \(3, 3\)"):
        lennard.Simulation.from_arrays(np.zeros((4, 3)), np.eye(3), temperature=1.0)
    with pytest.raises(ValueError) as caught:
        lennard.Simulation.from_arrays(np.zeros((3, 2)), 8.0, temperature=1.0)
    assert "positions has the shape (3, 2)" in str(caught.value)
    assert "allowed: (N, 3)" in str(caught.value)
    with pytest.raises(ValueError, match="not a finite number"):
        lennard.Simulation.from_arrays(np.full((3, 3), np.nan), 8.0, temperature=1.0)
    with pytest.raises(ValueError, match="one velocity for each position"):
        lennard.Simulation.from_arrays(np.eye(3) * 4, 8.0, np.zeros((2, 3)), temperature=1.0)
    with pytest.raises(lennard.SceneError, match="particles 1 and 2"):
        lennard.Simulation.from_arrays([[0, 0, 0], [0.1, 0, 0]], 8.0, temperature=1.0)


def test_a_callback_is_told_and_may_stop_the_run(liquid):
    simulation = lennard.Simulation(liquid)
    told: list[tuple[str, int, int]] = []
    simulation.run(2000, progress=lambda *how_far: told.append(how_far))
    assert told[-1] == ("production", 2000, 2000)
    assert [done for _, done, _ in told] == sorted(done for _, done, _ in told)

    class Enough(Exception):
        pass

    def stop(stage: str, done: int, total: int) -> None:
        raise Enough(done)

    with pytest.raises(Enough):
        simulation.run(10_000_000, progress=stop)
    assert 0 < simulation.steps_left < 10_000_000
    simulation.end_stage()
    assert simulation.run(10).finished


def test_tqdm_shows_a_bar(liquid, capsys):
    pytest.importorskip("tqdm")
    lennard.Simulation(liquid).run(500, progress=True)
    assert "production" in capsys.readouterr().err


def test_another_thread_works_during_a_run_and_gets_an_error_from_the_same_simulation(liquid):
    simulation = lennard.Simulation(liquid, threads=1)
    counted, done, refused = 0, threading.Event(), []

    def run() -> None:
        simulation.run(20_000)
        done.set()

    worker = threading.Thread(target=run)
    worker.start()
    while not done.is_set():
        counted += 1
        if counted == 200:
            try:
                simulation.step(1)
            except lennard.BusyError as error:
                refused.append(str(error))
            try:
                _ = simulation.positions
            except lennard.BusyError as error:
                refused.append(str(error))
    worker.join()
    assert counted > 10_000, "the lock of Python is free during a run"
    assert len(refused) == 2 and "under way in another thread" in refused[0]
    assert simulation.steps_done == 20_000


def test_copies_go_their_own_ways(liquid):
    simulation = lennard.Simulation(liquid)
    simulation.step(30)
    other = copy.deepcopy(simulation)
    other.step(30)
    assert simulation.steps_done == 30 and other.steps_done == 60
    simulation.step(30)
    assert np.array_equal(simulation.positions, other.positions)


def test_saved_simulations_are_refused_where_they_are_damaged(liquid, tmp_path):
    file = tmp_path / "a.lennard"
    lennard.Simulation(liquid).save(file)
    assert lennard.Simulation.load(file).run(20).steps == 20
    data = bytearray(file.read_bytes())
    data[-40] ^= 1
    file.write_bytes(bytes(data))
    with pytest.raises(ValueError, match="damaged|checksum"):
        lennard.Simulation.load(file)


def test_a_folder_holds_a_run_from_its_first_step(liquid, tmp_path):
    simulation = lennard.Simulation(liquid, stage=[{"name": "a", "steps": 20}])
    record = simulation.run_in_folder(tmp_path / "run")
    assert record["finished"] and record["steps"] == 20
    with pytest.raises(ValueError, match="from its first step"):
        simulation.run_in_folder(tmp_path / "other")
    again = lennard.Simulation(tmp_path / "run" / "scene.toml")
    with pytest.raises(lennard.FolderError):
        again.run_in_folder(tmp_path / "run")


def test_molecules_have_energies_of_molecules():
    simulation = lennard.Simulation.liquid(
        density=0.3, temperature=2.0, n=256, molecule={"bond_length": 0.67}, truncation={"r_cut": 2.5}
    )
    assert (simulation.n_atoms, simulation.n_molecules) == (512, 256)
    run = simulation.run(50)
    assert run.record["atoms"] == 512
