"""Trajectories of a run for ase and mdtraj, checked against the run's own record.

mdtraj drops a truncated last frame without a word, and reads neither box nor time from extended XYZ.
The frames are therefore counted here, and box and times are set.
"""

from __future__ import annotations

import gzip
import re
from pathlib import Path

import numpy as np

from .commands import Run, open_run


#: Formats of text with headers, and their files.
FILES = {"xyz": "trajectory.xyz", "xyz.gz": "trajectory.xyz.gz"}


class BadTrajectory(Exception):
    """The trajectory is not the one that the run's record describes."""


def expected_steps(run: Run) -> list[int]:
    """The steps of which the trajectory must hold a frame: the steps of the measured stages that are
    multiples of `trajectory_every`."""
    every = run.scene["output"].get("trajectory_every", 0)
    if not every:
        return []
    steps = []
    first = 1
    for stage in run.scene["stage"]:
        last = first + stage["steps"] - 1
        if stage["measure"]:
            steps += [step for step in range(first, last + 1) if step % every == 0]
        first = last + 1
    return steps


def _headers(path: Path) -> list[tuple[int, str]]:
    """Number of particles and comment line of each frame; every frame must be whole."""
    headers = []
    with (gzip.open if path.suffix == ".gz" else open)(path, "rt", encoding="utf-8") as file:
        while first := file.readline():
            if not re.fullmatch(r"\d+\n", first):
                raise BadTrajectory(f"{path}: frame {len(headers)} begins with {first!r}, not with a count")
            n = int(first)
            comment = file.readline()
            rows = [file.readline() for _ in range(n)]
            if n == 0 or not rows[-1].endswith("\n"):
                raise BadTrajectory(f"{path}: frame {len(headers)} is truncated")
            widths = {len(row.split()) for row in rows}
            if len(widths) != 1:
                raise BadTrajectory(f"{path}: rows of frame {len(headers)} differ in length")
            headers.append((n, comment))
    return headers


def _value(comment: str, key: str) -> str:
    found = re.search(rf'(?:^|\s){key}=("([^"]*)"|\S+)', comment)
    if not found:
        raise BadTrajectory(f"a frame says no {key}: {comment!r}")
    return found[2] if found[2] is not None else found[1]


def _checked(folder: str | Path) -> tuple[Run, Path, list[str]]:
    run = open_run(folder)
    form = run.scene["output"]["format"]
    if form not in FILES:
        raise BadTrajectory(f"{folder}: its trajectory is in the format {form}; this reads {' and '.join(FILES)}")
    path = run.folder / FILES[form]
    steps = expected_steps(run)
    if not steps:
        raise BadTrajectory(f"{folder}: the scene asks for no trajectory")
    headers = _headers(path)
    found = [int(_value(comment, "Step")) for _, comment in headers]
    if found != steps:
        raise BadTrajectory(
            f"{path} holds {len(found)} frames, from step {found[0]} to {found[-1]}; "
            f"the run wrote {len(steps)}, from step {steps[0]} to {steps[-1]}"
        )
    if {n for n, _ in headers} != {run.record["atoms"]}:
        raise BadTrajectory(f"{path}: a frame does not hold the {run.record['atoms']} particles of the run")
    return run, path, [comment for _, comment in headers]


def load_frames(folder: str | Path) -> list:
    """The frames as ase.Atoms: positions, cell, pbc; `arrays["velo"]`, `arrays["map_shift"]`;
    `info["Time"]`, `info["Step"]`; forces, where written, from `get_forces()`.

    Raises BadTrajectory where a frame is missing, truncated or of another run.
    """
    import ase.io

    _, path, _ = _checked(folder)
    return ase.io.read(path, index=":", format="extxyz")


def load_trajectory(folder: str | Path):
    """The trajectory as an mdtraj.Trajectory with its cell and its times (τ) set, which mdtraj
    reads from neither file. Lengths are a tenth of those in the file, in single precision.

    Raises BadTrajectory where a frame is missing, truncated or of another run.
    """
    import mdtraj

    run, path, comments = _checked(folder)
    trajectory = mdtraj.load_xyz(str(path), top=str(run.folder / "topology.gro"))
    if trajectory.n_frames != len(comments):
        raise BadTrajectory(f"{path}: mdtraj reads {trajectory.n_frames} of {len(comments)} frames")
    lattices = np.array([[float(x) for x in _value(c, "Lattice").split()] for c in comments])
    trajectory.unitcell_vectors = (lattices.reshape(-1, 3, 3) / 10.0).astype(np.float32)
    trajectory.time = np.array([float(_value(c, "Time")) for c in comments])
    return trajectory
