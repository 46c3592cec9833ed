"""Means, tables, methods by name, equations of state and sweeps."""

from __future__ import annotations

import inspect
import pickle
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import lennard
import numpy as np
import pytest
from lennard._tables import with_error


@pytest.fixture(scope="module")
def run():
    simulation = lennard.Simulation.liquid(density=0.5, temperature=2.0, n=256, seed=4)
    simulation.equilibrate(400)
    return simulation.run(6000, measure=[lennard.observable.rdf(every=20), "msd"])


def test_means_have_errors_and_units(run):
    pressure = run.averages["pressure"]
    assert pressure.unit == "ε/σ³" and 0 < pressure.error < 0.5 and pressure.n_eff > 10
    assert float(pressure) == pressure.value
    record = run.record["averages"]["pressure"]
    assert (pressure.value, pressure.error) == (record["mean"], record["standard_error"])
    assert "pressure" in repr(run) and "ε/σ³" in run._repr_html_()
    with pytest.raises(KeyError, match="nothing called `presure` was measured; there are"):
        run.averages["presure"]
    with pytest.raises(KeyError, match="there are `shear_viscosity`, the Green–Kubo integral"):
        run.averages["shear_viscosity_einstein_helfand"]
    frame = run.averages.to_pandas()
    assert frame.loc["pressure", "value"] == pressure.value


def test_a_mean_is_formatted_like_a_number(run):
    mean = run.averages["pressure"]
    assert f"{mean:.3f}" == f"{mean.value:.3f}" and f"{mean}" == str(mean)


def test_a_mean_that_is_no_result_says_why():
    run = lennard.Simulation.liquid(density=0.8, temperature=1.0, n=256).run(20)
    mean = run.averages["pressure"]
    assert not mean.is_sound and np.isnan(mean.error) and mean.reason
    assert mean.reason.split()[0] in mean._repr_html_()


def test_numbers_are_written_with_their_errors():
    assert with_error(0.19234, 0.0031) == "0.192(3)"
    assert with_error(-6.12342, 0.00123) == "-6.1234(12)"
    assert with_error(1234.5, 17.0) == "1234 ± 17"
    assert with_error(1.5, float("nan")) == "1.5"


def test_tables_are_arrays_frames_and_html(run):
    rdf = run.rdf
    assert rdf is run.tables["rdf"]
    assert np.array_equal(rdf.r, rdf["r"]) and rdf["g"].max() > 1.5
    frame = rdf.to_pandas()
    assert list(frame["r"]) == list(rdf["r"])
    assert "<table>" in rdf._repr_html_() and "r [σ]" in repr(rdf)
    with pytest.raises(KeyError, match="has no column `q`; it has r"):
        rdf["q"]
    with pytest.raises(AttributeError, match="this run has no table `sdf`"):
        run.sdf
    copied = pickle.loads(pickle.dumps(run))
    assert np.array_equal(copied.rdf["g"], rdf["g"])
    assert isinstance(copied.averages["pressure"], lennard.Mean)


def test_comparison_is_the_record(run):
    table = run.compare()
    assert len(table) == len(run.record["comparison"]) > 0


def test_methods_have_names_keys_and_documentation():
    assert lennard.thermostat.bussi(tau=0.5) == {"kind": "bussi", "tau": 0.5}
    assert repr(lennard.thermostat.bussi(tau=0.5)) == "thermostat.bussi(tau=0.5)"
    for group in (
        lennard.thermostat,
        lennard.barostat,
        lennard.potential,
        lennard.truncation,
        lennard.integrator,
        lennard.observable,
        lennard.wall,
    ):
        assert len(dir(group)) >= 2, group
        for name in dir(group):
            make = getattr(group, name)
            assert make()["kind"] == name.replace("_", "-")
            assert make.__doc__
            inspect.signature(make)
    assert "tau" in inspect.signature(lennard.thermostat.bussi).parameters
    with pytest.raises(AttributeError, match="nearest: bussi"):
        lennard.thermostat.busi()
    table = lennard.barostat.stochastic_cell_rescaling(pressure=1.0)
    assert pickle.loads(pickle.dumps(table)) == table


def test_every_table_of_the_scene_may_be_given():
    simulation = lennard.Simulation.liquid(
        density=0.7,
        temperature=1.0,
        n=256,
        potential=lennard.potential.mie(repulsive=12),
        truncation={"kind": "shift", "r_cut": 2.4},
        output={"thermo_every": 5},
    )
    assert "mie" in simulation.scene and "2.4" in simulation.scene
    run = simulation.run(20)
    assert list(run.thermo["step"]) == [5, 10, 15, 20]


