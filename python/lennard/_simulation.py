"""A simulation: the scene, and the state that it has reached."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _lennard, _toml
from ._frames import Frames
from ._progress import Progress, told
from ._results import Run
from ._tables import Floats, Table

if TYPE_CHECKING:
    import ase

#: A scene: its file, its TOML text, or the same as dictionaries.
Scene: TypeAlias = str | os.PathLike[str] | Mapping[str, Any]
#: A method: its name, or a dictionary with ``kind`` and keys.
Method: TypeAlias = str | Mapping[str, Any]
#: What is measured: a method or several.
Measure: TypeAlias = bool | Method | Sequence[Method]

#: The name of a scene that no file holds.
NAME = "scene"


def is_file(scene: Scene) -> bool:
    """Whether a scene is the path of a file. A text with more than one line is TOML."""
    return isinstance(scene, os.PathLike) or (isinstance(scene, str) and "\n" not in scene)


def as_text(scene: Scene) -> str:
    """A scene that is no file as TOML."""
    return _toml.document(scene) if isinstance(scene, Mapping) else str(scene)


def changes(set: Mapping[str, Any] | None, tables: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Changes of a scene: keys joined by dots, and tables."""
    return _toml.overrides(tables) + _toml.overrides(set or {})


class Simulation:
    """A simulation of a scene.

    ``scene`` is the path of a scene file, the name of a scene that comes with the program (``"fluid/gas"``), TOML text,
    or the same as dictionaries. ``set`` changes keys (``set={"truncation.r_cut": 4}``), and so do tables given by name (``truncation={"r_cut": 4}``). A scene that is no
    file may come without stages: ``run(steps)`` adds them.

    All numbers are in reduced units. Energies are for each particle, or each molecule where the scene has molecules.
    The same scene, seed and version give the same bits as the command line, on any number of threads.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        set: Mapping[str, Any] | None = None,
        lock: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        **tables: Any,
    ) -> None:
        overrides = changes(set, tables)
        if is_file(scene):
            path = os.fspath(scene)  # type: ignore[arg-type]
            self._core = _lennard.Core.open(path, overrides, lock, threads)
            return
        if lock is not None:
            raise ValueError("a lock file belongs to a scene file, and this scene is none")
        self._core = _lennard.Core.parse(as_text(scene), NAME, overrides, threads, None)

    @classmethod
    def _around(cls, core: _lennard.Core) -> Simulation:
        simulation = cls.__new__(cls)
        simulation._core = core
        return simulation

    # Ways to make one.

    @classmethod
    def from_scene(cls, scene: Scene, /, **set: Any) -> Simulation:
        """The same as the constructor, with changes by key: ``from_scene("x.toml", **{"truncation.r_cut": 4})``."""
        return cls(scene, set=set)

    @classmethod
    def liquid(
        cls,
        *,
        density: float,
        temperature: float,
        n: int = 864,
        seed: int | None = None,
        r_cut: float | None = None,
        dt: float | None = None,
        threads: int | None = None,
        set: Mapping[str, Any] | None = None,
        **tables: Any,
    ) -> Simulation:
        """Particles on a lattice with Maxwell–Boltzmann velocities, and no stage yet.

        ``density`` in σ⁻³ and ``temperature`` in ε/k_B. The lattice is fcc, which takes 4m³ particles (256, 500, 864,
        1372, 2048, 4000) in a cube; ``start={"kind": "random"}`` takes any number. Every other table of a scene may be given:
        ``truncation={"kind": "shift"}``, ``integrator={...}``, ``potential={...}``, ``molecule={...}``, ``wall=[{...}]``.
        """
        scene: dict[str, Any] = {name: table for name, table in tables.items()}
        system = dict(scene.pop("system", {}))
        given = {"density": density, "temperature": temperature, "seed": seed}
        system.update({key: value for key, value in given.items() if value is not None})
        system.setdefault("n_molecules" if "molecule" in scene else "n_atoms", n)
        scene["system"] = system
        for table, key, value in (("truncation", "r_cut", r_cut), ("integrator", "dt", dt)):
            if value is not None:
                scene[table] = {**scene.get(table, {}), key: value}
        return cls(scene, set=set, threads=threads)

    @classmethod
    def from_arrays(
        cls,
        positions: ArrayLike,
        box: ArrayLike,
        velocities: ArrayLike | None = None,
        *,
        temperature: float,
        threads: int | None = None,
        set: Mapping[str, Any] | None = None,
        **tables: Any,
    ) -> Simulation:
        """A simulation that starts from arrays.

        ``positions`` ``[N, 3]`` in σ, ``box`` one or three sides in σ, ``velocities`` ``[N, 3]`` in σ/τ. Without
        velocities they are drawn for ``temperature``. The scene names ``start.xyz`` as its file;
        :meth:`export` writes both, for the command line.
        """
        scene: dict[str, Any] = {name: table for name, table in tables.items()}
        scene["system"] = {"temperature": temperature, **scene.pop("system", {})}
        scene["start"] = {"kind": "file", "file": "start.xyz", **scene.pop("start", {})}
        lengths = _arrays.sides("box", box)
        places = _arrays.vectors("positions", positions)
        speeds = None if velocities is None else _arrays.vectors("velocities", velocities)
        if speeds is not None and speeds.shape != places.shape:
            raise ValueError(
                f"velocities has the shape {speeds.shape}\n  allowed: {places.shape}, one velocity for each position"
            )
        start = (places, speeds, lengths)
        overrides = changes(set, {})
        return cls._around(_lennard.Core.parse(as_text(scene), NAME, overrides, threads, start))

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, threads: int | None = None) -> Simulation:
        """A simulation as it was when it was saved, to the bit. Checkpoints of runs in folders are such files too."""
        return cls._around(_lennard.Core.load(path, threads))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Saves the state and what was measured. Rows and frames in memory are not saved."""
        self._core.save(path)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_from_bytes, (self._core.to_bytes(), self.threads))

    # Running.

    def run(
        self,
        steps: int | None = None,
        *,
        measure: Measure = True,
        thermostat: Method | None = None,
        barostat: Method | None = None,
        temperature: float | Mapping[str, float] | None = None,
        dt: float | None = None,
        name: str | None = None,
        trajectory_every: int | None = None,
        thermo_every: int | None = None,
        output: Mapping[str, Any] | None = None,
        progress: Progress = False,
        **stage: Any,
    ) -> Run:
        """Runs the stages of the scene that are left, or a new stage of so many steps.

        Without ``steps`` the scene runs to its end. With it, the scene gets a stage more, whose keys are the arguments:
        ``thermostat="bussi"``, ``temperature=1.2``, ``barostat=lennard.barostat.stochastic_cell_rescaling(pressure=1.0)``, ``dt=0.002``.
        What is measured begins anew, and averages are over this stage. ``measure`` lists observables
        (``measure=[lennard.observable.rdf(every=100)]``) in the place of the scene's; ``False`` measures nothing.

        ``progress=True`` shows a bar of tqdm where it is installed; a function is called with stage, steps done and
        last step. Ctrl-C stops the run after a few steps and raises ``KeyboardInterrupt``; ``run()`` then goes on, to
        the same bits.
        """
        if steps is None:
            given = (thermostat, barostat, temperature, dt, name, trajectory_every, thermo_every, output)
            if measure is not True or stage or any(value is not None for value in given):
                raise TypeError("run() goes on with the scene; a new stage needs its number of steps: run(steps, …)")
        else:
            keys = {
                "name": name if name is not None else self._free_name(measure),
                "steps": steps,
                "measure": measure is not False,
                "thermostat": thermostat,
                "barostat": barostat,
                "temperature": temperature,
                "dt": dt,
                **stage,
            }
            written = {"trajectory_every": trajectory_every, "thermo_every": thermo_every, **(output or {})}
            self._add_stage(keys, measure, written)
        with told(progress) as callback:
            self._core.run(None, callback)
        return self.results()

    def equilibrate(
        self,
        steps: int,
        *,
        thermostat: Method | None = "bussi",
        progress: Progress = False,
        **stage: Any,
    ) -> None:
        """Runs a new stage that is not measured, with a thermostat at the temperature of the scene or at ``temperature``."""
        self.run(steps, thermostat=thermostat, measure=False, progress=progress, **stage)

    def step(self, steps: int = 1, *, progress: Progress = False) -> None:
        """Takes steps of the stage under way, and makes the last stage longer where the scene would end.

        After stages that are not measured it begins one that is, at constant energy.

        ``step(400)`` and ``step(600)`` have the bits of ``step(1000)``, and so have their averages: :meth:`results`.
        """
        if steps < 0:
            raise ValueError(f"steps can only be taken forwards\n  found: {steps}")
        done, end, _ = self._core.clock
        stages = self._core.stages[0]
        with told(progress) as callback:
            if done + steps > end and not (stages and stages[-1][2]):
                # The scene has no measured stage to make longer.
                self._core.run(None, callback)
                self._add_stage({"name": self._free_name(True), "steps": done + steps - end}, True, {})
            elif done + steps > end:
                self._core.prolong(done + steps - end)
            self._core.run(done + steps, callback)

    def frames(self, every: int, n: int, **stage: Any) -> Frames:
        """Runs a new stage of ``n`` times ``every`` steps and returns its frames.

        The first frame is at the first step that is a multiple of ``every``.
        """
        if every < 1 or n < 1:
            raise ValueError(f"there must be a frame\n  found:   every={every}, n={n}\n  allowed: whole numbers from 1")
        return self.run(every * n, trajectory_every=every, **stage).frames

    def end_stage(self) -> None:
        """Ends the stage under way here, and drops the rest of the scene: after Ctrl-C, for another plan."""
        self._core.end_stage()

    def run_in_folder(
        self,
        folder: str | os.PathLike[str],
        *,
        replace: bool = False,
        report: bool = True,
        progress: Progress = False,
    ) -> dict[str, Any]:
        """Runs the whole scene with the files that ``lennard run`` writes, to the byte, and returns the run's record.

        Ctrl-C leaves a checkpoint there, from which ``lennard resume`` goes on.
        """
        with told(progress) as callback:
            record: dict[str, Any] = json.loads(self._core.run_in_folder(folder, replace, report, callback))
        return record

    def results(self) -> Run:
        """What was measured since the last stage was added, or since the start."""
        text, tables = self._core.results()
        found = [Table._of(table) for table in tables]
        record = json.loads(text)
        whole = record["scene"]["output"].get("whole", False)
        sites = self.n_atoms // self.n_molecules if whole else 1
        return Run(
            record=record,
            tables={table.name: table for table in found},
            thermo=Table._of(self._core.thermo()),
            frames=Frames._of(self._core.frames(), self.elements, sites),
            scene=self.scene,
        )

    def _add_stage(self, keys: dict[str, Any], measure: Measure, output: Mapping[str, Any]) -> None:
        done, end, _ = self._core.clock
        if end > done and self._core.stages[0]:
            raise RuntimeError(
                f"the scene has {end - done} steps left\n  run() does them; end_stage() drops them"
            )
        observables = None
        if not isinstance(measure, bool):
            if isinstance(measure, str | Mapping):
                measure = [measure]
            listed = [{"kind": m} if isinstance(m, str) else dict(m) for m in measure]
            observables = _toml.document({"observable": listed})
        written = {key: value for key, value in output.items() if value is not None}
        self._core.add_stage(
            _toml.document_of_table(keys), observables, _toml.document_of_table(written) if written else None
        )

    def _free_name(self, measure: Measure) -> str:
        base = "equilibration" if measure is False else "production"
        taken = {name for name, _, _ in self._core.stages[0]}
        if base not in taken:
            return base
        return next(f"{base}-{k}" for k in range(2, len(taken) + 3) if f"{base}-{k}" not in taken)

    # The scene.

    @property
    def scene(self) -> str:
        """The scene as TOML, with every default: the command line gets the same bits from it."""
        return self._core.scene()

    def export(self, folder: str | os.PathLike[str]) -> Path:
        """Writes ``scene.toml`` into a folder, with ``start.xyz`` where the start came as arrays; returns the scene's path."""
        self._core.export(folder)
        return Path(folder) / "scene.toml"

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self._core.names[0]

    @property
    def model(self) -> str:
        """The model in words."""
        return self._core.names[1]

    @property
    def threads(self) -> int:
        """Threads in use. The bits do not depend on them."""
        return self._core.names[2]

    # The state.

    @property
    def n_atoms(self) -> int:
        """Number of particles."""
        return self._core.size[0]

    @property
    def n_molecules(self) -> int:
        """Number of molecules; of particles where there are none."""
        return self._core.size[1]

    @property
    def elements(self) -> list[str]:
        """The element symbol of each particle, as files have it."""
        species, of_particles = self._core.species
        return [species[a][0] for a in of_particles]

    @property
    def masses(self) -> Floats:
        """The mass of each particle, ``[N]``, m."""
        species, of_particles = self._core.species
        return np.array([mass for _, mass in species])[of_particles]

    @property
    def steps_done(self) -> int:
        """Steps done since the start."""
        return self._core.clock[0]

    @property
    def steps_left(self) -> int:
        """Steps that the scene still has."""
        done, end, _ = self._core.clock
        return end - done

    @property
    def time(self) -> float:
        """Time, τ."""
        return self._core.clock[2]

    @property
    def positions(self) -> Floats:
        """A copy of the unwrapped positions, ``[N, 3]``, σ."""
        return self._core.positions

    @property
    def velocities(self) -> Floats:
        """A copy of the velocities, ``[N, 3]``, σ/τ."""
        return self._core.velocities

    @property
    def forces(self) -> Floats:
        """A copy of the forces, ``[N, 3]``, ε/σ."""
        return self._core.forces

    @contextmanager
    def view(self) -> Iterator[_lennard.View]:
        """Positions, velocities and forces without copies, read-only; while the view is open, nothing can run.

        ``with simulation.view() as state: state.positions.mean(axis=0)``. An array that outlives the view keeps the
        values that it had.
        """
        view = self._core.open_view()
        try:
            yield view
        finally:
            self._core.close_view()

    @property
    def box(self) -> Floats:
        """The box sides, ``[3]``, σ."""
        return np.array(self._core.lengths)

    @property
    def volume(self) -> float:
        """Volume of the box, σ³."""
        return float(np.prod(self._core.lengths))

    @property
    def density(self) -> float:
        """Number density, σ⁻³: of molecules where there are some."""
        return self.n_molecules / self.volume

    @property
    def temperature(self) -> float:
        """Kinetic temperature 2K/n_dof of the moment, ε/k_B."""
        return self._core.moment()[0]

    @property
    def kinetic_energy(self) -> float:
        """Kinetic energy of the moment, ε for each particle."""
        return self._core.moment()[1]

    @property
    def potential_energy(self) -> float:
        """Potential energy of the moment, ε for each particle, with the tail where the scene has one."""
        return self._core.moment()[2]

    @property
    def pressure(self) -> float:
        """Pressure of the moment, ε/σ³, with the tail where the scene has one."""
        return self._core.moment()[3]

    def to_ase(self, *, sigma: float = 1.0, epsilon: float = 1.0, mass: float = 1.0) -> ase.Atoms:
        """The state as ``ase.Atoms`` in Å and eV: lengths times ``sigma``, energies times ``epsilon``. Needs ase.

        ``mass`` in u is the unit of mass, and momenta follow from it: T in ε/k_B is then ``epsilon``·T/k_B in K. The
        atoms of a mixture have the elements and masses of their species.
        """
        from .ase import to_atoms

        return to_atoms(self, sigma=sigma, epsilon=epsilon, mass=mass)

    def __repr__(self) -> str:
        return (
            f"<simulation of {self.n_atoms} particles, {self.model}: "
            f"step {self.steps_done}, {self.steps_left} left>"
        )

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(name)}</td><td>{steps}</td><td>{'yes' if measured else 'no'}</td></tr>"
            for name, steps, measured in self._core.stages[0]
        )
        stages = f"<table><thead><tr><th>stage</th><th>steps</th><th>measured</th></tr></thead><tbody>{rows}</tbody></table>"
        return (
            f"<p>{escape(self.model)}: {self.n_atoms} particles, ρ = {self.density:.6g} σ⁻³, "
            f"step {self.steps_done}, {self.steps_left} left</p>{stages if rows else ''}"
        )


def _from_bytes(data: bytes, threads: int) -> Simulation:
    return Simulation._around(_lennard.Core.from_bytes(data, threads))
