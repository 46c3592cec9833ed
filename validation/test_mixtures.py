"""Mixtures: files read back by ASE and mdtraj, and long runs beside other programs and exact second virial coefficients."""

from __future__ import annotations

import csv
from math import gamma, pi

import ase.data
import mdtraj
import numpy as np
import pytest

import lennard_validation as lv

MIXTURE = """
[system]
n_atoms = {n}
density = {density}
temperature = {temperature}
seed = {seed}

[[species]]
name = "Ar"
fraction = {fraction}

[[species]]
name = "krypton"
fraction = {other}
sigma = {sigma}
epsilon = {epsilon}
mass = 2.098
element = "Kr"

[mixing]
rule = "lorentz-berthelot"

[truncation]
kind = "cut"
r_cut = {r_cut}

[integrator]
dt = {dt}

[[stage]]
name = "equilibrate"
steps = {equilibrate}
thermostat = {{ kind = "bussi", tau = 0.2 }}

[[stage]]
name = "production"
steps = {production}
thermostat = {{ kind = "bussi", tau = 0.2 }}

[output]
trajectory_every = {frames}
"""


def mixture(tmp_path, **changes) -> lv.Run:
    values = {
        "n": 256, "density": 0.5, "temperature": 1.5, "seed": 4, "fraction": 0.7, "sigma": 1.0656, "epsilon": 1.3934,
        "r_cut": 2.5, "dt": 0.004, "equilibrate": 100, "production": 200, "frames": 50,
    }
    values |= changes
    values["other"] = round(1.0 - values["fraction"], 12)
    (tmp_path / "mixture.toml").write_text(MIXTURE.format(**values), encoding="utf-8")
    return lv.run(tmp_path / "mixture.toml", out=tmp_path / "out")


@pytest.fixture(scope="module")
def small(tmp_path_factory) -> lv.Run:
    return mixture(tmp_path_factory.mktemp("mixture"))


def test_ase_reads_symbols_and_masses_of_each_particle(small):
    frames = lv.load_frames(small.folder)
    assert len(frames) == 4
    counts = {s["element"]: s["count"] for s in small.record["species"]}
    assert counts == {"Ar": 179, "Kr": 77}
    for frame in frames:
        symbols = np.array(frame.get_chemical_symbols())
        assert {s: int((symbols == s).sum()) for s in counts} == counts
        np.testing.assert_array_equal(frame.get_masses(), np.where(symbols == "Kr", 2.098, 1.0))
        assert frame.info["species_names"] == "Ar=Ar Kr=krypton"
        assert (symbols == frames[0].get_chemical_symbols()).all()
    # Species are mixed: both are in each half of the file, which has one layer after the other.
    assert (frames[0].numbers[:128] == ase.data.atomic_numbers["Kr"]).sum() in range(20, 58)


def test_mdtraj_sees_the_elements(small):
    structure = mdtraj.load(str(small.folder / "topology.gro"))
    found = [atom.element.symbol for atom in structure.topology.atoms]
    assert found == lv.load_frames(small.folder)[0].get_chemical_symbols()


def test_temperature_of_the_header_has_the_masses(small):
    frame = lv.load_frames(small.folder)[-1]
    kinetic = (frame.get_masses()[:, None] * frame.arrays["velo"] ** 2).sum()
    assert kinetic / small.record["n_dof"] == pytest.approx(frame.info["temperature"], rel=1e-12)


def test_energy_of_the_start_is_the_sum_over_pairs_with_their_own_parameters(small):
    frame = lv.load_frames(small.folder)[-1]
    pairs = {(p["a"], p["b"]): p for p in small.record["pairs"]}
    assert pairs["Ar", "krypton"]["sigma"] == pytest.approx(0.5 * 2.0656)
    assert pairs["Ar", "krypton"]["epsilon"] == pytest.approx(1.3934**0.5)
    names = ["krypton" if s == "Kr" else "Ar" for s in frame.get_chemical_symbols()]
    distances = frame.get_all_distances(mic=True)
    energy = 0.0
    for i in range(len(names)):
        for j in range(i + 1, len(names)):
            pair = pairs.get((names[i], names[j])) or pairs[names[j], names[i]]
            r = distances[i, j]
            if r <= pair["r_cut"]:
                s6 = (pair["sigma"] / r) ** 6
                energy += 4.0 * pair["epsilon"] * (s6 * s6 - s6)
    assert energy == pytest.approx(frame.info["total_potential_energy"], rel=1e-11)


