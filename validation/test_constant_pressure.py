"""Liquids and a gas at constant pressure, judged by teqp's evaluation of Thol 2016 and by physical_validation: `cargo xtask physics`."""

from __future__ import annotations

import numpy as np
import physical_validation as pv
import pytest
import teqp
from conftest import RESULTS, Scene
from scipy import stats
from scipy.optimize import brentq

import lennard_validation as lv
from test_physical_validation import side_by_side, units

pytestmark = pytest.mark.physics

ATOMS = 864
#: The equation's own distance from simulation, in density.
OWN_DENSITY = 0.0005
#: Single-phase states all over the fluid: (density, temperature). The pressure of the barostat is the equation's there.
STATES = [(0.8442, 0.9), (0.75, 1.2), (0.7, 1.15), (0.6, 1.6), (0.3, 1.8), (0.05, 1.2)]
#: The liquid at which intervals and two pressures are compared.
LIQUID = (0.75, 1.2)
SEEDS = range(1, 11)


def pressure_of(density: float, temperature: float) -> float:
    model = teqp.make_model({"kind": "LJ126_TholJPCRD2016", "model": {}})
    return density * temperature * (1.0 + model.get_Ar01(temperature, density, np.array([1.0])))


def density_at(pressure: float, temperature: float, near: float) -> float:
    return brentq(lambda rho: pressure_of(rho, temperature) - pressure, 0.9 * near, 1.1 * near, xtol=1e-12)


def compressibility(density: float, temperature: float) -> float:
    """-dV/dP/V at constant temperature."""
    h = 1e-4 * density
    slope = (pressure_of(density + h, temperature) - pressure_of(density - h, temperature)) / (2.0 * h)
    return 1.0 / (density * slope)


def scene(density: float, temperature: float, pressure: float, steps: int, seed: int, **changes) -> Scene:
    """A fluid under a fast bath: Bussi, and stochastic cell rescaling every `interval` steps."""
    options = {"interval": 10, "tau": 1.0, "r_cut": 4.0, "atoms": ATOMS} | changes
    barostat = (
        f'{{ kind = "stochastic-cell-rescaling", pressure = {pressure!r}, tau = {options["tau"]}, '
        f"interval = {options['interval']} }}"
    )
    fluid = Scene(
        density=density,
        temperature=temperature,
        n_atoms=options["atoms"],
        truncation=f'kind = "cut"\nr_cut = {options["r_cut"]}',
        equilibrate=6000,
        steps=steps,
        thermostat='{ kind = "bussi", tau = 0.5 }\nbarostat = ' + barostat,
        output="thermo_every = 25",
        seed=seed,
    )
    return fluid


def volumes(run: lv.Run) -> np.ndarray:
    table = run.table("thermo")
    last = np.array(table["step"]) > run.record["steps"] - run.scene["stage"][-1]["steps"]
    return run.record["atoms"] / np.array(table["density"], dtype=float)[last]


