"""Simulations in forked and spawned processes, which have none of the threads of their parent."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor

import lennard
import numpy as np
import pytest

#: Seconds after which a process that hangs is ended; the work takes a few.
_HUNG = 120

forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
sizes = pytest.mark.parametrize("n", [108, 864, 4000])


@pytest.fixture(autouse=True)
def no_hang():
    """Ends a test that waits for ever."""

    def ended(*_: object) -> None:
        raise TimeoutError("the work hangs")

    before = signal.signal(signal.SIGALRM, ended)
    signal.alarm(_HUNG)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def liquid(n: int, **more: object) -> lennard.Simulation:
    return lennard.Simulation.liquid(density=0.8442, temperature=1.0, n=n, seed=2, r_cut=2.0, threads=2, **more)


def stepped(n: int) -> np.ndarray:
    simulation = liquid(n)
    simulation.step(12)
    return simulation.positions


def in_child(work: Callable[[], object]) -> int:
    """Does ``work`` in a forked child; its exit code is 0 where it came to its end."""
    child = os.fork()
    if child == 0:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(_HUNG // 2)
        code = 1
        try:
            work()
            code = 0
        finally:
            os._exit(code)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@forks
@sizes
def test_a_forked_child_goes_on_with_a_simulation_of_its_parent_to_the_bit(n):
    simulation = liquid(n)
    simulation.step(5)
    expected = stepped(n)

    def work() -> None:
        simulation.step(7)
        assert np.array_equal(simulation.positions, expected)

    assert in_child(work) == 0
    # The parent has lost nothing, and a child of the child has threads too.
    assert in_child(lambda: os._exit(in_child(work))) == 0
    simulation.step(7)
    assert np.array_equal(simulation.positions, expected)


@forks
@sizes
def test_a_forked_child_makes_simulations_of_its_own(n):
    expected = stepped(n)

    def work() -> None:
        assert np.array_equal(stepped(n), expected)

    assert in_child(work) == 0


@forks
@pytest.mark.parametrize("n", [108, 4000])
def test_every_door_opens_in_a_forked_child(n, tmp_path):
    simulation = liquid(n, stage=[{"name": "a", "steps": 10}])
    simulation.run()

    def work() -> None:
        assert np.isfinite(simulation.pressure) and np.isfinite(simulation.forces).all()
        with simulation.view() as state:
            assert len(state.forces) == n
        simulation.run(6, measure=[lennard.observable.rdf(every=2)]).compare()
        simulation.end_stage()
        simulation.save(tmp_path / "saved.lennard")
        lennard.Simulation.load(tmp_path / "saved.lennard").step(2)
        arrays = (simulation.positions, simulation.box, simulation.velocities)
        lennard.Simulation.from_arrays(*arrays, temperature=1.0).export(tmp_path / "exported")
        fresh = liquid(n, stage=[{"name": "a", "steps": 5}], output={"trajectory_every": 5, "format": "xyz.gz"})
        fresh.run_in_folder(tmp_path / "run")

    assert in_child(work) == 0


@forks
def test_a_calculator_for_ase_goes_on_in_a_forked_child():
    pytest.importorskip("ase")
    from ase.build import bulk
    from lennard.ase import Lennard

    atoms = bulk("Ar", "fcc", a=1.6, cubic=True) * (10, 10, 10)
    atoms.calc = Lennard(threads=2)
    energy = atoms.get_potential_energy()

    def work() -> None:
        atoms.positions += 1e-3
        assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-12)

    assert in_child(work) == 0


@sizes
@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
def test_processes_of_multiprocessing_step_to_the_same_bits(method, n):
    expected = stepped(n)
    with multiprocessing.get_context(method).Pool(2) as pool:
        for positions in pool.map_async(stepped, [n, n]).get(_HUNG):
            assert np.array_equal(positions, expected)


@sizes
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_a_sweep_runs_in_processes_whatever_the_parent_has_run(method, n):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip("this system does not fork")
    scene = {
        "system": {"n_atoms": n, "density": 0.5, "temperature": 1.5},
        "truncation": {"r_cut": 2.0},
        "stage": [{"name": "measure", "steps": 20}],
    }
    grid = {"temperature": [1.5, 2.0]}
    here = lennard.sweep(scene, grid, threads=2)
    with ProcessPoolExecutor(2, multiprocessing.get_context(method)) as executor:
        there = lennard.sweep(scene, grid, executor=executor, threads=2)
    for a, b in zip(here, there, strict=True):
        assert a.error is None and b.error is None
        assert np.array_equal(a.run.thermo["pressure"], b.run.thermo["pressure"])