def b2(t: float) -> float:
    """The second virial coefficient of Lennard-Jones, σ³: the series of gamma functions."""
    return -(2.0 * pi / 12.0) * sum(
        (4.0 / t) ** (0.25 + 0.5 * i) / gamma(i + 1.0) * gamma((6.0 * i - 3.0) / 12.0) for i in range(60)
    )


def slope(t: float) -> float:
    return (b2(t * 1.0001) - b2(t * 0.9999)) / (0.0002 * t)


@pytest.mark.physics
@pytest.mark.parametrize("fraction", [0.25, 0.5])
def test_a_thin_gas_has_the_second_virial_coefficient_of_the_mixture(fraction, tmp_path):
    t, rho, n = 2.0, 0.01, 500
    run = mixture(
        tmp_path, n=n, density=rho, temperature=t, fraction=fraction, r_cut=8.0, equilibrate=20_000, production=400_000,
        frames=400_000,
    )
    x = [s["fraction"] for s in run.record["species"]]
    of = {(0, 0): (1.0, 1.0), (1, 1): (1.0656, 1.3934), (0, 1): (1.0328, 1.3934**0.5)}
    pairs = [(a, b, of[min(a, b), max(a, b)]) for a in (0, 1) for b in (0, 1)]
    exact = sum(x[a] * x[b] * s**3 * b2(t / e) for a, b, (s, e) in pairs)
    energy = sum(x[a] * x[b] * s**3 * slope(t / e) / e for a, b, (s, e) in pairs)
    found = run.averages
    closed = 1.0 - 1.0 / n
    p, u = found["pressure"], found["potential_energy"]
    measured = found["temperature_half_steps"]["mean"]
    # The next coefficient: about 3 of pure krypton at this temperature and less for the others.
    assert abs((p["mean"] - rho * measured) - t * exact * rho**2 * closed) < 3 * p["standard_error"] + 3 * t * rho**3
    assert abs(u["mean"] + rho * t * t * energy * closed) < 3 * u["standard_error"] + 20 * rho**2


@pytest.mark.physics
def test_argon_with_krypton_lies_in_the_band_of_the_one_fluid_theory(tmp_path):
    scene = lv.commands.ROOT / "inputs/mixture/argon-krypton.toml"
    run = lv.run(scene, out=tmp_path / "out", settings={"stage.production.steps": 40_000})
    compared = {c["quantity"]: c for c in run.record["comparison"]}
    assert set(compared) == {"potential_energy", "pressure"}
    for one in compared.values():
        assert "one-fluid" in one["source"]
        assert abs(one["difference"]) < one["reference_uncertainty"] + 3 * one["standard_error"], one


def reference() -> list[dict]:
    path = lv.commands.ROOT / "crates/literature/data/kob-andersen.csv"
    rows = csv.DictReader(line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#"))
    return [row for row in rows if row["x_A"] == "0.8"]


@pytest.mark.physics
@pytest.mark.parametrize("temperature", ["2.0", "1.028"])
def test_kob_andersen_has_the_energy_and_pressure_of_other_programs(temperature, tmp_path):
    scene = lv.commands.ROOT / "inputs/mixture/kob-andersen.toml"
    settings = {
        "system.temperature": temperature,
        "stage.equilibrate.steps": 10_000,
        "stage.production.steps": 60_000,
    }
    found = lv.run(scene, out=tmp_path / "out", settings=settings).averages
    values = {row["quantity"]: float(row["value"]) for row in reference() if row["T"] == temperature}
    t, rho = float(temperature), 1.2
    u, p = found["potential_energy"], found["pressure"]
    pressure = values.get("p", rho * (t + values["W"]))
    assert abs(u["mean"] - values["U"]) < 0.003 + 3 * u["standard_error"], (u, values)
    assert abs(p["mean"] - pressure) < 0.02 + 3 * p["standard_error"], (p, values)
