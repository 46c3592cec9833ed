"""The command that comes with the package."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    script = Path(sys.executable).with_name("lennard")
    return subprocess.run([script, *arguments], capture_output=True, text=True)


def test_it_prints_what_the_program_prints(command_line):
    for arguments in (["list", "observables"], ["--version"], ["run", "--help"]):
        made, expected = command(*arguments), command_line(*arguments)
        assert made.returncode == 0
        assert made.stdout == expected.stdout


def test_it_exits_with_the_codes_of_the_program(command_line, tmp_path):
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("[sytem]\n")
    for arguments in (["plan", str(wrong)], ["no-such-command"]):
        made, expected = command(*arguments), command_line(*arguments, check=False)
        assert (made.returncode, made.stderr) == (expected.returncode, expected.stderr)
        assert made.returncode == 2


def test_the_module_is_the_command_too():
    made = subprocess.run([sys.executable, "-m", "lennard", "--version"], capture_output=True, text=True)
    assert made.stdout == command("--version").stdout


def test_the_command_does_without_numpy_and_every_name_is_found_when_asked_for():
    script = (
        "import sys, lennard._cli, lennard\n"
        "assert 'numpy' not in sys.modules\n"
        "assert set(lennard.__all__) <= set(dir(lennard))\n"
        "missing = [name for name in lennard.__all__ if not hasattr(lennard, name)]\n"
        "assert not missing and not hasattr(lennard, 'Simulatoin'), missing\n"
        "assert 'numpy' in sys.modules\n"
    )
    made = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
