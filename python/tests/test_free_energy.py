"""Free energies along a path of states, on a fluid whose free energy is known."""

from __future__ import annotations

import json
import subprocess
import tomllib

import numpy as np
import pytest
from conftest import ROOT

from lennard.free_energy import State, along_path, of_sweep

A, B = -2.0, 3.0
SWEEP = ROOT / "inputs" / "sweep" / "free-energy.toml"


def state(density: float, temperature: float, error: float = 0.0) -> State:
    """A fluid with a_res = Aρ + BTρ²: u = Aρ, and P - ρT = Aρ² + 2BTρ³."""
    excess = A * density**2 + 2 * B * temperature * density**3
    return State(density, temperature, excess, error * density**2, A * density, error)


def path(error: float = 0.0) -> list[State]:
    points = tomllib.loads(SWEEP.read_text(encoding="utf-8"))["point"]
    return [state(p["density"], p["temperature"], error) for p in points]


def test_the_path_of_the_sweep_gives_the_exact_free_energy():
    found = along_path(path()[::-1])
    rho, t = 0.8442, 0.722
    assert (found.density, found.temperature) == (rho, t)
    a = A * rho + B * t * rho**2
    assert found.helmholtz == pytest.approx(a, abs=1e-8)
    assert found.chemical_potential == pytest.approx(a + A * rho + 2 * B * t * rho**2, abs=1e-8)
    assert found.entropy == pytest.approx(-B * rho**2, abs=1e-8)


def test_errors_of_the_states_become_the_error_of_the_result():
    rng, exact = np.random.default_rng(4), path(0.01)

    def shaken() -> float:
        moved = [
            State(
                s.density,
                s.temperature,
                s.excess_pressure + s.pressure_error * rng.standard_normal(),
                s.pressure_error,
                s.potential_energy + s.energy_error * rng.standard_normal(),
                s.energy_error,
            )
            for s in exact
        ]
        return along_path(moved).chemical_potential

    spread = np.std([shaken() for _ in range(1000)])
    assert along_path(path(0.01)).chemical_potential_error == pytest.approx(spread, rel=0.1)


def test_a_state_beside_the_path_is_refused():
    with pytest.raises(ValueError, match="1 states lie neither"):
        along_path([*path(), state(0.3, 1.1)])
    with pytest.raises(ValueError, match="no state"):
        along_path([])


def test_points_are_read_from_the_folder_of_a_sweep(tmp_path):
    for k, s in enumerate(path(0.001)):
        pressure = s.excess_pressure + s.density * (s.temperature + 0.01)
        means = {
            "pressure": (pressure, s.pressure_error),
            "potential_energy": (s.potential_energy, s.energy_error),
            "temperature_half_steps": (s.temperature + 0.01, 0.001),
            "temperature": (s.temperature, 0.001),
        }
        record = {
            "finished": True,
            "scene": {"system": {"density": s.density, "temperature": s.temperature}},
            "averages": {n: {"mean": m, "standard_error": e, "reason": ""} for n, (m, e) in means.items()},
        }
        (tmp_path / f"point-{k}").mkdir()
        (tmp_path / f"point-{k}" / "run.json").write_text(json.dumps(record), encoding="utf-8")
    assert of_sweep(tmp_path).chemical_potential == pytest.approx(along_path(path()).chemical_potential, abs=1e-9)
    with pytest.raises(ValueError, match="holds no point"):
        of_sweep(tmp_path / "point-0")


@pytest.mark.physics
def test_the_liquid_at_the_triple_point_has_the_potential_of_the_equation_of_state(program, tmp_path):
    out = tmp_path / "out"
    subprocess.run([program, "sweep", str(SWEEP), "--out", str(out)], check=True, capture_output=True)
    found = of_sweep(out)
    # Thol 2016.
    assert abs(found.chemical_potential + 4.0106) < 0.01 + 2 * found.chemical_potential_error
    assert found.chemical_potential_error < 0.01
