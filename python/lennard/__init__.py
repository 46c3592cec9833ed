"""Molecular dynamics of Lennard-Jones fluids, exact and fast.

>>> import lennard
>>> simulation = lennard.Simulation.liquid(density=0.8442, temperature=0.722, n=256)
>>> simulation.equilibrate(200)
>>> run = simulation.run(200, measure=[lennard.observable.rdf(every=20)])
>>> run.steps
400

All numbers are in reduced units: lengths in σ, energies in ε, temperatures in ε/k_B, times in τ = σ√(m/ε).
"""

from __future__ import annotations

from . import eos
from ._errors import (
    BusyError,
    CheckpointError,
    ConfigurationError,
    FolderError,
    LennardError,
    PhysicsError,
    SceneError,
)
from ._frames import Frames
from ._kinds import barostat, integrator, observable, potential, reference, thermostat, truncation, wall
from ._lennard import version as _version
from ._results import Averages, Mean, Run
from ._simulation import Simulation
from ._sweep import Point, Sweep, sweep
from ._tables import Column, Table

__version__: str = _version()

__all__ = [
    "Averages",
    "BusyError",
    "CheckpointError",
    "Column",
    "ConfigurationError",
    "FolderError",
    "Frames",
    "LennardError",
    "Mean",
    "PhysicsError",
    "Point",
    "Run",
    "SceneError",
    "Simulation",
    "Sweep",
    "Table",
    "barostat",
    "eos",
    "integrator",
    "observable",
    "potential",
    "reference",
    "sweep",
    "thermostat",
    "truncation",
    "wall",
]
