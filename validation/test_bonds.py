"""Long runs of bonds held in each way, judged by what is known of them (`cargo xtask physics`)."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import lennard_validation as lv

#: ⟨cos²θ⟩ of a free trimer of equal masses: with rigid bonds p(cosθ) ∝ √(4 − cos²θ), with springs it is flat.
RIGID, FLAT = 0.321021, 1.0 / 3.0


def trimers(bonds: str, dt: float) -> str:
    return f"""
[system]
n_molecules = 512
density = 0.001
temperature = 1.0
seed = 3

[start]
lattice = "sc"

[molecule]
kind = "chain"
sites = 3
bond_length = 1.0

[bonds]
{bonds}

[potential]
kind = "none"

[integrator]
dt = {dt}

[[stage]]
name = "mix"
steps = {round(10 / dt)}
thermostat = {{ kind = "langevin", friction = 1.0 }}

[[stage]]
name = "production"
steps = {round(150 / dt)}
thermostat = {{ kind = "langevin", friction = 1.0 }}

[output]
trajectory_every = {round(0.5 / dt)}
thermo_every = {round(0.5 / dt)}
unwrapped = true
"""


def cos_squared(text: str, folder) -> tuple[float, float]:
    """⟨cos²θ⟩ of the angle between both bonds, with the standard error over molecules, which are independent."""
    (folder / "trimers.toml").write_text(text, encoding="utf-8")
    frames = lv.load_frames(lv.run(folder / "trimers.toml", out=folder / "out").folder)
    of_frames = []
    for frame in frames:
        first, middle, last = (frame.positions[k::3] for k in range(3))
        a, b = middle - first, last - middle
        cosine = np.einsum("ij,ij->i", a, b) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
        of_frames.append(cosine**2)
    of_molecules = np.mean(of_frames, axis=0)
    return of_molecules.mean(), of_molecules.std(ddof=1) / np.sqrt(len(of_molecules))


@pytest.mark.physics
@pytest.mark.parametrize(
    ("bonds", "dt", "known", "other"),
    [
        ('method = "direct"', 0.01, RIGID, FLAT),
        ('method = "relaxation"', 0.01, RIGID, FLAT),
        ('method = "spring"\nstiffness = 1000.0', 0.005, FLAT, RIGID),
    ],
    ids=["direct", "relaxation", "spring"],
)
def test_rigid_trimers_and_springs_are_different_models_as_fixman_says(bonds, dt, known, other, tmp_path):
    mean, error = cos_squared(trimers(bonds, dt), tmp_path)
    assert abs(mean - known) < 3 * error + 2e-4, (mean, error)
    assert abs(mean - other) > 5 * error, (mean, error)


#: Ways to hold the bond of a dumbbell, with the largest step that each is run at.
WAYS = {
    "direct": 'method = "direct"',
    "relaxation": 'method = "relaxation"',
    "spring": 'method = "spring"\nstiffness = 16000.0',
    "midpoint": 'method = "spring"\nstiffness = 16000.0\nscheme = "midpoint"',
    "direct-leapfrog": 'method = "direct"',
    "direct-stormer-verlet": 'method = "direct"',
}
SPRINGS = ("spring", "midpoint")
BATHS = {
    "langevin": '{ kind = "langevin", friction = 0.5 }',
    "bussi": '{ kind = "bussi", tau = 0.2 }',
}


#: Part of T by which the motion inside molecules with stiff springs is cold on whole steps. Of its three degrees of freedom the
#: vibration alone is, by (ωh)²/4 with ω = √(2k/m).
COLD = (2 * 16000.0) * 0.002**2 / 4 / 3


def liquid(way: str, bath: str) -> str:
    method = way.partition("-")[2] or "velocity-verlet"
    # Vibrations forget their energy with the friction alone.
    steps = 120_000 if way in SPRINGS else 60_000
    return f"""
[system]
n_molecules = 108
density = 0.458
temperature = 2.0
seed = 11

[molecule]
bond_length = 0.67

[bonds]
{WAYS[way]}

[truncation]
kind = "force-shift"
r_cut = 2.5

[integrator]
kind = "{method}"
dt = 0.002

[[stage]]
name = "equilibrate"
steps = 10000
thermostat = {{ kind = "langevin", friction = 0.5 }}

[[stage]]
name = "production"
steps = {steps}
thermostat = {BATHS[bath]}

[[observable]]
kind = "molecules"
"""


@pytest.mark.physics
@pytest.mark.parametrize("bath", BATHS)
def test_all_ways_to_hold_a_bond_sample_one_fluid_with_one_temperature(bath, tmp_path):
    measured = {}
    for way in WAYS:
        if bath == "langevin" and "-" in way:
            # This bath is a method of its own.
            continue
        if bath == "bussi" and way in SPRINGS:
            # A stiff spring hardly exchanges energy with the rest, and this bath leaves the shares as they are.
            continue
        (tmp_path / f"{way}.toml").write_text(liquid(way, bath), encoding="utf-8")
        found = lv.run(tmp_path / f"{way}.toml", out=tmp_path / way).averages
        measured[way] = found
        # Equipartition. Temperatures of whole steps lie some (ωh)² lower, which is below 0.002 at this step.
        cold_parts = {"temperature_of_centers": 0.0, "temperature_inside_molecules": COLD * (way in SPRINGS)}
        if way in SPRINGS:
            cold_parts |= {"temperature_of_rotation": 0.0, "temperature_of_vibration": 3.0 * COLD}
        for part, share in cold_parts.items():
            mean, error = found[part]["mean"], found[part]["standard_error"]
            cold = 2.0 * share
            assert -cold < mean - 2.0 + 3 * error + 0.004, (way, part, mean, error)
            assert mean - 2.0 < 3 * error + 0.004, (way, part, mean, error)
    for one, other in itertools.combinations(measured, 2):
        for name, model in (("potential_energy", 0.01), ("pressure", 0.01)):
            a, b = measured[one][name], measured[other][name]
            error = np.hypot(a["standard_error"], b["standard_error"])
            # A spring has the mean energy T/2 of its own.
            of_bonds = sum(sign * (way in SPRINGS) for way, sign in ((one, 1.0), (other, -1.0)))
            difference = a["mean"] - b["mean"] - (of_bonds if name == "potential_energy" else 0.0)
            assert abs(difference) < 3 * error + model, (one, other, name, a, b)
