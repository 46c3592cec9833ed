"""One scene at many points."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from . import _toml
from ._results import Run
from ._simulation import Scene, Simulation, is_file

if TYPE_CHECKING:
    import pandas


class Executor(Protocol):
    """Anything with ``submit``: ``concurrent.futures``, a client of dask, an executor of mpi4py."""

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Any:
        """Starts a call, and returns something with ``result()``."""


@dataclass(frozen=True)
class Point:
    """A point of a sweep: the values of its keys, and its run or the error that ended it."""

    values: dict[str, Any]
    run: Run | None
    error: Exception | None = None


class Sweep(Sequence[Point]):
    """The points of a sweep, in the order of its grid."""

    def __init__(self, points: list[Point]) -> None:
        self._points = points

    def __getitem__(self, index: Any) -> Any:
        return self._points[index]

    def __len__(self) -> int:
        return len(self._points)

    def __iter__(self) -> Iterator[Point]:
        return iter(self._points)

    def to_pandas(self) -> pandas.DataFrame:
        """A data frame with a row for each point: its keys, each mean and its standard error. Needs pandas.

        A mean with the name of a key has a column such as ``temperature_measured``.
        """
        import pandas

        rows = []
        for point in self._points:
            row: dict[str, Any] = dict(point.values)
            if point.run is not None:
                for name, mean in point.run.averages.items():
                    row[f"{name}_measured" if name in point.values else name] = mean.value
                    row[f"{name}_error"] = mean.error
            row["failure"] = "" if point.error is None else str(point.error)
            rows.append(row)
        return pandas.DataFrame(rows)

    def __repr__(self) -> str:
        failed = sum(point.error is not None for point in self._points)
        return f"<sweep of {len(self)} points, {failed} failed>"

    def _repr_html_(self) -> str:
        try:
            return str(self.to_pandas().to_html(index=False))
        except ImportError:
            return f"<p>{len(self)} points; pandas shows them as a table</p>"


#: Short names of keys that grids often have.
_SHORT = {
    "density": "system.density",
    "temperature": "system.temperature",
    "n": "system.n_atoms",
    "n_atoms": "system.n_atoms",
    "n_molecules": "system.n_molecules",
    "bond_length": "molecule.bond_length",
    "seed": "system.seed",
    "r_cut": "truncation.r_cut",
    "dt": "integrator.dt",
}


def sweep(
    base: Scene,
    grid: Mapping[str, Sequence[Any]] | None = None,
    *,
    points: Sequence[Mapping[str, Any]] | None = None,
    executor: Executor | None = None,
    threads: int | None = None,
    set: Mapping[str, Any] | None = None,
) -> Sweep:
    """Runs a scene at each point of a grid, or at the points given.

    ``grid={"temperature": [1.0, 1.5], "density": [0.3, 0.5]}`` is every temperature with every density. Keys are keys
    of the scene (``"truncation.r_cut"``) or short: density, temperature, n, n_molecules, bond_length, seed, r_cut, dt.
    A point has the bits of the command line with ``--set`` for each key.

    ``executor`` is anything with ``submit``: ``ProcessPoolExecutor``, a dask client, an executor of mpi4py. With one,
    each point takes one thread unless ``threads`` says otherwise. A point that fails keeps its error, and the others
    go on. All scenes are read before the first run, and an error in one of them is raised at once.
    """
    if (grid is None) == (points is None):
        raise TypeError("a sweep has a grid or points: one of both")
    if points is None:
        assert grid is not None
        names = list(grid)
        for name, listed in grid.items():
            if isinstance(listed, str) or not hasattr(listed, "__iter__") or getattr(listed, "ndim", 1) == 0:
                raise TypeError(f"`{name}` of a grid needs a list of values\n  found:   {listed!r}\n  allowed: [{listed!r}]")
        points = [dict(zip(names, values, strict=True)) for values in itertools.product(*grid.values())]
    if len(points) == 0:
        raise ValueError("a sweep needs at least one point")
    if wrong := [point for point in points if not isinstance(point, Mapping)]:
        raise TypeError(f"a point of a sweep is a dictionary\n  found:   {wrong[0]!r}\n  allowed: {{key: value}}")
    scene = _wherever(base)
    jobs = []
    for values in points:
        changed = {**(set or {}), **{_SHORT.get(key, key): value for key, value in values.items()}}
        # Everything that can be wrong with a scene shows before anything runs.
        _check(scene, changed)
        jobs.append(changed)
    if executor is None:
        runs = [_attempt(scene, changed, threads) for changed in jobs]
    else:
        futures: list[Future[Any]] = [executor.submit(_attempt, scene, changed, threads or 1) for changed in jobs]
        runs = [future.result() for future in futures]
    return Sweep([Point(dict(v), run, error) for v, (run, error) in zip(points, runs, strict=True)])


def _wherever(scene: Scene) -> Scene:
    """The scene for a process in another folder: a file by its whole path. Scenes of the program have names alone."""
    if is_file(scene):
        path = os.fspath(scene)  # type: ignore[arg-type]
        for file in (path, f"{path}.toml"):
            if os.path.isfile(file):
                return os.path.abspath(file)
    return scene


def _check(scene: Scene, changed: Mapping[str, Any]) -> None:
    from . import _lennard
    from ._simulation import NAME, as_text

    overrides = _toml.overrides(changed)
    if is_file(scene):
        _lennard.resolve_file(os.fspath(scene), overrides)  # type: ignore[arg-type]
    else:
        _lennard.resolve(as_text(scene), NAME, overrides)


def _attempt(scene: Scene, changed: Mapping[str, Any], threads: int | None) -> tuple[Run | None, Exception | None]:
    try:
        return Simulation(scene, set=changed, threads=threads).run(), None
    except Exception as error:
        return None, error
