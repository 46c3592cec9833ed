"""Equations of state of the Lennard-Jones fluid, as the literature has them.

``lennard.eos.thol_2016.pressure(density, temperature)``; numbers or numpy arrays, reduced units. A state that an
equation does not cover raises ``ValueError`` for numbers and gives ``nan`` in arrays.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _lennard
from ._arrays import number, numbers

__all__ = [
    "Coexistence",
    "EquationOfState",
    "Phase",
    "Property",
    "equations",
    "kolafa_nezbeda_1994",
    "properties",
    "thol_2015",
    "thol_2016",
]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Coexistence:
    """A vapor and a liquid in equilibrium: pressure in ε/σ³, densities in σ⁻³."""

    temperature: float
    pressure: float
    vapor_density: float
    liquid_density: float


@dataclass(frozen=True)
class Phase:
    """Where a state lies in the phase diagram."""

    name: str
    description: str
    is_stable: bool


@dataclass(frozen=True)
class Property:
    """A property that every equation of state gives."""

    key: str
    name: str
    equation: str
    unit: str


#: The properties by key.
properties: dict[str, Property] = {entry[0]: Property(*entry) for entry in _lennard.property_list()}


class EquationOfState:
    """An equation of state; ``model`` says of which potential."""

    def __init__(self, spec: dict[str, Any]) -> None:
        self._spec = spec
        self.key: str = spec["key"]
        self.name: str = spec["name"]
        self.model: str = spec["model"]
        self.citation: str = spec["citation"]
        self.doi: str = spec["doi"]
        self.status: str = spec["status"]
        self.temperature_range: tuple[float, float] = (spec["range"]["t_min"], spec["range"]["t_max"])
        self.largest_pressure: float = spec["range"]["p_max"]
        self.critical_temperature: float = spec["critical"]["temperature"]
        self.critical_density: float = spec["critical"]["density"]

    def at(self, density: float, temperature: float) -> dict[str, float]:
        """All properties at a density (σ⁻³) and a temperature (ε/k_B), by name, for each particle."""
        return _lennard.properties(self.key, number("density", density), number("temperature", temperature))

    @overload
    def property(self, name: str, density: float, temperature: float) -> float: ...
    @overload
    def property(self, name: str, density: Floats, temperature: Floats | float) -> Floats: ...
    @overload
    def property(self, name: str, density: float, temperature: Floats) -> Floats: ...
    def property(self, name: str, density: Any, temperature: Any) -> Any:
        """A property by its key in :data:`properties`."""
        if name not in properties:
            raise ValueError(f"there is no such property\n  found:   {name!r}\n  allowed: {', '.join(properties)}")
        given = numbers("density", density), numbers("temperature", temperature)
        if given[0].ndim == given[1].ndim == 0:
            return self.at(float(given[0]), float(given[1]))[name]

        def one(rho: float, t: float) -> float:
            try:
                return self.at(rho, t)[name]
            except ValueError:
                return float("nan")

        return _each(one, *given)

    @overload
    def pressure(self, density: float, temperature: float) -> float: ...
    @overload
    def pressure(self, density: Floats, temperature: Floats | float) -> Floats: ...
    @overload
    def pressure(self, density: float, temperature: Floats) -> Floats: ...
    def pressure(self, density: Any, temperature: Any) -> Any:
        """Pressure, ε/σ³, the ideal part included."""
        return self.property("pressure", density, temperature)

    @overload
    def potential_energy(self, density: float, temperature: float) -> float: ...
    @overload
    def potential_energy(self, density: Floats, temperature: Floats | float) -> Floats: ...
    @overload
    def potential_energy(self, density: float, temperature: Floats) -> Floats: ...
    def potential_energy(self, density: Any, temperature: Any) -> Any:
        """Potential energy of a particle, ε."""
        return self.property("potential_energy", density, temperature)

    @overload
    def heat_capacity(self, density: float, temperature: float) -> float: ...
    @overload
    def heat_capacity(self, density: Floats, temperature: Floats | float) -> Floats: ...
    @overload
    def heat_capacity(self, density: float, temperature: Floats) -> Floats: ...
    def heat_capacity(self, density: Any, temperature: Any) -> Any:
        """Isochoric heat capacity of a particle, k_B, the kinetic part included."""
        return self.property("heat_capacity", density, temperature)

    @overload
    def speed_of_sound(self, density: float, temperature: float) -> float: ...
    @overload
    def speed_of_sound(self, density: Floats, temperature: Floats | float) -> Floats: ...
    @overload
    def speed_of_sound(self, density: float, temperature: Floats) -> Floats: ...
    def speed_of_sound(self, density: Any, temperature: Any) -> Any:
        """Speed of sound, σ/τ."""
        return self.property("speed_of_sound", density, temperature)

    def density(self, pressure: float, temperature: float) -> float | None:
        """Density of the stable fluid at a pressure, σ⁻³; ``None`` where the equation covers no such state."""
        return _lennard.density_at(self.key, number("pressure", pressure), number("temperature", temperature))

    def coexistence(self, temperature: float) -> Coexistence | None:
        """Vapor and liquid in equilibrium; ``None`` from the critical temperature on."""
        found = _lennard.coexistence(self.key, number("temperature", temperature))
        return None if found is None else Coexistence(float(temperature), *found)

    def freezing_density(self, temperature: float) -> float | None:
        """Density at which the liquid freezes, σ⁻³; ``None`` where that is not known."""
        return _lennard.freezing_density(self.key, number("temperature", temperature))

    def phase(self, density: float, temperature: float) -> Phase:
        """The phase of a state: ``liquid``, ``metastable-vapor``, ``outside-range``, …"""
        return Phase(*_lennard.phase_of(self.key, number("density", density), number("temperature", temperature)))

    def __repr__(self) -> str:
        return f"<{self.name}, for {self.model}; doi:{self.doi}>"


def _each(one: Callable[[float, float], float], density: Floats, temperature: Floats) -> Floats:
    try:
        xs, ys = np.broadcast_arrays(density, temperature)
    except ValueError:
        raise ValueError(
            f"density and temperature differ in shape\n  found:   {density.shape} and {temperature.shape}\n"
            "  allowed: numbers, or arrays of one shape"
        ) from None
    found = [one(float(x), float(y)) for x, y in zip(xs.ravel(), ys.ravel(), strict=True)]
    return np.array(found).reshape(xs.shape)


#: All equations by key.
equations: dict[str, EquationOfState] = {
    spec["key"]: EquationOfState(spec) for spec in json.loads(_lennard.equations_of_state())
}

#: Thol and others 2016, for the full Lennard-Jones potential.
thol_2016 = equations["thol-2016"]
#: Thol and others 2015, for the potential truncated at 2.5 σ and shifted.
thol_2015 = equations["thol-2015"]
#: Kolafa and Nezbeda 1994, for the full Lennard-Jones potential.
kolafa_nezbeda_1994 = equations["kolafa-nezbeda-1994"]
