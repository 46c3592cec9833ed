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
