"""Fluctuations of the box at constant pressure, judged by physical_validation at two pressures, and by two intervals of the
barostat: `cargo xtask physics`."""

from __future__ import annotations

import numpy as np
import physical_validation as pv
import pytest
from conftest import Scene

import lennard_validation as lv

pytestmark = pytest.mark.physics

TEMPERATURE = 1.2
DT = 0.004
#: Each barostat with the thermostat that it goes with.
BAROSTATS = {"stochastic-cell-rescaling": "bussi", "mtk": "nose-hoover"}
#: Deviations in standard errors that are still no contradiction.
MOST_ERRORS = 3.5


def scene(atoms: int, pressure: float, barostat: str, options: str, steps: int, seed: int) -> Scene:
    bath = BAROSTATS[barostat]
    press = f'barostat = {{ kind = "{barostat}", pressure = {pressure!r}{options} }}'
    return Scene(
        density=0.75,
        temperature=TEMPERATURE,
        n_atoms=atoms,
        # A potential without a jump: MTK follows the forces alone.
        truncation='kind = "switch"\nr_cut = 2.2',
        dt=DT,
        equilibrate=5000,
        steps=steps,
        thermostat=f'{{ kind = "{bath}", tau = 0.3 }}\n{press}',
        output="thermo_every = 25",
        seed=seed,
    )


def production(run: lv.Run) -> dict[str, np.ndarray]:
    table = run.table("thermo")
    last = np.array(table["step"]) > run.record["steps"] - run.scene["stage"][-1]["steps"]
    return {name: np.array(table[name], dtype=float)[last] for name in ("density", "potential_energy")}


def volumes(run: lv.Run) -> np.ndarray:
    return run.record["atoms"] / production(run)["density"]


def sample(run: lv.Run, pressure: float) -> pv.data.SimulationData:
    atoms = run.record["atoms"]
    ones = {f"{name}_conversion": 1.0 for name in ("energy", "length", "volume", "temperature", "time")}
    # The package takes p·V of bar and nm3 into kJ/mol on its own.
    units = pv.data.UnitData(kb=1.0, pressure_conversion=1.0 / 6.022140857e-2, **ones)
    return pv.data.SimulationData(
        units=units,
        dt=DT,
        system=pv.data.SystemData(
            natoms=atoms, nconstraints=0, ndof_reduction_tra=3, ndof_reduction_rot=0, mass=np.ones(atoms)
        ),
        ensemble=pv.data.EnsembleData("NPT", natoms=atoms, pressure=pressure, temperature=TEMPERATURE),
        observables=pv.data.ObservableData(
            potential_energy=atoms * production(run)["potential_energy"], volume=volumes(run)
        ),
    )


@pytest.mark.parametrize("barostat", BAROSTATS)
def test_volumes_at_two_pressures_have_the_ratio_of_boltzmann(tmp_path, barostat):
    """ln p1(V)/p2(V) is a line with the slope -(P1 - P2)/T. The distance of the pressures is about 2T/sigma_V."""
    pressures = (1.2, 1.5)
    runs = [
        scene(256, p, barostat, "", 150_000, seed=11).run(tmp_path, f"p{p}", threads=1) for p in pressures
    ]
    one, two = (sample(run, p) for run, p in zip(runs, pressures, strict=True))
    (off,) = pv.ensemble.check(one, two, total_energy=False, verbosity=0, bootstrap_seed=1)
    assert abs(off) < MOST_ERRORS, off
    # The check can fail: pressures that are twice as far apart belong to other volumes.
    wrong = sample(runs[1], pressures[1] + 0.3)
    (off,) = pv.ensemble.check(one, wrong, total_energy=False, verbosity=0, bootstrap_seed=1)
    assert abs(off) > MOST_ERRORS, off


def variance(series: np.ndarray, blocks: int = 20) -> tuple[float, float]:
    """The variance around the mean of all samples, with the error from blocks."""
    squares = np.square(series - series.mean())
    means = squares[: len(squares) // blocks * blocks].reshape(blocks, -1).mean(axis=1)
    return float(squares.mean()), float(means.std(ddof=1) / np.sqrt(blocks))


def test_the_variance_of_the_volume_does_not_depend_on_the_interval(tmp_path):
    """Without the Metropolis test an interval of 50 steps would have a variance that is larger by tens of per cent."""
    found = []
    for interval in (10, 50):
        options = f", interval = {interval}, tau = 4.0"
        run = scene(108, 1.19, "stochastic-cell-rescaling", options, 1_000_000, seed=5)
        found.append(variance(volumes(run.run(tmp_path, f"every{interval}", threads=1))))
    (one, error), (other, its_error) = found
    apart = np.hypot(error, its_error)
    assert apart < 0.12 * one, found
    assert abs(one - other) < 3.0 * apart, found
