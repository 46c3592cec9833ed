"""The page of a sweep beside the equations: its numbers are the numbers of the sweep, and what it cannot say is refused."""

from __future__ import annotations

import csv
import math
import subprocess
import sys

import pytest

import beside_equations
import lennard_validation as lv
from conftest import Scene

SWEEP = """
base = "scene.toml"
[grid]
density = [0.2, 0.3, 0.4]
temperature = 3.0
"""


@pytest.fixture(scope="module")
def states(tmp_path_factory):
    """The folder of a sweep over three states of a hot fluid at constant temperature."""
    folder = tmp_path_factory.mktemp("states")
    Scene(n_atoms=108, truncation='kind = "cut"\nr_cut = 3.0', thermostat='"bussi"', steps=6000).write(folder)
    (folder / "sweep.toml").write_text(SWEEP, encoding="utf-8")
    command = [str(lv.binary()), "sweep", "sweep.toml", "--out", "out", "--quiet", "--no-report"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "out"


def page(folder) -> str:
    """What the script prints."""
    command = [sys.executable, beside_equations.__file__, str(folder)]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=True).stdout


def test_errors_have_two_digits_or_fewer():
    for value, error, text in [
        (2.3016, 0.00997, "2.302(10)"),
        (5.6148, 0.0099501, "5.615(10)"),
        (5.6148, 0.0099, "5.6148(99)"),
        (1.25, 0.1, "1.25(10)"),
        (1234.5, 99.7, "1234(100)"),
        (2.0, math.nan, "2"),
    ]:
        assert beside_equations.measured(value, error) == text


def test_chi_squared_of_the_page_follows_from_the_differences_of_the_sweep(states):
    with open(states / "beside_equations.csv", newline="", encoding="utf-8") as file:
        lines = csv.DictReader(line for line in file if not line.startswith("#"))
        rows = [row for row in lines if row["property"] == "potential_energy"]
    assert len(rows) == 3
    z = [float(row["difference_thol_2016"]) / float(row["error_of_difference"]) for row in rows]
    assert all(float(row["error_of_difference"]) < float(row["standard_error"]) for row in rows)
    lines = page(states).splitlines()
    heading = next(line for line in lines if line.startswith("| Property |"))
    entry = next(line for line in lines if line.startswith("| U |"))
    column = heading.split(" | ").index("Thol 2016")
    printed, rest = entry.split(" | ")[column].split(" (3 points, ")
    # χ² has three digits, and the largest distance one decimal.
    assert float(printed) == pytest.approx(sum(x * x for x in z) / 3, rel=6e-3)
    assert float(rest.rstrip(") |")) == pytest.approx(max(z, key=abs), abs=0.051)
    assert "The model is: Lennard-Jones, cut at 3 σ, with tail correction." in "\n".join(lines)
    assert sum("error at given T" in line for line in lines) == 2


def test_a_page_of_a_run_at_constant_energy_is_refused(states):
    scene = next(states.glob("rho0.3*")) / "scene.toml"
    before = scene.read_text(encoding="utf-8")
    cut = before.index("[stage.thermostat]", before.index('name = "production"'))
    scene.write_text(before[:cut] + "[stage.unused]" + before[cut + len("[stage.thermostat]") :], encoding="utf-8")
    with pytest.raises(subprocess.CalledProcessError) as refused:
        page(states)
    scene.write_text(before, encoding="utf-8")
    assert "a page is of runs at constant density and temperature" in refused.value.stderr


def test_a_page_is_of_one_model():
    with pytest.raises(SystemExit, match="a page is of one model"):
        beside_equations.the_model([{"model": "one"}, {"model": "another"}])