def test_equations_of_state_are_the_program_s():
    thol = lennard.eos.thol_2016
    assert thol.potential_energy(0.8442, 0.722) == pytest.approx(-6.080081, abs=1e-6)
    assert thol.pressure(0.8442, 0.722) == pytest.approx(0.165090, abs=1e-6)
    grid = thol.pressure(np.array([0.1, 0.8442, 50.0]), 0.722)
    assert grid[1] == thol.pressure(0.8442, 0.722) and np.isnan(grid[2])
    with pytest.raises(ValueError, match="covers temperatures from"):
        thol.pressure(0.8, 1e-3)
    both = thol.coexistence(1.0)
    assert both.vapor_density < 0.05 < 0.65 < both.liquid_density
    assert thol.coexistence(1.4) is None
    assert thol.density(both.pressure * 2, 1.0) > both.liquid_density
    assert thol.phase(0.8442, 0.722).is_stable
    assert not thol.phase(0.4, 0.8).is_stable
    assert "2.5" in lennard.eos.thol_2015.model
    assert len(lennard.eos.equations) >= 3
    for equation in lennard.eos.equations.values():
        density, temperature = 0.02, 2.0
        assert equation.property("compressibility_factor", density, temperature) == pytest.approx(1.0, abs=0.1)
    assert thol.at(0.5, 2.0).keys() == lennard.eos.properties.keys()
    assert lennard.eos.properties["pressure"].unit == "ε/σ³"
    with pytest.raises(ValueError, match="there is no such property"):
        thol.property("presure", 0.5, 2.0)


SCENE = {
    "system": {"n_atoms": 108, "density": 0.5, "temperature": 1.5},
    "truncation": {"r_cut": 2.2},
    "stage": [{"name": "a", "steps": 200}],
}


def test_a_sweep_is_the_same_with_any_executor(tmp_path):
    grid = {"temperature": [1.5, 2.0], "seed": [1, 2]}
    plain = lennard.sweep(SCENE, grid)
    assert len(plain) == 4 and [p.values["seed"] for p in plain] == [1, 2, 1, 2]
    with ThreadPoolExecutor(2) as executor:
        threads = lennard.sweep(SCENE, grid, executor=executor)
    with ProcessPoolExecutor(2) as executor:
        processes = lennard.sweep(SCENE, grid, executor=executor)
    for a, b, c in zip(plain, threads, processes, strict=True):
        assert a.run.record["averages"] == b.run.record["averages"] == c.run.record["averages"]
    assert plain[0].run.record["averages"] != plain[1].run.record["averages"]
    frame = plain.to_pandas()
    assert list(frame["temperature"][:2]) != [] and "pressure_error" in frame
    file = tmp_path / "base.toml"
    file.write_text(plain[0].run.scene)
    again = lennard.sweep(file, points=[{"system.seed": 2}])
    assert again[0].run.record["averages"] == plain[1].run.record["averages"]


def test_a_sweep_takes_a_scene_of_the_program_and_keeps_the_values_of_its_keys():
    short = {"stage.melt.steps": 5, "stage.equilibrate.steps": 5, "stage.production.steps": 50}
    made = lennard.sweep("template", {"temperature": [1.0, 1.5]}, set={**short, "truncation.r_cut": 2.5})
    table = made.to_pandas()
    assert list(table["temperature"]) == [1.0, 1.5] and list(table["failure"]) == ["", ""]
    measured = [point.run.averages["temperature"].value for point in made]
    assert list(table["temperature_measured"]) == measured


def test_a_sweep_refuses_wrong_points_before_anything_runs():
    for one in (0.5, "fcc"):
        with pytest.raises(TypeError, match="needs a list of values"):
            lennard.sweep(SCENE, {"start.lattice": one})
    with pytest.raises(lennard.SceneError, match="system.density"):
        lennard.sweep(SCENE, {"density": [0.5, -1.0]})
    with pytest.raises(TypeError, match="a grid or points"):
        lennard.sweep(SCENE)
    with pytest.raises(ValueError, match="at least one point"):
        lennard.sweep(SCENE, points=[])


def test_a_point_that_fails_keeps_its_error():
    made = lennard.sweep(SCENE, {"dt": [0.004, 0.2]}, set={"stage.a.steps": 2000})
    assert made[0].run is not None and made[0].error is None
    assert isinstance(made[1].error, lennard.PhysicsError) and made[1].run is None
    assert "1 failed" in repr(made)


def test_a_mean_that_is_no_result_prints_what_is_wrong():
    facts = {"name": "pressure", "n_eff": 3.0, "unit": "ε/σ³", "freedom": 2.0, "equilibration_cut": 0}
    short = lennard.Mean(value=1.5, error=float("nan"), standing="too-short", reason="worth 3 samples", **facts)
    assert str(short) == "1.5 ε/σ³ (too short)"
    sound = lennard.Mean(value=1.5, error=0.1, standing="sound", reason="", **facts)
    assert str(sound) == "1.50(10) ε/σ³"
