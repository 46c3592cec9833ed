"""MPI for the tests of `lennard-mpi`: a library from PyPI or the system's, and the program built with it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from cluster import NotHere, install_packages

import lennard_validation as lv

ROOT = Path(__file__).resolve().parent.parent
#: Environments and builds of these tests.
FOLDER = ROOT / "target" / "mpi"
#: The library and the parser of C headers from PyPI. No root is needed for them.
WHEELS = ["mpich==5.0.2", "libclang==18.1.1"]
#: Debian's packages, where PyPI cannot be reached.
PACKAGES = ["libopenmpi-dev", "openmpi-bin", "libclang-dev"]


#: Runs a command, and appends the number of the rank and the most bytes that it held to a file.
PEAK = """
import os, resource, subprocess, sys
# MPI gives its ranks open files.
code = subprocess.call(sys.argv[2:], close_fds=False)
rank = next(os.environ[name] for name in ["OMPI_COMM_WORLD_RANK", "PMI_RANK"] if name in os.environ)
with open(sys.argv[1], "a") as file:
    file.write(f"{rank} {1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss}\\n")
sys.exit(code)
"""


@dataclass
class Mpi:
    """One MPI library, with `lennard-mpi` built for it."""

    name: str
    mpirun: list[str]
    mpicc: Path
    program: Path
    environment: dict[str, str]

    def command(self, ranks: int, *arguments: str) -> list[str]:
        return [*self.mpirun, "-n", str(ranks), str(self.program), *arguments]

    def run(self, ranks: int, *arguments: str) -> subprocess.CompletedProcess:
        command = self.command(ranks, *arguments)
        return subprocess.run(
            command, env=self.environment, capture_output=True, text=True, check=False, timeout=600
        )

    def peaks(self, folder: Path, ranks: int, *arguments: str) -> list[int]:
        """The most bytes that each rank of a run held; works where `ru_maxrss` counts kilobytes, as on Linux."""
        script, file = folder / "peak.py", folder / "peaks.txt"
        script.write_text(PEAK, encoding="utf-8")
        held = [sys.executable, str(script), str(file), str(self.program), *arguments]
        command = [*self.mpirun, "-n", str(ranks), *held]
        done = subprocess.run(
            command, env=self.environment, capture_output=True, text=True, check=False, timeout=600
        )
        assert done.returncode == 0, done.stderr
        lines = (line.split() for line in file.read_text(encoding="utf-8").splitlines())
        return [int(bytes) for _, bytes in sorted(lines)]

    def start(self, ranks: int, *arguments: str) -> subprocess.Popen:
        return subprocess.Popen(
            self.command(ranks, *arguments),
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )


def wheels() -> Path:
    """An environment of its own with the wheels."""
    folder = FOLDER / "venv"
    python = folder / "bin" / "python"
    stamp = folder / "made-from.txt"
    if stamp.exists() and stamp.read_text(encoding="utf-8") == "\n".join(WHEELS):
        return folder
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True}
    commands = [
        [sys.executable, "-m", "venv", "--clear", str(folder)],
        [str(python), "-m", "pip", "install", "--quiet", *WHEELS],
    ]
    for command in commands:
        done = subprocess.run(command, check=False, **quiet)
        if done.returncode != 0:
            last = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
            raise NotHere(f"pip install {' '.join(WHEELS)}: {last}")
    stamp.write_text("\n".join(WHEELS), encoding="utf-8")
    return folder


def libclang(folder: Path) -> dict[str, str]:
    """Where the libclang of an environment is, as a variable; nothing where it has none."""
    found = next(folder.glob("lib/python*/site-packages/clang/native"), None)
    return {"LIBCLANG_PATH": str(found)} if found else {}


def mpich() -> Mpi:
    """MPICH from PyPI."""
    folder = wheels()
    clang = libclang(folder)
    if not clang:
        raise NotHere("the wheel of libclang has no library for this machine")
    environment = {
        **os.environ,
        **clang,
        # The build of the Rust crate drops the path that `mpicc` gives to the linker.
        "LD_LIBRARY_PATH": str(folder / "lib"),
    }
    mpicc = folder / "bin" / "mpicc"
    return built("MPICH", [str(folder / "bin" / "mpiexec")], mpicc, environment)


def open_mpi() -> Mpi:
    """Open MPI of the system, installed where that is possible."""
    if not has_headers():
        install_packages(PACKAGES, "mpi.h of Open MPI")
    environment = {**os.environ, **libclang(FOLDER / "venv")}
    # The wheel of libclang has no headers of the language itself.
    asked = subprocess.run(["cc", "-print-file-name=include"], capture_output=True, text=True, check=False)
    environment["BINDGEN_EXTRA_CLANG_ARGS"] = f"-I{asked.stdout.strip()}"
    mpirun = ["mpirun.openmpi", "--oversubscribe"] + (["--allow-run-as-root"] if os.geteuid() == 0 else [])
    mpicc = Path(shutil.which("mpicc.openmpi") or "mpicc")
    return built("Open MPI", mpirun, mpicc, environment)


def has_headers() -> bool:
    """Whether programs can be built with Open MPI: its compiler alone is in a package without them."""
    compiler = shutil.which("mpicc.openmpi")
    if compiler is None:
        return False
    asked = subprocess.run([compiler, "--showme:incdirs"], capture_output=True, text=True, check=False)
    return any((Path(folder) / "mpi.h").exists() for folder in asked.stdout.split())


def built(name: str, mpirun: list[str], mpicc: Path, environment: dict[str, str]) -> Mpi:
    """The program for a library, built together with the program under test: the pair loops are compiled once."""
    folder = lv.binary_path().resolve().parent
    profile = "dev" if folder.name == "debug" else folder.name
    environment = {**environment, "MPICC": str(mpicc)}

    def cargo(*arguments: str) -> None:
        command = [os.environ.get("CARGO", "cargo"), *arguments, "--profile", profile, "--target-dir", folder.parent]
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr

    # All but the bindings is the same for every library.
    stamp = folder / "built-for-mpi.txt"
    if not stamp.exists() or stamp.read_text(encoding="utf-8") != str(mpicc):
        cargo("clean", "-p", "mpi-sys")
        stamp.write_text(str(mpicc), encoding="utf-8")
    cargo("build", "--quiet", "-p", "lennard", "--features", "mpi")
    program = FOLDER / name.lower().replace(" ", "-") / "lennard-mpi"
    program.parent.mkdir(exist_ok=True)
    shutil.copy(folder / "lennard-mpi", program)
    return Mpi(name, mpirun, mpicc, program, environment)


def ranks_of(process: subprocess.Popen, program: Path, ranks: int) -> list[int]:
    """The process ids of the ranks that a starter has started, once all are there."""
    for _ in range(200):
        found = [pid for pid in descendants(process.pid) if name_of(pid) == program.name]
        if len(found) == ranks:
            return found
        time.sleep(0.05)
    raise AssertionError(f"{ranks} ranks did not start: {process.poll()}")


def descendants(pid: int) -> list[int]:
    listed = subprocess.run(["ps", "-e", "-o", "pid=,ppid="], capture_output=True, text=True, check=True)
    parents = {int(line.split()[0]): int(line.split()[1]) for line in listed.stdout.splitlines()}
    found, new = [], [pid]
    while new:
        new = [child for child, parent in parents.items() if parent in new]
        found += new
    return found


def name_of(pid: int) -> str:
    try:
        return os.readlink(f"/proc/{pid}/exe").rsplit("/", 1)[-1]
    except OSError:
        return ""
