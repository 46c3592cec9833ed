"""Scenes that several tests share. Reduced units throughout."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import pytest

import lennard_validation as lv

#: Lines of results, printed at the end of a session.
RESULTS: list[str] = []


def pytest_sessionfinish(session) -> None:
    """A worker hands its lines over; the session that shows them has no `workeroutput`."""
    if (handed := getattr(session.config, "workeroutput", None)) is not None:
        handed["results"] = RESULTS


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node, error) -> None:
    RESULTS.extend(getattr(node, "workeroutput", {}).get("results", []))


def pytest_terminal_summary(terminalreporter) -> None:
    for line in RESULTS:
        terminalreporter.write_line(line)


@dataclass
class Scene:
    """A scene file: a fluid that is melted and equilibrated with a thermostat, then measured."""

    density: float = 0.8
    temperature: float = 1.0
    n_atoms: int = 256
    box: tuple[float, float, float] | None = None
    configuration: Path | None = None
    truncation: str = 'kind = "cut"\nr_cut = 2.5'
    dt: float = 0.004
    equilibrate: int = 1000
    steps: int = 1000
    thermostat: str = '"none"'
    observables: str = ""
    output: str = ""
    seed: int = 1
    extra: str = field(default="")

    def text(self) -> str:
        start = ""
        if self.configuration is not None:
            system = ""
            start = f'[start]\nkind = "file"\nfile = "{self.configuration.resolve().as_posix()}"\n'
        elif self.box is not None:
            system = f"n_atoms = {self.n_atoms}\nbox = {list(self.box)}"
        else:
            system = f"n_atoms = {self.n_atoms}\ndensity = {self.density}"
        equilibration = (
            f'[[stage]]\nname = "equilibrate"\nsteps = {self.equilibrate}\n'
            'thermostat = { kind = "bussi", tau = 0.1 }\n'
            if self.equilibrate
            else ""
        )
        return f"""
[system]
{system}
temperature = {self.temperature}
seed = {self.seed}

{start}
[truncation]
{self.truncation}

[integrator]
kind = "velocity-verlet"
dt = {self.dt}

{equilibration}
[[stage]]
name = "production"
steps = {self.steps}
thermostat = {self.thermostat}

{self.observables}
[output]
{self.output}
{self.extra}
"""

    def write(self, folder: Path, name: str = "scene") -> Path:
        path = folder / f"{name}.toml"
        path.write_text(self.text(), encoding="utf-8")
        return path

    def run(self, folder: Path, name: str = "scene", **options) -> lv.Run:
        return lv.run(self.write(folder, name), out=folder / f"{name}-run", **options)


@pytest.fixture(scope="session")
def every_step(tmp_path_factory) -> lv.Run:
    """A liquid in a box with three different sides, every step of which is in the trajectory, with
    velocities and forces."""
    folder = tmp_path_factory.mktemp("every-step")
    scene = Scene(
        n_atoms=400,
        box=(6.8, 8.5, 8.25),
        equilibrate=800,
        steps=40,
        truncation='kind = "shift"\nr_cut = 2.5',
        output="trajectory_every = 1\nthermo_every = 1\nforces = true",
    )
    return scene.run(folder)


@pytest.fixture(scope="session")
def sampled(tmp_path_factory) -> lv.Run:
    """A liquid with a frame, and a look at g(r), every 20 steps."""
    folder = tmp_path_factory.mktemp("sampled")
    scene = Scene(
        density=0.8442,
        temperature=0.8,
        n_atoms=500,
        equilibrate=1500,
        steps=2000,
        observables='[[observable]]\nkind = "rdf"\nevery = 20\nr_max = 4.1\nbins = 164\n',
        output="trajectory_every = 20",
    )
    return scene.run(folder)
