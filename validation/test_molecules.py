"""Molecules read back by ASE and mdtraj, and long runs of two-center fluids judged by teqp (`cargo xtask physics`)."""

from __future__ import annotations

import mdtraj
import numpy as np
import pytest
import teqp

import lennard_validation as lv

LENGTH = 0.67

#: States of the two-center fluid: (bond length, density of molecules, temperature), in gas, supercritical fluid and liquid.
STATES = [
    (0.67, 0.458, 2.0),
    (0.67, 0.25, 2.6),
    (0.505, 0.5, 2.0),
    (0.3292, 0.5, 3.0),
    (0.505, 0.05, 3.2),
]


def dumbbells(length: float, density: float, temperature: float, molecules: int, steps: tuple[int, int]) -> str:
    return f"""
[system]
n_molecules = {molecules}
density = {density}
temperature = {temperature}
seed = 7

[molecule]
bond_length = {length}

[truncation]
kind = "cut"
r_cut = {min(4.0, 0.49 * (molecules / density) ** (1 / 3)):.3f}

[integrator]
dt = 0.002

[[stage]]
name = "equilibrate"
steps = {steps[0]}
thermostat = {{ kind = "bussi", tau = 0.2 }}

[[stage]]
name = "production"
steps = {steps[1]}
thermostat = {{ kind = "bussi", tau = 0.2 }}

[[observable]]
kind = "molecules"

[output]
trajectory_every = 50
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory) -> lv.Run:
    folder = tmp_path_factory.mktemp("dumbbells")
    (folder / "small.toml").write_text(dumbbells(LENGTH, 0.4, 2.0, 108, (200, 400)), encoding="utf-8")
    return lv.run(folder / "small.toml", out=folder / "out")


def test_ase_reads_the_molecule_of_each_site_and_bonds_of_one_length(small):
    frames = lv.load_frames(small.folder)
    assert len(frames) == 8
    for frame in frames:
        molecule = frame.arrays["molecule"]
        np.testing.assert_array_equal(molecule, np.repeat(np.arange(1, 109), 2))
        first, second = np.arange(0, 216, 2), np.arange(1, 216, 2)
        bonds = np.array([frame.get_distance(i, j, mic=True) for i, j in zip(first, second)])
        np.testing.assert_allclose(bonds, LENGTH, rtol=1e-12)
        velocities = frame.arrays["velo"]
        unwrapped = frame.positions + frame.arrays["map_shift"] * frame.cell.lengths()
        along = np.einsum("ij,ij->i", unwrapped[second] - unwrapped[first], velocities[second] - velocities[first])
        assert np.abs(along).max() < 1e-9


def test_mdtraj_sees_one_residue_per_molecule(small):
    structure = mdtraj.load(str(small.folder / "topology.gro"))
    assert structure.n_residues == 108
    assert {residue.n_atoms for residue in structure.topology.residues} == {2}


def test_degrees_of_freedom_and_temperatures_of_the_record_are_those_of_the_frames(small):
    assert small.record["n_dof"] == 6 * 108 - 108 - 3
    frame = lv.load_frames(small.folder)[-1]
    velocities = frame.arrays["velo"]
    temperature = (velocities**2).sum() / small.record["n_dof"]
    table = small.table("thermo")
    row = table["step"].index(float(frame.info["Step"]))
    assert temperature == pytest.approx(table["temperature"][row], rel=1e-9)
    centers = 0.5 * (velocities[::2] + velocities[1::2])
    of_centers = 2.0 * (centers**2).sum() / (3 * 108 - 3)
    measured = small.table("molecules")
    assert any(of_centers == pytest.approx(t, rel=1e-9) for t in measured["temperature_of_centers"])


def equation(length: float, density: float, temperature: float, author: str) -> tuple[float, float]:
    """u and p of an equation, by teqp."""
    model = teqp.make_model({"kind": "2CLJF", "model": {"author": f"2CLJF_{author}", "L^*": length}})
    z = np.array([1.0])
    u = temperature * model.get_Ar10(temperature, density, z)
    return u, density * temperature * (1.0 + model.get_Ar01(temperature, density, z))


@pytest.mark.physics
@pytest.mark.parametrize("state", STATES, ids=lambda s: "L{}-rho{}-T{}".format(*s))
def test_energy_and_pressure_are_those_of_the_nearer_equation(state, tmp_path):
    length, density, temperature = state
    (tmp_path / "fluid.toml").write_text(dumbbells(*state, 500, (10_000, 100_000)), encoding="utf-8")
    found = lv.run(tmp_path / "fluid.toml", out=tmp_path / "out").averages
    measured = found["temperature_half_steps"]["mean"]
    u, p = found["potential_energy"], found["pressure"]
    equations = [equation(length, density, measured, author) for author in ("Mecke", "Lisal")]
    off_u = min(abs(u["mean"] - e[0]) for e in equations)
    off_p = min(abs(p["mean"] - e[1]) for e in equations)
    assert off_u < 0.02 + 3 * u["standard_error"], (u, equations)
    assert off_p < 0.03 + 3 * p["standard_error"], (p, equations)
    trans, inside = found["temperature_of_centers"], found["temperature_inside_molecules"]
    error = np.hypot(trans["standard_error"], inside["standard_error"])
    assert abs(trans["mean"] - inside["mean"]) < 4 * error + 2e-3 * temperature
