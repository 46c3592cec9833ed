"""The free energy of a dense fluid from a sweep along an isotherm and down to its temperature.

Trial particles find no room in a dense liquid. The residual Helmholtz energy then follows from two integrals over states,

    a_res/T = ∫ (Z - 1)/ρ' dρ' from 0 to ρ at T₁  +  ∫ u dβ from 1/T₁ to 1/T at ρ,

with the compressibility factor Z = P/(ρT) and the potential energy u of a particle. Then μ_res = a_res + T(Z - 1), and
s_res = (u - a_res)/T. The points of `inputs/sweep/free-energy.toml` are the nodes of Gauss and Legendre:

    lennard sweep sweep/free-energy --out runs/free-energy
    python -m lennard.free_energy runs/free-energy
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["FreeEnergy", "State", "along_path", "of_sweep"]

_SAME = 1e-9


@dataclass(frozen=True)
class State:
    """A run at one state: density, temperature of the bath, and two means with their standard errors."""

    density: float
    temperature: float
    excess_pressure: float
    """P - ρT at the temperature that belongs to the positions, ε/σ³."""
    pressure_error: float
    potential_energy: float
    energy_error: float


@dataclass(frozen=True)
class FreeEnergy:
    """Residual properties of a particle at the last state of a path, each with its standard error."""

    density: float
    temperature: float
    helmholtz: float
    helmholtz_error: float
    chemical_potential: float
    chemical_potential_error: float
    entropy: float
    entropy_error: float

    def __str__(self) -> str:
        rows = [
            ("residual Helmholtz energy, ε", self.helmholtz, self.helmholtz_error),
            ("residual chemical potential, ε", self.chemical_potential, self.chemical_potential_error),
            ("residual entropy, k_B", self.entropy, self.entropy_error),
        ]
        lines = [f"ρ = {self.density:g}, T = {self.temperature:g}"]
        lines += [f"  {name:<31} {value:8.4f} ± {error:.4f}" for name, value, error in rows]
        return "\n".join(lines)


def along_path(states: Sequence[State]) -> FreeEnergy:
    """The free energy at the coldest of the densest states.

    States at the highest temperature make the isotherm, from density 0 on. States at the highest density make the way
    down to the coldest of them, which itself gives the last pressure and energy. Each integral is exact for a
    polynomial through its nodes.
    """
    if not states:
        raise ValueError("no state: a path has an isotherm, and a way from it down to the last state")
    hot = max(s.temperature for s in states)
    dense = max(s.density for s in states)
    at_density = [s for s in states if abs(s.density - dense) < _SAME]
    last = min(at_density, key=lambda s: s.temperature)
    isotherm = [s for s in states if abs(s.temperature - hot) < _SAME and s is not last]
    down = [s for s in at_density if s is not last and s not in isotherm]
    stray = len(states) - len(isotherm) - len(down) - 1
    if stray or not isotherm or (not down and last.temperature < hot - _SAME):
        raise ValueError(
            f"{stray} states lie neither on the isotherm T = {hot:g} nor at the density {dense:g}; "
            f"{len(isotherm)} are on the isotherm and {len(down)} at the density"
        )
    first = _integral(
        0.0,
        dense,
        [s.density for s in isotherm],
        [s.excess_pressure / (s.density**2 * hot) for s in isotherm],
        [s.pressure_error / (s.density**2 * hot) for s in isotherm],
    )
    second = _integral(
        1.0 / hot,
        1.0 / last.temperature,
        [1.0 / s.temperature for s in down],
        [s.potential_energy for s in down],
        [s.energy_error for s in down],
    )
    t = last.temperature
    helmholtz = t * (first[0] + second[0])
    error = t * math.hypot(first[1], second[1])
    return FreeEnergy(
        density=dense,
        temperature=t,
        helmholtz=helmholtz,
        helmholtz_error=error,
        chemical_potential=helmholtz + last.excess_pressure / dense,
        chemical_potential_error=math.hypot(error, last.pressure_error / dense),
        entropy=(last.potential_energy - helmholtz) / t,
        entropy_error=math.hypot(error, last.energy_error) / t,
    )


def of_sweep(folder: str | Path) -> FreeEnergy:
    """The free energy from the finished points of a sweep."""
    records = sorted(Path(folder).glob("*/run.json"))
    if not records:
        raise ValueError(f"{folder} holds no point of a sweep: it has no */run.json")
    return along_path([_state(path) for path in records])


def _state(path: Path) -> State:
    record: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    if not record["finished"]:
        raise ValueError(f"{path.parent}: the run did not finish")
    system, averages = record["scene"]["system"], record["averages"]

    def mean(name: str) -> tuple[float, float]:
        found = averages[name]
        if found["standard_error"] is None:
            raise ValueError(f"{path.parent}: {name} has no standard error: {found['reason']}")
        return found["mean"], found["standard_error"]

    density = system["density"]
    pressure, pressure_error = mean("pressure")
    energy, energy_error = mean("potential_energy")
    half_steps = averages.get("temperature_half_steps", averages["temperature"])["mean"]
    return State(density, system["temperature"], pressure - density * half_steps, pressure_error, energy, energy_error)


def _integral(
    start: float, end: float, nodes: Sequence[float], values: Sequence[float], errors: Sequence[float]
) -> tuple[float, float]:
    """∫ of the polynomial through the values, with its standard error."""
    if not nodes:
        return 0.0, 0.0
    half = 0.5 * (end - start)
    x = (np.asarray(nodes) - start) / half - 1.0
    # Of the polynomials of Legendre the first alone has an integral, 2.
    moments = np.zeros(len(nodes))
    moments[0] = 2.0
    weights = half * np.linalg.solve(np.polynomial.legendre.legvander(x, len(nodes) - 1).T, moments)
    return float(weights @ np.asarray(values)), float(np.linalg.norm(weights * np.asarray(errors)))


def main() -> int:
    """Prints the free energy of the sweeps that are named."""
    if len(sys.argv) < 2:
        print("python -m lennard.free_energy FOLDER: the output folder of a sweep such as sweep/free-energy", file=sys.stderr)
        return 2
    for folder in sys.argv[1:]:
        try:
            print(of_sweep(folder))
        except ValueError as error:
            print(f"{folder}: {error}", file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
