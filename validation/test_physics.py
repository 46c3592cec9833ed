"""Long runs judged by their physics: `cargo xtask physics`.

The judge is teqp's evaluation of Thol 2016, with errors from blocks computed here; the program's own
comparison and its own errors are judged in turn.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import teqp

import lennard_validation as lv
from conftest import RESULTS, Scene

pytestmark = pytest.mark.physics

#: How far the equation itself is from simulation (NIST Monte Carlo: 0.0024 in U, 0.0039 in P, where P is below 2.3).
OWN_U, OWN_P = 0.003, 0.005
#: The same at high pressure, relative: at density 0.9 and T = 2.8 the simulations of Chaparro and Mueller lie 0.0162 above it, of 13.
OWN_P_RELATIVE = 0.00125

#: Single-phase states all over the fluid: (density, temperature).
STATES = [
    (0.8442, 0.722),
    (0.8, 0.9),
    (0.7, 1.15),
    (0.05, 1.2),
    (0.3, 1.8),
    (0.6, 1.6),
    (0.85, 1.4),
    (0.9, 2.74),
]

CUTOFF = 4.0
THREADS = max(1, (os.cpu_count() or 1))


def side_by_side(jobs) -> list:
    """Runs the jobs one a core."""
    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(lambda job: job(), jobs))


def reference(rho: float, t: float) -> dict[str, tuple[float, float]]:
    """U and P of Thol 2016 with their slopes in T, by teqp."""
    model = teqp.make_model({"kind": "LJ126_TholJPCRD2016", "model": {}})
    z = np.array([1.0])
    ar01 = model.get_Ar01(t, rho, z)
    return {
        "potential_energy": (t * model.get_Ar10(t, rho, z), -model.get_Ar20(t, rho, z)),
        "pressure": (rho * t * (1.0 + ar01), rho * (1.0 + ar01 - model.get_Ar11(t, rho, z))),
    }


def finite_size(rho: float, t: float, n: int) -> dict[str, float]:
    """The difference of a closed box of n particles at constant energy from an infinite system.

    It follows from differences of teqp's pressures. The free energy has T/2 ln(S0), S0 = T/(dp/drho), in excess, and the
    temperature fluctuates by T^2/(n c_v).
    """

    def p(t: float, rho: float) -> float:
        model = teqp.make_model({"kind": "LJ126_TholJPCRD2016", "model": {}})
        return rho * t * (1.0 + model.get_Ar01(t, rho, np.array([1.0])))

    def excess(t: float, rho: float) -> float:
        h = 1e-3 * rho
        return 0.5 * t * np.log(t * 2 * h / (p(t, rho + h) - p(t, rho - h))) / n

    dr, dt = 0.01 * rho, 0.01 * t
    pressure = rho**2 * (excess(t, rho + dr) - excess(t, rho - dr)) / (2 * dr)
    energy = -(t**2) * (excess(t + dt, rho) / (t + dt) - excess(t - dt, rho) / (t - dt)) / (2 * dt)
    slopes = {name: [reference(rho, t + sign * dt)[name][1] for sign in (1, -1)] for name in ("potential_energy", "pressure")}
    c_v = 1.5 + reference(rho, t)["potential_energy"][1]
    second = {name: -0.5 * t**2 * (hot - cold) / (2 * dt) / (n * c_v) for name, (hot, cold) in slopes.items()}
    return {"potential_energy": energy + second["potential_energy"], "pressure": pressure + second["pressure"]}


def production(run: lv.Run) -> dict[str, np.ndarray]:
    """The series of the last stage, per particle; the temperature of half steps belongs to the positions."""
    table = run.table("thermo")
    last = np.array(table["step"]) > run.record["steps"] - run.scene["stage"][-1]["steps"]
    columns = {"temperature": "temperature_half_steps", "potential_energy": "potential_energy", "pressure": "pressure"}
    return {name: np.array(table[column], dtype=float)[last] for name, column in columns.items()}


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> dict[tuple[float, float], lv.Run]:
    folder = tmp_path_factory.mktemp("states")

    def job(i: int, rho: float, t: float):
        scene = Scene(
            density=rho,
            temperature=t,
            n_atoms=864,
            truncation=f'kind = "cut"\nr_cut = {CUTOFF}\ntail_correction = true',
            equilibrate=8000,
            # The pressure of the hot dense fluid fluctuates most, and the energy of a gas changes slowest.
            steps=200000 if rho < 0.1 else 50000 if t < 2.0 else 120000,
            dt=0.004 if t < 2.0 else 0.003,
            seed=100 + i,
        )
        return lambda: scene.run(folder, f"state-{i}", threads=1)

    found = side_by_side([job(i, rho, t) for i, (rho, t) in enumerate(STATES)])
    return dict(zip(STATES, found, strict=True))


def differences(run: lv.Run, rho: float) -> dict[str, lv.Blocked]:
    """X - [X_EOS(T_mean) + (T - T_mean) dX_EOS/dT] for as many particles: its error carries the correlation of X and T."""
    series = production(run)
    mean = series["temperature"].mean()
    found = {}
    for name, (value, slope) in reference(rho, mean).items():
        value += finite_size(rho, mean, run.record["atoms"])[name]
        found[name] = lv.blocked_error(series[name] - value - slope * (series["temperature"] - mean))
    return found


@pytest.mark.parametrize("state", STATES, ids=lambda s: f"rho{s[0]}-T{s[1]}")
def test_energy_and_pressure_are_those_of_thol_2016(runs, state):
    rho, t = state
    run = runs[state]
    assert run.averages["temperature"]["mean"] == pytest.approx(t, rel=0.05)
    found = differences(run, rho)
    if not RESULTS:
        RESULTS.append(f"864 particles, r_cut {CUTOFF} with tail, beside Thol 2016 (teqp):")
        RESULTS.append("density  T, half steps  U - U_EOS             P - P_EOS")
    u, p = found["potential_energy"], found["pressure"]
    RESULTS.append(
        f"{rho:<8} {run.averages['temperature_half_steps']['mean']:.4f}     "
        f"{u.mean:+.5f} +- {u.standard_error:.5f}  {p.mean:+.5f} +- {p.standard_error:.5f}"
    )
    own_p = max(OWN_P, OWN_P_RELATIVE * run.averages["pressure"]["mean"])
    for name, own in (("potential_energy", OWN_U), ("pressure", own_p)):
        assert abs(found[name].mean) < 3.0 * found[name].standard_error + own, name
        # The bound must not be met by ignorance.
        assert found[name].standard_error < 2.0 * own, name


@pytest.mark.parametrize("state", STATES, ids=lambda s: f"rho{s[0]}-T{s[1]}")
def test_the_programs_own_comparison_says_the_same(runs, state):
    rho, _ = state
    run = runs[state]
    own = {entry["quantity"]: entry for entry in run.record["comparison"]}
    for name, found in differences(run, rho).items():
        entry = own[name]
        at = entry["at"]
        assert at["density"] == pytest.approx(rho, rel=1e-12)
        assert at["half_steps"]
        assert at["temperature"] == pytest.approx(run.averages["temperature_half_steps"]["mean"], rel=1e-12)
        infinite = entry["reference"] - entry["finite_size"]
        assert infinite == pytest.approx(reference(rho, at["temperature"])[name][0], rel=1e-10)
        # Differences over 1 % of density and temperature.
        expected = finite_size(rho, at["temperature"], run.record["atoms"])[name]
        assert entry["finite_size"] == pytest.approx(expected, rel=0.03, abs=1e-6)
        assert entry["measured"] == pytest.approx(run.averages[name]["mean"], rel=1e-12)
        assert entry["difference"] == pytest.approx(entry["measured"] - entry["reference"], abs=1e-12)
        # The equilibration cut and the blocks are others. The means agree within their errors. The errors are
        # uncertain by 14 % with 25 blocks, and by about as much with the program's method.
        assert abs(entry["difference"] - found.mean) < 2.0 * found.standard_error
        assert 0.5 < entry["standard_error"] / found.standard_error < 2.0


SEEDS = range(1, 11)
#: Probability with which a right error bar would be called wrong, on either side.
UNLIKELY = 0.001


@pytest.fixture(scope="module", params=["constant energy", "bussi"])
def seeds(request, tmp_path_factory) -> tuple[str, list[lv.Run]]:
    folder = tmp_path_factory.mktemp("seeds")
    canonical = request.param == "bussi"

    def job(seed: int):
        scene = Scene(
            density=0.8,
            temperature=1.0,
            n_atoms=256,
            equilibrate=4000,
            steps=40000,
            thermostat='{ kind = "bussi", tau = 0.5 }' if canonical else '"none"',
            seed=seed,
        )
        return lambda: scene.run(folder, f"seed-{seed}", threads=1)

    return request.param, side_by_side([job(seed) for seed in SEEDS])


def test_ten_seeds_scatter_as_the_printed_errors_say(seeds):
    """At constant temperature T, U and P themselves scatter by their errors. At constant energy each
    seed has its own energy, and what scatters is the difference from the equation of state at the
    measured temperature."""
    ensemble, runs = seeds
    if ensemble == "bussi":
        names = ("temperature", "potential_energy", "pressure")
        samples = {n: [(r.averages[n]["mean"], r.averages[n]["standard_error"]) for r in runs] for n in names}
    else:
        samples = {"potential_energy": [], "pressure": []}
        for run in runs:
            for entry in run.record["comparison"]:
                if entry["quantity"] in samples:
                    samples[entry["quantity"]].append((entry["difference"], entry["standard_error"]))
    for name, pairs in samples.items():
        assert len(pairs) == len(runs)
        means, errors = np.array(pairs).T
        chi_squared, probability = lv.chi_squared_of_spread(means, errors)
        RESULTS.append(f"ten seeds, {ensemble}, {name}: chi squared {chi_squared:.1f} for 9 degrees of freedom")
        assert UNLIKELY < probability < 1.0 - UNLIKELY, (ensemble, name, chi_squared)
        assert errors.max() < 3.0 * errors.min(), "the errors themselves scatter too much"


def test_energy_differs_from_the_equation_alike_at_every_step_where_it_is_taken_on_half_steps(tmp_path):
    """With twice the usual step the kinetic temperature of whole steps is low by six parts in a thousand.

    U then seems 0.009 too high for it. At the temperature of half steps U is the same as with the usual step.
    """
    rho, t = 0.85, 1.214
    steps = {0.0092: 60000, 0.0046: 60000}

    def job(dt: float, n: int):
        scene = Scene(
            density=rho,
            temperature=t,
            n_atoms=500,
            truncation=f'kind = "cut"\nr_cut = {CUTOFF}\ntail_correction = true',
            equilibrate=4000,
            steps=n,
            dt=dt,
            seed=11,
        )
        return lambda: scene.run(tmp_path, f"dt-{dt}", threads=1)

    large, usual = side_by_side([job(dt, n) for dt, n in steps.items()])
    a, b = (differences(run, rho)["potential_energy"] for run in (large, usual))
    error = np.hypot(a.standard_error, b.standard_error)
    RESULTS.append(f"U - U_EOS(T, half steps), dt 0.0092 less dt 0.0046: {a.mean - b.mean:+.5f} +- {error:.5f}")
    assert abs(a.mean - b.mean) < 3.0 * error
    whole = large.averages["temperature"]["mean"]
    half = large.averages["temperature_half_steps"]["mean"]
    _, slope = reference(rho, half)["potential_energy"]
    seeming = a.mean - b.mean + slope * (half - whole)
    assert seeming > 3.0 * error, "the step would not be seen on whole steps: the test proves nothing"


def test_short_cutoff_biases_the_pressure_of_a_dense_liquid_as_the_readme_says(tmp_path):
    """At r_cut 2.5 g(r) is not yet one: with the usual tail P comes out low by about 0.03. That this
    is seen shows that the comparison at 4 could fail."""
    rho, t = 0.8442, 0.722

    def job(seed: int):
        scene = Scene(density=rho, temperature=t, n_atoms=864, equilibrate=8000, steps=60000, seed=seed)
        return lambda: scene.run(tmp_path, f"seed-{seed}", threads=1)

    found = [differences(run, rho)["pressure"] for run in side_by_side([job(seed) for seed in (1, 2)])]
    bias = np.mean([f.mean for f in found])
    error = np.sqrt(sum(f.standard_error**2 for f in found)) / len(found)
    RESULTS.append(f"P - P_EOS at r_cut 2.5, density {rho}, temperature {t}: {bias:+.4f} +- {error:.4f}")
    assert -0.05 < bias < -OWN_P
    assert abs(bias) > 3.0 * error
