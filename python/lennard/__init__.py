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

import importlib
from typing import TYPE_CHECKING, Any

from ._lennard import version as _version

if TYPE_CHECKING:
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
    from ._forces import Evaluation, Forces
    from ._frames import Frames
    from ._kinds import barostat, integrator, observable, potential, reference, thermostat, truncation, wall
    from ._results import Averages, Mean, Run
    from ._simulation import Simulation
    from ._sweep import Point, Sweep, sweep
    from ._tables import Column, Table
else:
    #: Where each name lives. A module is imported when it is first asked for: numpy takes its time, and the command needs none.
    _HOMES = {
        "Averages": "_results",
        "BusyError": "_errors",
        "CheckpointError": "_errors",
        "Column": "_tables",
        "ConfigurationError": "_errors",
        "Evaluation": "_forces",
        "FolderError": "_errors",
        "Forces": "_forces",
        "Frames": "_frames",
        "LennardError": "_errors",
        "Mean": "_results",
        "PhysicsError": "_errors",
        "Point": "_sweep",
        "Run": "_results",
        "SceneError": "_errors",
        "Simulation": "_simulation",
        "Sweep": "_sweep",
        "Table": "_tables",
        "barostat": "_kinds",
        "eos": "eos",
        "integrator": "_kinds",
        "observable": "_kinds",
        "potential": "_kinds",
        "reference": "_kinds",
        "sweep": "_sweep",
        "thermostat": "_kinds",
        "truncation": "_kinds",
        "wall": "_kinds",
    }

    def __getattr__(name: str) -> Any:
        home = _HOMES.get(name)
        if home is None:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        module = importlib.import_module(f".{home}", __name__)
        found = module if name == home else getattr(module, name)
        globals()[name] = found
        return found

    def __dir__() -> list[str]:
        return sorted(__all__)


__version__: str = _version()

__all__ = [
    "Averages",
    "BusyError",
    "CheckpointError",
    "Column",
    "ConfigurationError",
    "Evaluation",
    "FolderError",
    "Forces",
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
