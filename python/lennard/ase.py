"""Lennard for ASE: a calculator, and simulations from ``ase.Atoms``.

``Lennard`` serves whatever ASE does with a calculator. For speed, ``simulation(atoms)`` hands the atoms to the
engine. A step of ``ase.md`` costs more than a millisecond besides the forces. A whole step of the engine takes less
than a tenth of this time for 864 atoms.

Units are Å and eV as everywhere in ASE. ``sigma`` is in Å and ``epsilon`` in eV. With their defaults of 1 the
numbers are reduced units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, TypedDict

import numpy as np
from ase import Atoms, units
from ase.calculators.calculator import Calculator, all_changes

from . import _lennard
from ._forces import Forces
from ._simulation import Simulation

if TYPE_CHECKING:
    from ._tables import Floats

__all__ = ["ARGON", "Lennard", "Species", "simulation", "to_atoms"]


class Species(TypedDict):
    """σ in Å and ε in eV."""

    sigma: float
    epsilon: float


#: σ in Å and ε in eV of argon as Rahman 1964 has it: 3.405 Å and 119.8 K·k_B.
ARGON: Species = {"sigma": 3.405, "epsilon": 119.8 * units.kB}

#: ASE's order of the stress: xx, yy, zz, yz, xz, xy.
_VOIGT = ([0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1])


def _in_box(atoms: Atoms) -> tuple[Floats, Floats]:
    """The sides of the box, where the engine can use it, and the positions in it, Å.

    A relaxation of a cell leaves rounding across the axes. Positions follow the cell when this is taken out: a crystal stays
    without strain, and no shear grows from one step to the next.
    """
    if len(atoms) == 0:
        raise ValueError("there are no atoms\n  allowed: at least one atom")
    cell: Floats = np.asarray(atoms.cell.array)
    if not all(atoms.pbc):
        raise ValueError(
            f"the fluid is periodic along each axis\n  found:   pbc = {[bool(p) for p in atoms.pbc]}\n"
            "  allowed: pbc = True, with vacuum in the cell where a surface is wanted"
        )
    sides = _lennard.box_sides(cell.tolist())
    if sides is None:
        raise ValueError(
            f"the cell must be a box along x, y and z\n  found:   {cell.tolist()}\n"
            "  allowed: a cell with positive numbers on its diagonal and zeros elsewhere, to 1e-10 of a side\n"
            "  a filter of ASE keeps it a box with mask=[1, 1, 1, 0, 0, 0]"
        )
    straight = np.diag(sides)
    positions: Floats = atoms.positions
    if np.any(cell != straight):
        positions = atoms.get_scaled_positions(wrap=False) @ straight
    return np.array(sides), positions


def _one_species(atoms: Atoms) -> str:
    symbols = sorted(set(atoms.get_chemical_symbols()))
    if len(symbols) > 1:
        raise ValueError(
            f"one sigma and one epsilon describe one species\n  found:   {', '.join(symbols)}\n"
            "  allowed: atoms of one chemical symbol"
        )
    return symbols[0] if symbols else "X"


def _check_positive(name: str, value: object) -> None:
    if not (isinstance(value, SupportsFloat) and np.isfinite(float(value)) and float(value) > 0.0):
        raise ValueError(f"`{name}` must be a finite positive number\n  found: {value!r}")


def _check_reach(
    rc: float | None, truncation: str | Mapping[str, Any], potential: object, sigma: float, sides: Floats
) -> None:
    """Refuses a cell that is too small, in the units of ASE. A unit cell is, and users begin with one."""
    in_table = truncation.get("r_cut") if isinstance(truncation, Mapping) else None
    if rc is None and in_table is None and potential is not None:
        return  # Some potentials have a range of their own.
    reach = (2.5 if in_table is None else float(in_table)) * sigma if rc is None else float(rc)
    half = 0.5 * float(np.min(sides))
    if reach > half:
        raise ValueError(
            f"the cutoff does not fit the cell\n  found:   rc = {reach:.6g} Å, over half the shortest side {2 * half:.6g} Å\n"
            f"  allowed: rc up to {half:.6g} Å, or a larger cell, such as atoms.repeat({int(np.ceil(reach / half))})"
        )


class Lennard(Calculator):
    """A calculator for ASE with the potentials of this program.

    ``sigma``, ``rc`` and ``skin`` are in Å, and ``epsilon`` in eV. ``rc`` is 2.5 ``sigma`` unless given. ``truncation`` is
    the name of a truncation or its table: ``"cut"`` (plain), ``"shift"`` (what ``ase.calculators.lj`` computes),
    ``"force-shift"``, ``"switch"``. ``tail`` adds the corrections for the part beyond ``rc`` to energy and stress, for the
    plain cutoff. ``potential`` is another pair potential of the program, such as ``lennard.potential.mie(repulsive=12)``.

    The neighbor list is kept between calls and made anew only where atoms have moved too far.

    Stress is −W/V with W = Σ r ⊗ F: positive under tension, without the kinetic part, in ASE's order.
    """

    implemented_properties = ["energy", "free_energy", "energies", "forces", "stress"]
    default_parameters = {
        "sigma": 1.0,
        "epsilon": 1.0,
        "rc": None,
        "truncation": "shift",
        "tail": False,
        "potential": None,
        "skin": None,
        "precision": "double",
        "threads": None,
    }
    nolabel = True

    def __init__(self, **parameters: Any) -> None:
        self._forces: Forces | None = None
        #: Builds of the neighbor list so far.
        self.list_builds = 0
        super().__init__(**parameters)  # type: ignore[no-untyped-call]

    def set(self, **parameters: Any) -> dict[str, Any]:
        """Changes parameters; a change makes the next call begin anew."""
        unknown = sorted(parameters.keys() - self.default_parameters.keys())
        if "smooth" in unknown:
            raise ValueError(
                "`smooth` of ase.calculators.lj is the truncation `xplor` here\n"
                '  allowed: truncation={"kind": "xplor", "switch_from": ro / sigma}'
            )
        if unknown:
            allowed = ", ".join(self.default_parameters)
            raise TypeError(f"no such parameter\n  found:   {', '.join(unknown)}\n  allowed: {allowed}")
        for name in ("sigma", "epsilon"):
            _check_positive(name, parameters.get(name, 1.0))
        changed: dict[str, Any] = super().set(**parameters)  # type: ignore[no-untyped-call]
        if changed:
            self.reset()  # type: ignore[no-untyped-call]
            self._forces = None
        return changed

    def __deepcopy__(self, memo: dict[int, Any]) -> Lennard:
        return type(self)(**self.parameters)

    def calculate(
        self,
        atoms: Atoms | None = None,
        properties: Sequence[str] = ("energy",),
        system_changes: Sequence[str] = tuple(all_changes),
    ) -> None:
        """Energy, forces and stress; the energies of single atoms where they are asked for."""
        super().calculate(atoms, properties, system_changes)  # type: ignore[no-untyped-call]
        if self.atoms is None:
            raise ValueError("there are no atoms to calculate for")
        sides, positions = _in_box(self.atoms)
        if "numbers" in system_changes:
            _one_species(self.atoms)
        sigma, epsilon = self.parameters["sigma"], self.parameters["epsilon"]
        given = self.parameters
        _check_reach(given["rc"], given["truncation"], given["potential"], sigma, sides)
        if self._forces is None:
            self._forces = Forces(
                sides / sigma,
                given["potential"],
                truncation=_truncation(given["truncation"], given["tail"], _reduced(given["rc"], sigma)),
                neighbor=None if given["skin"] is None else {"skin": _reduced(given["skin"], sigma)},
                kernel={"precision": given["precision"]},
                threads=given["threads"],
            )
        found = self._forces.evaluate(
            positions / sigma, sides / sigma, virial=True, energies="energies" in properties
        )
        forces, energy, virial, energies = found
        self.list_builds = self._forces.builds
        self.results = {
            "energy": energy * epsilon,
            "free_energy": energy * epsilon,
            "forces": forces * (epsilon / sigma),
        }
        if virial is not None:
            self.results["stress"] = -virial[_VOIGT] * (epsilon / float(np.prod(sides)))
        if energies is not None:
            self.results["energies"] = energies * epsilon


def _reduced(length: float | None, sigma: float) -> float | None:
    return None if length is None else float(length) / sigma


def _truncation(kind: str | Mapping[str, Any], tail: bool, rc: float | None) -> dict[str, Any]:
    table: dict[str, Any] = {"kind": kind} if isinstance(kind, str) else dict(kind)
    if rc is not None:
        table["r_cut"] = rc
    if tail or table["kind"] == "cut":
        table.setdefault("tail_correction", bool(tail))
    return table


def simulation(
    atoms: Atoms,
    *,
    sigma: float = 1.0,
    epsilon: float = 1.0,
    rc: float | None = None,
    dt: float | None = None,
    truncation: str | Mapping[str, Any] = "shift",
    tail: bool = False,
    temperature: float | None = None,
    threads: int | None = None,
    set: Mapping[str, Any] | None = None,
    **tables: Any,
) -> Simulation:
    """A simulation by the engine that starts from ``atoms``, hundreds of times as fast as ``ase.md``.

    ``sigma`` in Å and ``epsilon`` in eV; ``rc`` in Å. ``dt`` is in ASE's units (``2 * ase.units.fs``). ``temperature``
    in K is for atoms without momenta. All atoms have one mass, the unit of mass of the run. The simulation itself is in
    reduced units, and ``simulation.to_ase(sigma=…, epsilon=…, mass=…)`` goes back.
    """
    _check_positive("sigma", sigma)
    _check_positive("epsilon", epsilon)
    if atoms.constraints:
        kinds = ", ".join(type(constraint).__name__ for constraint in atoms.constraints)
        raise ValueError(
            f"constraints of ASE have no form in the engine\n  found:   {kinds}\n"
            "  allowed: atoms without constraints; `ase.md` with the calculator Lennard keeps them"
        )
    sides, positions = _in_box(atoms)
    _check_reach(rc, truncation, tables.get("potential"), sigma, sides)
    symbol = _one_species(atoms)
    masses = atoms.get_masses()
    if np.any(masses != masses[0]):
        raise ValueError("all atoms must have one mass")
    mass = float(masses[0])
    momenta = atoms.get_momenta()
    velocities = None
    # ASE's unit of velocity is √(eV/u).
    speed = np.sqrt(epsilon / mass)
    if np.any(momenta):
        velocities = momenta / mass / speed
    elif temperature is None:
        raise ValueError("the atoms have no momenta\n  allowed: temperature=… in K, or atoms with momenta")
    kelvin = float(atoms.get_temperature()) if temperature is None else float(temperature)
    scene: dict[str, Any] = {
        "truncation": _truncation(truncation, tail, _reduced(rc, sigma)),
        "output": {"element": symbol},
        **tables,
    }
    if dt is not None:
        scene["integrator"] = {"dt": dt * speed / sigma, **scene.get("integrator", {})}
    return Simulation.from_arrays(
        positions / sigma,
        sides / sigma,
        velocities,
        temperature=kelvin * units.kB / epsilon,
        threads=threads,
        set=set,
        **scene,
    )


def to_atoms(simulation: Simulation, *, sigma: float, epsilon: float, mass: float) -> Atoms:
    """The state of a simulation as ``ase.Atoms``: see :meth:`lennard.Simulation.to_ase`."""
    atoms = Atoms(
        simulation.elements,
        positions=simulation.positions * sigma,
        cell=simulation.box * sigma,
        pbc=True,
        info={"step": simulation.steps_done, "time": simulation.time * sigma * np.sqrt(mass / epsilon)},
    )
    atoms.set_masses(simulation.masses * mass)
    atoms.set_velocities(simulation.velocities * np.sqrt(epsilon / mass))
    return atoms
