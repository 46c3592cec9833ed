"""Tables are read as they are by pandas, numpy, the standard library, R and gnuplot."""

from __future__ import annotations

import csv
import shutil
import subprocess

import numpy as np
import pytest

import lennard_validation as lv

SCENE = """
[system]
seed = 3
n_atoms = 108
density = 0.7
temperature = 1.2
[truncation]
r_cut = 2.2
[[stage]]
name = "production"
steps = 200
[[observable]]
kind = "rdf"
every = 20
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tables")
    (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
    return lv.run(folder / "scene.toml", out=folder / "out")


def columns(run, name):
    """Column by column, by the reader of the validation itself."""
    return {key: np.array(column) for key, column in run.table(name).items()}


@pytest.mark.parametrize("name", ["thermo", "rdf", "measured"])
def test_numpy_takes_names_from_the_first_line(run, name):
    table = np.genfromtxt(run.folder / f"{name}.csv", delimiter=",", names=True)
    expected = columns(run, name)
    assert list(table.dtype.names) == list(expected)
    for key, column in expected.items():
        np.testing.assert_array_equal(table[key], column)


@pytest.mark.parametrize("name", ["thermo", "rdf", "measured"])
def test_pandas_leaves_comments_out(run, name):
    pandas = pytest.importorskip("pandas")
    table = pandas.read_csv(run.folder / f"{name}.csv", comment="#", float_precision="round_trip")
    expected = columns(run, name)
    assert list(table) == list(expected)
    for key, column in expected.items():
        np.testing.assert_array_equal(table[key].to_numpy(dtype=float), column)


def test_comments_have_unit_words_and_symbol(run):
    lines = (run.folder / "thermo.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("step,time,stage,temperature,")
    assert "# potential_energy [ε per particle]: potential energy U/N" in lines
    assert "# pressure [ε/σ³]: pressure P" in lines
    with open(run.folder / "thermo.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert [float(row["pressure"]) for row in rows] == run.table("thermo")["pressure"]


@pytest.mark.skipif(shutil.which("Rscript") is None, reason="R is not installed")
def test_r_reads_it(run):
    code = 't <- read.csv("thermo.csv", comment.char = "#"); cat(names(t)[4], nrow(t))'
    said = subprocess.run(["Rscript", "-e", code], cwd=run.folder, capture_output=True, text=True, check=True)
    assert said.stdout.split() == ["temperature", str(len(run.table("thermo")["step"]))]


@pytest.mark.skipif(shutil.which("gnuplot") is None, reason="gnuplot is not installed")
def test_gnuplot_reads_it(run):
    code = 'set datafile separator comma; stats "thermo.csv" using "temperature" nooutput; print STATS_records'
    said = subprocess.run(["gnuplot", "-e", code], cwd=run.folder, capture_output=True, text=True, check=True)
    assert int(said.stderr.split()[-1]) == len(run.table("thermo")["step"])
