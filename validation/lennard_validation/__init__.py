"""Run Lennard from Python and read its output folders with ase and mdtraj.

    from lennard_validation import load_frames, load_trajectory, run

    result = run("inputs/fluid/liquid-256.toml", out="runs/liquid", seed=3)
    print(result.averages["pressure"]["mean"])
    frames = load_frames(result.folder)          # a list of ase.Atoms, velocities in arrays["velo"]
    trajectory = load_trajectory(result.folder)  # an mdtraj.Trajectory with its cell and times set

All numbers are in reduced units, except with mdtraj. It takes lengths in the file as ångström and works in
nanometres, so that it divides lengths by ten. One σ is 0.1 times the scene's `length_scale` there.
"""

from .commands import CommandFailed, Run, binary, binary_path, energy, grid, open_run, run, saturation
from .frames import BadTrajectory, expected_steps, load_frames, load_trajectory
from .statistics import Blocked, blocked_error, chi_squared_of_spread

__all__ = [
    "BadTrajectory",
    "Blocked",
    "CommandFailed",
    "Run",
    "binary",
    "binary_path",
    "blocked_error",
    "chi_squared_of_spread",
    "energy",
    "expected_steps",
    "grid",
    "load_frames",
    "load_trajectory",
    "open_run",
    "run",
    "saturation",
]
