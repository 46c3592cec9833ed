"""Slabs of liquid beside their vapor, judged by Vrabec et al. 2006 and by teqp's binodal of Thol 2016: `cargo xtask physics`."""

from __future__ import annotations

import math

import numpy as np
import pytest
import teqp
from conftest import RESULTS

import lennard_validation as lv

pytestmark = pytest.mark.physics

ATOMS = 2000
#: The liquid's density agrees to this part, and the vapor pressure and the tension to this part and two errors.
LIQUID, STEEP, ERRORS = 0.005, 0.03, 2.0
#: The full potential: the liquid's density agrees to this part.
FULL_LIQUID = 0.01
CRITICAL = 1.0779

SCENE = """
[system]
n_atoms = {atoms}
temperature = {temperature}
seed = {seed}

[start]
kind = "slab"

[truncation]
{truncation}

[integrator]
dt = 0.005

[[stage]]
name = "equilibrate"
steps = {equilibrate}
thermostat = {{ kind = "bussi", tau = 0.5 }}

[[stage]]
name = "production"
steps = {steps}
thermostat = {{ kind = "bussi", tau = 1.0 }}

[[observable]]
kind = "interface"
"""


def slab(folder, name: str, temperature: float, truncation: str, steps: int, seed: int = 1) -> lv.Run:
    scene = folder / f"{name}.toml"
    text = SCENE.format(
        atoms=ATOMS, temperature=temperature, seed=seed, truncation=truncation, equilibrate=100_000, steps=steps
    )
    scene.write_text(text)
    return lv.run(scene, out=folder / name)


def measured(run: lv.Run, name: str) -> tuple[float, float]:
    average = run.averages[name]
    assert average["standing"] == "sound", (name, average)
    return average["mean"], average["standard_error"]


def vrabec(t: float) -> dict[str, float]:
    """The correlations for the potential truncated at 2.5 and shifted, apart from the program's own."""
    below = CRITICAL - t
    return {
        "liquid_density": 0.3190 + 0.5649 * below ** (1 / 3) + 0.1314 * below + 0.0413 * below**1.5,
        "vapor_density": 0.3190 - 0.5649 * below ** (1 / 3) + 0.2128 * below + 0.0702 * below**1.5,
        "vapor_pressure": math.exp(3.1664 - 5.9809 / t + 0.01498 / t**3),
        "surface_tension": 2.08 * (1 - t / CRITICAL) ** 1.21,
    }


def thol_liquid(t: float) -> float:
    """The density of the saturated liquid of the full potential, by teqp."""
    model = teqp.make_model({"kind": "LJ126_TholJPCRD2016", "model": {}})
    liquid, _ = model.pure_VLE_T(t, 0.77, 0.01, 20)
    return float(liquid)


@pytest.mark.parametrize("temperature", [0.7, 0.8, 0.9])
def test_a_truncated_slab_has_the_phases_of_vrabec(tmp_path, temperature):
    run = slab(tmp_path, "slab", temperature, 'kind = "shift"\nr_cut = 2.5', 600_000)
    t = run.averages["temperature_half_steps"]["mean"]
    expected = vrabec(t)
    for name, value in expected.items():
        mean, error = measured(run, name)
        RESULTS.append(f"slab T {t:.4f} {name} {mean:.5f} ± {error:.5f}, Vrabec {value:.5f}")
        allowed = LIQUID * value if name == "liquid_density" else ERRORS * error + STEEP * value
        assert abs(mean - value) <= allowed, (name, mean, error, value)
    table = run.table("interface")
    normal = np.array(table["normal"], dtype=float)
    tangential = np.array(table["tangential"], dtype=float)
    length = 2.0 * np.array(table["tension"], dtype=float) / (normal - tangential)
    assert np.allclose(length, length[0], rtol=1e-6), "the tension is half the length times the difference of pressures"


def test_a_planar_tail_makes_the_full_potential_of_any_cutoff(tmp_path):
    runs = {}
    for r_cut, steps in [(2.5, 400_000), (3.5, 300_000)]:
        truncation = f'kind = "cut"\nr_cut = {r_cut}\ntail_correction = "planar"'
        runs[r_cut] = slab(tmp_path, f"planar-{r_cut}", 0.85, truncation, steps)
    tensions = {}
    for r_cut, run in runs.items():
        t = run.averages["temperature_half_steps"]["mean"]
        density, error = measured(run, "liquid_density")
        tensions[r_cut] = measured(run, "surface_tension")
        reference = thol_liquid(t)
        RESULTS.append(
            f"planar tail, r_cut {r_cut}: liquid {density:.5f} ± {error:.5f}, Thol 2016 {reference:.5f}; "
            f"tension {tensions[r_cut][0]:.4f} ± {tensions[r_cut][1]:.4f}"
        )
        assert abs(density / reference - 1.0) <= FULL_LIQUID, (density, reference)
    (a, a_error), (b, b_error) = tensions.values()
    assert abs(a - b) <= ERRORS * math.hypot(a_error, b_error), tensions
