"""Pressures along an isotherm beside the equation of state, on the processors of this machine."""

from concurrent.futures import ProcessPoolExecutor
from typing import Any

import lennard

SCENE: dict[str, Any] = {
    "system": {"n_atoms": 500, "density": 0.1, "temperature": 2.0},
    "truncation": {"r_cut": 4.0},
    "stage": [
        {"name": "equilibrate", "steps": 1000, "thermostat": "bussi"},
        {"name": "measure", "steps": 8000, "thermostat": "bussi"},
    ],
}

if __name__ == "__main__":
    with ProcessPoolExecutor(2) as executor:
        points = lennard.sweep(SCENE, {"density": [0.1, 0.3, 0.5, 0.7]}, executor=executor)
    for point in points:
        assert point.run is not None, point.error
        density = point.values["density"]
        reference = lennard.eos.thol_2016.pressure(density, 2.0)
        print(f"ρ = {density}: P = {point.run.averages['pressure']}, Thol 2016 {reference:.3f}")
