"""Transport coefficients by exchanges of velocities, beside Green–Kubo at the same states."""

from __future__ import annotations

from math import hypot

import pytest

import lennard_validation as lv

SCENES = lv.commands.ROOT / "inputs/thermodynamics"

EQUILIBRIUM = """
[system]
n_atoms = 864
density = {density}
temperature = {temperature}
seed = 43

[truncation]
kind = "shift"
r_cut = 3.0

[integrator]
dt = 0.004

[[stage]]
name = "equilibrate"
steps = 20000
thermostat = "bussi"

[[stage]]
name = "production"
steps = 1000000

[[observable]]
kind = "thermal-conductivity"
every = 4

[[observable]]
kind = "shear-viscosity"
every = 4
"""

STATES = [(0.3, 1.9), (0.6, 1.5), (0.8442, 1.3)]


def long_box(density: float) -> list[float]:
    """Sides of a box for 768 particles, three times as long as it is wide."""
    side = (768 / (3 * density)) ** (1 / 3)
    return [side, side, 3 * side]


@pytest.mark.physics
@pytest.mark.parametrize(("density", "temperature"), STATES)
@pytest.mark.parametrize("kind", ["heat", "momentum"])
def test_an_exchange_and_the_fluctuations_give_the_same_coefficient(tmp_path, kind, density, temperature):
    (tmp_path / "equilibrium.toml").write_text(EQUILIBRIUM.format(density=density, temperature=temperature), encoding="utf-8")
    by_fluctuations = lv.run(tmp_path / "equilibrium.toml", out=tmp_path / "equilibrium")
    exchange = {"kind": kind, "every": 300}
    text = ", ".join(f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value}" for key, value in exchange.items())
    driven = lv.run(
        SCENES / "heat-exchange.toml",
        out=tmp_path / "driven",
        settings={
            "system.box": long_box(density),
            "system.temperature": temperature,
            "stage.drive.exchange": "{ " + text + " }",
            "stage.production.exchange": "{ " + text + " }",
        },
    )
    names = {"heat": ("thermal_conductivity_by_exchange", "thermal_conductivity"), "momentum": ("viscosity_by_exchange", "shear_viscosity")}
    found, expected = driven.averages[names[kind][0]], by_fluctuations.averages[names[kind][1]]
    error = hypot(found["standard_error"], expected["standard_error"])
    assert error < 0.1 * expected["mean"]
    # The two runs are at constant energy, and their temperatures differ by some per cent.
    assert abs(found["mean"] - expected["mean"]) < 2 * error + 0.03 * expected["mean"]
