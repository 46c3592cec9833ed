"""Liquids and a gas at constant pressure, judged by teqp's evaluation of Thol 2016: `cargo xtask physics`."""

from __future__ import annotations

import numpy as np
import pytest
import teqp
from conftest import RESULTS, Scene
from scipy.optimize import brentq

import lennard_validation as lv

pytestmark = pytest.mark.physics

ATOMS = 864
#: The equation's own distance from simulation, in density.
OWN_DENSITY = 0.0005
#: Single-phase states all over the fluid: (density, temperature). The pressure of the barostat is the equation's there.
STATES = [(0.8442, 0.9), (0.75, 1.2), (0.7, 1.15), (0.6, 1.6), (0.3, 1.8), (0.05, 1.2)]


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


def scene(density: float, temperature: float, pressure: float, steps: int, seed: int) -> Scene:
    """A fluid under Bussi's bath and stochastic cell rescaling."""
    barostat = f'{{ kind = "stochastic-cell-rescaling", pressure = {float(pressure)!r} }}'
    return Scene(
        density=density,
        temperature=temperature,
        n_atoms=ATOMS,
        truncation='kind = "cut"\nr_cut = 4.0',
        equilibrate=6000,
        steps=steps,
        thermostat='{ kind = "bussi", tau = 0.5 }\nbarostat = ' + barostat,
        output="thermo_every = 25",
        seed=seed,
    )


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
    # The watch for equilibrium takes noise for a trend once in a while: two runs of one state would be a fault.
    # States have seeds of their own: with the same noise of the barostat, all would be off to the same side.
    first = 41 + 2 * STATES.index((density, temperature))
    for seed in (first, first + 1):
        run = scene(density, temperature, pressure, steps, seed=seed).run(tmp_path, f"seed{seed}", threads=1)
        if run.averages["pressure"]["standing"] == "sound":
            break
    assert run.averages["pressure"]["standing"] == "sound", run.averages["pressure"]["reason"]
    box = volumes(run)
    # Without total momentum the printed pressure has the mean P0 + T/V.
    wanted = pressure + temperature / box.mean()
    measured = run.averages["pressure"]
    off = (measured["mean"] - wanted) / measured["standard_error"]
    assert abs(off) < 3.0, (measured, wanted)
    found = run.averages["density"]
    # The bath holds the temperature of whole steps. Positions have the temperature of half steps, some 0.1 % higher.
    of_positions = run.averages["temperature_half_steps"]["mean"]
    reference = density_at(wanted, of_positions, density)
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
