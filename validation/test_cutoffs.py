"""What the end of the pair potential does to second derivatives: response functions and the configurational temperature."""

from __future__ import annotations

from math import hypot

import pytest

import lennard_validation as lv

pytestmark = pytest.mark.physics

SCENE = """
[system]
n_atoms = {n}
density = {density}
temperature = {temperature}
seed = {seed}

[start]
kind = "{start}"
{species}
[truncation]
{truncation}

[integrator]
dt = {dt}

[[stage]]
name = "equilibrate"
steps = 10_000
thermostat = {bath}

[[stage]]
name = "production"
steps = {steps}
thermostat = {bath}
"""

#: One fluid under two names, half and half: the pairs of B end at 1.5, the others at 2.5.
UNLIKE = """
[[species]]
name = "A"
fraction = 0.5

[[species]]
name = "B"
fraction = 0.5

[mixing]
rule = "geometric"

[[pair]]
a = "B"
b = "B"
r_cut = 1.5
"""


def averages(tmp_path, name: str, **values) -> dict:
    values = {"start": "lattice", "species": "", "dt": 0.004, "bath": '{ kind = "bussi", tau = 0.5 }'} | values
    path = tmp_path / f"{name}.toml"
    path.write_text(SCENE.format(**values), encoding="utf-8")
    return lv.run(path, out=tmp_path / name).averages


def test_the_compressibility_of_pairs_with_unlike_cutoffs_is_the_slope_of_the_pressure(tmp_path):
    def at(density: float, seed: int) -> dict:
        truncation = 'kind = "cut"\nr_cut = 2.5\nr_cut_in = "sigma"\ntail_correction = false'
        return averages(
            tmp_path, f"{density}-{seed}", n=256, density=density, temperature=1.6, seed=seed, species=UNLIKE,
            truncation=truncation, steps=200_000,
        )

    pressures = {rho: [at(rho, seed)["pressure"] for seed in (1, 2, 3)] for rho in (0.57, 0.63)}
    mean = {rho: sum(p["mean"] for p in of) / 3 for rho, of in pressures.items()}
    error = {rho: hypot(*(p["standard_error"] for p in of)) / 3 for rho, of in pressures.items()}
    slope, own = (mean[0.63] - mean[0.57]) / 0.06, hypot(error[0.57], error[0.63]) / 0.06
    found = [at(0.6, seed)["isothermal_compressibility"] for seed in (4, 5, 6, 7)]
    slopes = [1 / (0.6 * kappa["mean"]) for kappa in found]
    errors = [s * kappa["standard_error"] / kappa["mean"] for s, kappa in zip(slopes, found, strict=True)]
    # The weight of the longest cutoff for all pairs gave a slope that was too low by 0.9.
    assert abs(sum(slopes) / 4 - slope) < 3 * hypot(own, hypot(*errors) / 4)
    assert hypot(own, hypot(*errors) / 4) < 0.3


@pytest.mark.parametrize(
    ("n", "density", "temperature", "r_cut", "steps", "widest"),
    [
        # g(r_cut) is 0.6: with g = 1 T_conf was too high by 0.009.
        (500, 0.8, 1.1376, 1.6, 400_000, 0.003),
        # Two thirds and one half of an ideal gas: too high by 0.023 and 0.07.
        (3, 0.1, 0.9, 1.5, 6_000_000, 0.01),
        (2, 0.05, 1.5, 1.5, 6_000_000, 0.04),
    ],
)
def test_the_configurational_temperature_counts_the_pairs_at_the_cutoff(
    n, density, temperature, r_cut, steps, widest, tmp_path
):
    bath = '{ kind = "langevin", friction = 1.0 }' if n < 10 else '{ kind = "bussi", tau = 0.5 }'
    found = averages(
        tmp_path, "run", start="random" if n < 10 else "lattice", n=n, density=density, temperature=temperature, seed=3,
        truncation=f'kind = "shift"\nr_cut = {r_cut}', dt=0.003, bath=bath, steps=steps,
    )
    kinetic, other = found["temperature_half_steps"], found["configurational_temperature"]
    error = hypot(kinetic["standard_error"], other["standard_error"])
    assert abs(other["mean"] - kinetic["mean"]) < 3 * error
    assert other["standard_error"] < widest
