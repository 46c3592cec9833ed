"""Examples and the code of the documentation run as they stand."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import ROOT

EXAMPLES = sorted((ROOT / "python" / "examples").glob("*.py"))
NOTEBOOKS = sorted((ROOT / "python" / "examples").glob("*.ipynb"))
DOCUMENT = ROOT / "docs" / "python.md"


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_examples_run(example, tmp_path):
    made = subprocess.run([sys.executable, example], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert made.returncode == 0, made.stderr
    assert made.stdout.strip()


def test_there_are_examples():
    assert len(EXAMPLES) >= 10


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_cells_of_a_notebook_run_in_order(notebook, tmp_path):
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    environment = {**os.environ, "MPLBACKEND": "svg"}
    # Half of the steps: errors are known from them too, and the cells want differences within errors.
    command = [sys.executable, "-c", "\n".join(code).replace("20_000", "10_000")]
    # A notebook names files of the repository from its own folder.
    folder = tmp_path / "python" / "examples"
    folder.mkdir(parents=True)
    (tmp_path / "crates").symlink_to(ROOT / "crates")
    made = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)
    assert made.returncode == 0, made.stderr
    pictures = list(folder.glob("*.svg"))
    assert pictures and all(path.stat().st_size > 1000 for path in pictures)
    assert not any(cell.get("outputs") for cell in cells), "the cells are kept without outputs"


def test_the_code_of_the_documentation_runs(tmp_path):
    blocks = re.findall(r"^```python\n(.*?)^```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    assert len(blocks) >= 6
    script = tmp_path / "document.py"
    script.write_text("\n".join(blocks), encoding="utf-8")
    made = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert made.returncode == 0, made.stderr


TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
WITH_PYTHON = [path for path in TUTORIALS if "\n```python\n" in path.read_text(encoding="utf-8")]


def test_a_tutorial_has_code():
    assert WITH_PYTHON


@pytest.mark.parametrize("tutorial", WITH_PYTHON, ids=lambda path: path.stem)
def test_the_commands_and_the_code_of_a_tutorial_run(tutorial, tmp_path):
    blocks = re.findall(r"^```(sh|python)\n(.*?)^```", tutorial.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    programs = os.pathsep.join([os.fspath(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "PATH": programs, "MPLBACKEND": "svg"}
    for kind, code in blocks:
        command = ["bash", "-e", "-c", code] if kind == "sh" else [sys.executable, "-c", code]
        made = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300)
        assert made.returncode == 0, made.stderr
    # Runs draw pictures too, but none with axes.
    saved = re.findall(r'savefig\("(.*?)"\)', tutorial.read_text(encoding="utf-8"))
    assert saved and all((tmp_path / name).stat().st_size > 1000 for name in saved)


def test_the_example_in_the_package_runs():
    import doctest

    import lennard

    failed, tried = doctest.testmod(lennard)
    assert failed == 0 and tried >= 4
