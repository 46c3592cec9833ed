"""The chemical potential by trial particles, beside NIST's saturated vapors and beside an equation of state."""

from __future__ import annotations

from math import log

import pytest

import lennard_validation as lv

# ln z at saturation, with the density of the vapor: NIST Standard Reference Simulation Website, SAT-TMMC, Lennard-Jones cut
# at 3 with long-range corrections.
SATURATED_VAPORS = {0.8: (0.0061007, -5.1952), 0.9: (0.01451, -4.4191), 1.0: (0.029556, -3.8345)}


@pytest.mark.physics
@pytest.mark.parametrize("temperature", SATURATED_VAPORS)
def test_a_saturated_vapor_has_the_activity_of_nist(tmp_path, temperature):
    density, expected = SATURATED_VAPORS[temperature]
    # A particle of a thin gas collides seldom, and its run is as much longer.
    steps = int(80_000 * max(1.0, 0.03 / density))
    run = lv.run(
        lv.commands.ROOT / "inputs/thermodynamics/saturated-vapor.toml",
        out=tmp_path / "out",
        settings={
            "system.temperature": temperature,
            "system.density": density,
            "stage.production.steps": steps,
            "observable.chemical-potential.insertions": 200,
        },
    )
    found = run.averages["ln_activity"]
    assert found["standard_error"] < 0.005
    assert abs(found["mean"] - expected) < 0.01 + 2 * found["standard_error"]


@pytest.mark.physics
def test_a_supercritical_fluid_has_the_potential_of_the_equations(tmp_path):
    run = lv.run(lv.commands.ROOT / "inputs/thermodynamics/chemical-potential.toml", out=tmp_path / "out", settings={"stage.production.steps": 100_000})
    found = run.averages["residual_chemical_potential"]
    # Thol 2016 at ρ = 0.5, T = 2.
    assert abs(found["mean"] + 0.5563) < 0.01 + 3 * found["standard_error"]
    assert abs(run.averages["ln_activity"]["mean"] - found["mean"] / 2.0 - log(0.5)) < 1e-9
