"""The path of a newcomer, timed: from a clone to the first table, and to an isotherm beside the literature.

    python3 benches/first_hour.py [--pip]

It clones this repository to a folder of its own, gives the commands of README there, and prints the wall time of each and the
largest memory of all processes of the command together. Crates are compiled anew; those of a registry are downloaded where they are not
there yet. With `--pip`, it also makes an environment and installs the package. A quiet machine is needed for figures.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = os.sysconf("SC_PAGE_SIZE")
COMMANDS = [
    "cargo run --profile first -- run template",
    "cargo run --profile first -- new my-isotherm --like sweep/isotherm",
    "cargo run --profile first -- sweep my-isotherm",
    "cargo install --profile dist --locked --path crates/lennard --root installed",
    "installed/bin/lennard run template",
]
BY_PIP = ["python3 -m venv environment", "environment/bin/pip install .", "environment/bin/lennard run template"]


def resident(session: int) -> int:
    """Bytes of all processes of a session."""
    total = 0
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if int((folder / "stat").read_text().rsplit(")", 1)[1].split()[3]) == session:
                total += int((folder / "statm").read_text().split()[1]) * PAGE
        except (OSError, IndexError):
            continue  # it has ended
    return total


def timed(command: str, folder: Path) -> None:
    """Runs a command and prints what it took."""
    environment = {name: value for name, value in os.environ.items() if name != "CARGO_TARGET_DIR"}
    started, most = time.monotonic(), 0
    with open(folder / "said.txt", "w", encoding="utf-8") as said:
        child = subprocess.Popen(command.split(), cwd=folder, env=environment, stdout=said, stderr=said, start_new_session=True)
        while child.poll() is None:
            most = max(most, resident(child.pid))
            time.sleep(0.1)
    took = time.monotonic() - started
    print(f"{took:7.1f} s {most / 1e9:6.2f} GB  {command}", flush=True)
    if child.returncode != 0:
        sys.exit((folder / "said.txt").read_text(encoding="utf-8"))


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        clone = Path(temporary) / "lennard"
        subprocess.run(["git", "clone", "--quiet", ROOT, clone], check=True)
        for command in COMMANDS + (BY_PIP if "--pip" in sys.argv else []):
            timed(command, clone)
