"""Reference configurations of NIST, through `lennard energy`.

The full-precision columns were computed from the coordinate files. Each agrees with all the digits
that NIST prints (NIST Standard Reference Simulation Website, Lennard-Jones Fluid Reference
Calculations: Cuboid Cell; DOI 10.18434/T4M88Q).
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest

import lennard_validation as lv
from conftest import Scene

REFERENCE = Path(__file__).parent / "reference" / "nist"

#: Up to 85,488 pair terms, in another order of summation.
RELATIVE = 1e-12

TRUNCATION = {
    "LRC": 'kind = "cut"\ntail_correction = true',
    "LTS": 'kind = "shift"',
    "LFS": 'kind = "force-shift"',
}


def rows() -> list[dict]:
    with open(REFERENCE / "reference_calculations.csv", encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return [row for row in table if row["cell"] == "cuboid"]


def name(row: dict) -> str:
    return f"{row['config']}-{row['truncation']}-{row['rc']}"


def evaluate(row: dict, folder: Path, **settings) -> dict:
    scene = Scene(
        configuration=REFERENCE / f"lj_sample_config_periodic{row['config']}.txt",
        temperature=0.9,
        truncation=f"{TRUNCATION[row['truncation']]}\nr_cut = {row['rc']}",
    )
    return lv.energy(scene.write(folder), settings=settings)


def test_all_rows_are_there():
    assert len(rows()) == 18
    assert {row["truncation"] for row in rows()} == set(TRUNCATION)


@pytest.mark.parametrize("kernel", ["auto", "reference"])
@pytest.mark.parametrize("row", rows(), ids=name)
def test_energy_virial_and_tails_are_nists(row, kernel, tmp_path):
    """Configuration 4 at r_cut 4 has r_cut = L/2 exactly, which is legal."""
    ours = evaluate(row, tmp_path, **{"kernel.kernel": kernel})
    assert ours["atoms"] == int(row["N"])
    assert ours["pairs"] == int(row["pairs_inside"])
    for key, column in [
        ("potential_energy", "computed_U_pair"),
        ("virial", "computed_W_pair"),
        ("tail_energy", "computed_U_LRC"),
        ("tail_virial", "computed_W_LRC"),
    ]:
        assert ours[key] == pytest.approx(float(row[column]), rel=RELATIVE, abs=0.0), key
    for key, column in [
        ("potential_energy", "published_U_pair"),
        ("virial", "published_W_pair"),
        ("tail_energy", "published_U_LRC"),
    ]:
        if row[column] and float(row[column]) != 0.0:
            # Five digits are printed.
            digits = 4 - math.floor(math.log10(abs(float(row[column]))))
            assert round(ours[key], digits) == pytest.approx(float(row[column]), rel=1e-9), key
    volume = float(row["box"]) ** 3
    pressure = int(row["N"]) / volume * 0.9 + (ours["virial"] + ours["tail_virial"]) / (3.0 * volume)
    assert ours["pressure"] == pytest.approx(pressure, rel=RELATIVE)
    assert ours["temperature_from"] == "scene-temperature"