def variance(series: np.ndarray, blocks: int = 20) -> tuple[float, float]:
    """The variance around the mean of all samples, with the error from blocks."""
    squares = np.square(series - series.mean())
    means = squares[: len(squares) // blocks * blocks].reshape(blocks, -1).mean(axis=1)
    return float(squares.mean()), float(means.std(ddof=1) / np.sqrt(blocks))


@pytest.mark.parametrize(("density", "temperature"), STATES)
def test_pressure_density_and_compressibility_are_the_equations(tmp_path, density, temperature):
    pressure = pressure_of(density, temperature)
    # The box of a gas moves slowly and far.
    steps = 100_000 if density > 0.2 else 300_000
    run = scene(density, temperature, pressure, steps, seed=41).run(tmp_path, threads=1)
    box = volumes(run)
    # Without total momentum the printed pressure has the mean P0 + T/V.
    wanted = pressure + temperature / box.mean()
    measured = run.averages["pressure"]
    off = (measured["mean"] - wanted) / measured["standard_error"]
    assert abs(off) < 3.0, (measured, wanted)
    found = run.averages["density"]
    reference = density_at(wanted, temperature, density)
    assert abs(found["mean"] - reference) < 3.0 * found["standard_error"] + OWN_DENSITY, (found, reference)
    spread, error = variance(box)
    kappa = spread / (temperature * box.mean())
    kappa_error = error / (temperature * box.mean())
    expected = compressibility(reference, temperature)
    RESULTS.append(
        f"constant pressure, rho {density}, T {temperature}: P - P0 - T/V = {measured['mean'] - wanted:+.5f} "
        f"+- {measured['standard_error']:.5f}, rho {found['mean']:.5f} +- {found['standard_error']:.5f} (equation {reference:.5f}), "
        f"kappa_T {kappa:.4f} +- {kappa_error:.4f} (equation {expected:.4f})"
    )
    assert abs(kappa - expected) < 3.0 * kappa_error + 0.03 * expected, (kappa, kappa_error, expected)


def small(pressure: float, steps: int, seed: int, **changes) -> Scene:
    return scene(*LIQUID, pressure, steps, seed, **({"atoms": 256, "r_cut": 3.0} | changes))


def test_the_interval_of_the_barostat_changes_no_volume(tmp_path):
    pressure = pressure_of(*LIQUID)
    intervals = (10, 50)
    runs = side_by_side(
        [
            lambda i=i, seed=seed: small(pressure, 100_000, seed, interval=i).run(tmp_path, f"every-{i}-{seed}", threads=1)
            for i in intervals
            for seed in SEEDS
        ]
    )
    of_interval = [runs[: len(SEEDS)], runs[len(SEEDS) :]]
    spreads = [np.array([volumes(run).var() for run in group]) for group in of_interval]
    means = [spread.mean() for spread in spreads]
    errors = [spread.std(ddof=1) / np.sqrt(len(SEEDS)) for spread in spreads]
    RESULTS.append(
        f"constant pressure, var V every 10 steps {means[0]:.2f} +- {errors[0]:.2f}, every 50 {means[1]:.2f} +- {errors[1]:.2f}"
    )
    apart, error = means[1] - means[0], float(np.hypot(*errors))
    assert abs(apart) < 3.0 * error
    # Without the Metropolis test it would be a third larger at 50 steps: the errors are small enough to see that.
    assert 3.0 * error < means[0] / 3.0


def test_volumes_at_two_pressures_are_in_the_isobaric_ratio(tmp_path):
    """ln p1(V)/p2(V) must be a line of slope -(P1 - P2)/T: ten pairs of runs."""
    density, temperature = LIQUID
    low = pressure_of(density, temperature)
    volume = 256 / density
    # Twice the width of V in between: where the test is sharpest.
    high = low + 2.0 / np.sqrt(volume * temperature * compressibility(density, temperature)) * temperature
    jobs = [
        lambda seed=seed, p=p: small(p, 100_000, seed).run(tmp_path, f"seed-{seed}-{p:.3f}", threads=1)
        for seed in SEEDS
        for p in (low, high)
    ]
    runs = side_by_side(jobs)

    def isobaric(run: lv.Run, pressure: float) -> pv.data.SimulationData:
        series = volumes(run)
        return pv.data.SimulationData(
            units=units(),
            ensemble=pv.data.EnsembleData("NPT", natoms=256, pressure=pressure, temperature=temperature),
            observables=pv.data.ObservableData(volume=series, potential_energy=np.zeros_like(series)),
        )

    def deviations(second: float) -> list[float]:
        found = []
        for a, b in zip(runs[::2], runs[1::2], strict=True):
            pair = isobaric(a, low), isobaric(b, second)
            found += pv.ensemble.check(*pair, verbosity=0)
        return found

    right, wrong = deviations(high), deviations(low + 1.3 * (high - low))
    chi_squared = float(np.square(right).sum())
    probability = stats.chi2.sf(chi_squared, len(right))
    RESULTS.append(
        f"physical_validation, V at two pressures: chi squared {chi_squared:.1f} for {len(right)} seeds, p = {probability:.3f}"
    )
    assert probability > 0.001, right
    assert stats.chi2.sf(np.square(wrong).sum(), len(wrong)) < 1e-6, "a wrong pressure was not seen"
