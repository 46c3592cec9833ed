"""The scatter of seeds is taken apart as its numbers say."""

from __future__ import annotations

import csv
import math

import pytest

import scatter_of_seeds


@pytest.fixture
def folder(tmp_path):
    """Six seeds of one state on a line in the energy, 0.1 to either side of it, and three of another."""
    with open(tmp_path / "table.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        columns = [f"{key}{end}" for key in ("speed_of_sound", "heat_capacity") for end in ("", "_standard_error")]
        table.writerow(["name", "conserved_energy", *columns])
        file.write("# conserved_energy [ε]: conserved energy (E − heat)/N\n")
        for k, off in enumerate([0.1, -0.1, -0.1, 0.1, 0.1, -0.1]):
            table.writerow([f"rho0.8-T1-seed{k}", k, 5 + 2 * k + off, 0.11, 2.5, ""])
        for k in range(3):
            table.writerow([f"rho0.7-T1-seed{k}", k, 4.0, 0.1, 2.5, 0.1])
    return tmp_path


def test_the_scatter_about_a_line_is_smaller_than_the_scatter(folder):
    states = scatter_of_seeds.states(folder)
    assert list(states) == ["rho0.8-T1", "rho0.7-T1"]
    told = scatter_of_seeds.line(states["rho0.8-T1"], "speed_of_sound")
    # √(2²·17.5/5) = 3.74 with the line, and √(6·0.1²/4) = 0.12 without it.
    assert told.startswith("w: 10 ± 1.5, 6 seeds: scatter 3.7, about a line in the energy 0.12, printed 0.11"), told


def test_three_seeds_and_means_without_an_error_tell_nothing(folder):
    states = scatter_of_seeds.states(folder)
    assert scatter_of_seeds.line(states["rho0.7-T1"], "speed_of_sound") is None
    assert scatter_of_seeds.line(states["rho0.8-T1"], "heat_capacity") is None
    assert math.isclose(scatter_of_seeds.about_line([0, 1, 2, 3], [1, 3, 5, 7]), 0, abs_tol=1e-12)
