"""What the tests share. They run against the installed package: this folder is no part of it."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def program() -> str:
    """The program `lennard` as cargo built it."""
    binary = os.environ.get("LENNARD_BINARY") or shutil.which("lennard")
    if binary is None:
        pytest.fail("LENNARD_BINARY names no program")
    return binary


@pytest.fixture(scope="session")
def command_line(program):
    """Runs the program."""

    def run(*arguments: object, check: bool = True) -> subprocess.CompletedProcess[str]:
        words = [program, *map(str, arguments)]
        return subprocess.run(words, check=check, capture_output=True, text=True)

    return run


LIQUID = """
[system]
n_atoms = 256
density = 0.8442
temperature = 0.722
seed = 3

[truncation]
r_cut = 2.5

[integrator]
dt = 0.004
"""


@pytest.fixture
def liquid() -> str:
    """A scene without stages."""
    return LIQUID
