"""The stub says what the compiled part has, and everything is typed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from conftest import ROOT

HERE = Path(__file__).parent


def mypy(*arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "MYPY_CACHE_DIR": str(ROOT / "target" / "mypy")}
    words = [sys.executable, "-m", *arguments]
    return subprocess.run(words, capture_output=True, text=True, cwd=ROOT, env=environment)


def test_the_stub_is_the_module():
    made = mypy("mypy.stubtest", "lennard._lennard", "--mypy-config-file", "pyproject.toml")
    assert made.returncode == 0, made.stdout + made.stderr


def test_package_and_examples_are_typed_strictly():
    made = mypy("mypy", "--strict", "python/lennard", "python/examples")
    assert made.returncode == 0, made.stdout + made.stderr
