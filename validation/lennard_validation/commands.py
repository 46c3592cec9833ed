"""Calling the program, and what it gives back."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import tomllib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class CommandFailed(Exception):
    """The program ended with another exit code than 0."""

    def __init__(self, command: list[str], code: int, message: str):
        super().__init__(f"{' '.join(command)} ended with exit code {code}:\n{message}")
        self.code = code
        self.message = message


@dataclass(frozen=True)
class Run:
    """The output folder of a finished run."""

    folder: Path

    @cached_property
    def record(self) -> dict:
        """The run record, `run.json`."""
        return json.loads((self.folder / "run.json").read_text(encoding="utf-8"))

    @cached_property
    def scene(self) -> dict:
        """The scene as resolved, `scene.toml`."""
        return tomllib.loads((self.folder / "scene.toml").read_text(encoding="utf-8"))

    @property
    def averages(self) -> dict:
        """Means with `standard_error`, `n_effective` and `equilibration_cut`, by name."""
        return self.record["averages"]

    def table(self, name: str) -> dict[str, list]:
        """A table of the run, column by column; numbers as floats, all else as text."""
        with open(self.folder / f"{name}.csv", encoding="utf-8", newline="") as file:
            rows = csv.reader(line for line in file if not line.startswith("#"))
            heading = next(rows)
            columns: dict[str, list] = {name: [] for name in heading}
            for row in rows:
                for name, text in zip(heading, row, strict=True):
                    columns[name].append(_number(text))
        return columns


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def binary_path() -> Path:
    """Where the binary is or will be: $LENNARD_BINARY, or target/release/lennard below the repository."""
    named = os.environ.get("LENNARD_BINARY")
    return Path(named) if named else ROOT / "target" / "release" / "lennard"


def binary() -> Path:
    """The binary under test, which must be there."""
    path = binary_path()
    if not path.exists():
        raise FileNotFoundError(f"{path} is not there: build it with `cargo build --release`")
    return path


def _call(command: list[str], text: str | None = None) -> str:
    done = subprocess.run(
        command, cwd=ROOT, input=text, capture_output=True, text=True, encoding="utf-8", check=False
    )
    if done.returncode != 0:
        raise CommandFailed(command, done.returncode, done.stderr)
    return done.stdout


def _common(settings: dict | None, seed: int | None, threads: int | None) -> list[str]:
    arguments = []
    for key, value in (settings or {}).items():
        arguments += ["--set", f"{key}={value}"]
    if seed is not None:
        arguments += ["--seed", str(seed)]
    if threads is not None:
        arguments += ["--threads", str(threads)]
    return arguments


def run(
    scene: str | Path,
    *,
    out: str | Path,
    settings: dict | None = None,
    seed: int | None = None,
    threads: int | None = None,
) -> Run:
    """Run a scene into the folder `out`; `settings` are overrides such as {"truncation.r_cut": 4.0}."""
    out = Path(out).resolve()
    command = [str(binary()), "run", str(Path(scene).resolve()), "--out", str(out), "--json"]
    printed = _call(command + _common(settings, seed, threads))
    result = Run(out)
    if json.loads(printed) != result.record:
        raise CommandFailed(command, 0, "what --json printed is not what run.json holds")
    return open_run(out)


def open_run(folder: str | Path) -> Run:
    """A finished run by its folder; raises ValueError if it did not finish."""
    result = Run(Path(folder))
    if result.record.get("finished") is not True:
        raise ValueError(f"{folder}: the run did not finish")
    return result


def energy(
    scene: str | Path,
    *,
    settings: dict | None = None,
    forces: str | Path | None = None,
    threads: int | None = None,
) -> dict:
    """Energy, virial and pressure of a scene's start configuration: totals for the system.

    `forces` names a file to which the forces are written at full precision.
    """
    command = [str(binary()), "energy", str(Path(scene).resolve()), "--json"]
    if forces is not None:
        command += ["--forces", str(Path(forces).resolve())]
    return json.loads(_call(command + _common(settings, None, threads)))


def _literature(arguments: list[str], lines: list[str]) -> list[list[str]]:
    cargo = os.environ.get("CARGO", "cargo")
    command = [cargo, "run", "--quiet", "--package", "lennard-literature", "--example", "grid", "--"]
    printed = _call(command + arguments, "\n".join(lines) + "\n")
    return [line.split(",") for line in printed.splitlines()]


#: The numbers that `grid` gives for each state, in order.
GRID_COLUMNS = ("rho", "T", "p", "u", "cv", "speed_of_sound", "du_dt", "dp_dt", "du_drho", "dp_drho")


def grid(equation: str, states: list[tuple[float, float]]) -> list[dict]:
    """What an equation of state of the program says at states (density, temperature)."""
    rows = _literature([equation], [f"{rho!r},{t!r}" for rho, t in states])
    return [
        {name: float(x) for name, x in zip(GRID_COLUMNS, row, strict=False)} | {"phase": row[-1]}
        for row in rows
    ]


def saturation(equation: str, temperatures: list[float]) -> list[dict]:
    """Coexisting vapor and liquid at temperatures."""
    rows = _literature([equation, "saturation"], [repr(t) for t in temperatures])
    names = ("T", "p", "rho_vapor", "rho_liquid")
    return [dict(zip(names, map(float, row), strict=True)) for row in rows]
