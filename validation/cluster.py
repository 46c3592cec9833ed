"""Slurm with two virtual nodes on this machine, for tests: a real scheduler, started and stopped here."""

from __future__ import annotations

import os
import secrets
import shutil
import socket
import subprocess
import time
from pathlib import Path

#: Debian's packages of Slurm, and their programs.
PACKAGES = ["slurmctld", "slurmd", "slurm-client", "munge"]
PROGRAMS = ["slurmctld", "slurmd", "sbatch", "munged"]
#: Ports of the controller and of the nodes.
PORTS = [17000, 17001, 17002]


class NotHere(Exception):
    """Slurm cannot be started on this machine; the message says why."""


def install(programs: list[str], packages: list[str]) -> None:
    """Installs the packages of programs that are missing, where that is possible."""
    missing = [program for program in programs if not shutil.which(program)]
    if missing:
        install_packages(packages, missing[0])


def install_packages(packages: list[str], missing: str) -> None:
    """Installs packages of Debian, where that is possible, since something is missing."""
    if os.geteuid() != 0 or shutil.which("apt-get") is None:
        raise NotHere(f"{missing} is missing: as root on Debian, apt-get install {' '.join(packages)}")
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    subprocess.run(["apt-get", "update"], check=False, **quiet)
    command = ["apt-get", "install", "-y", "--no-install-recommends", *packages]
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    if subprocess.run(command, check=False, env=environment, **quiet).returncode != 0:
        raise NotHere(f"{' '.join(command)} failed")


class Slurm:
    """A controller and two nodes with one processor each; `close` ends them."""

    def __init__(self, folder: Path) -> None:
        if os.geteuid() != 0:
            raise NotHere("Slurm's daemons need root")
        self.folder = folder
        self.daemons: list[subprocess.Popen] = []
        host = socket.gethostname()
        self.conf = folder / "slurm.conf"
        munge = folder / "munge.socket"
        key = folder / "munge.key"
        key.write_bytes(secrets.token_bytes(1024))
        key.chmod(0o400)
        self.conf.write_text(
            f"""ClusterName=lennard
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthInfo=socket={munge}
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
MpiDefault=none
ReturnToService=2
SlurmdParameters=config_overrides
SlurmctldPort={PORTS[0]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
NodeName=node[1-2] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{PORTS[1]}-{PORTS[2]}] CPUs=1
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""",
            encoding="utf-8",
        )
        for name in ["state", "spool-node1", "spool-node2"]:
            (folder / name).mkdir()
        self._start(
            ["munged", "--foreground", "--force", f"--socket={munge}", f"--key-file={key}"]
            + [f"--{kind}-file={folder}/munge.{kind}" for kind in ["pid", "log", "seed"]]
        )
        self._wait(lambda: munge.exists(), "munged")
        self._start(["slurmctld", "-D", "-c", "-f", str(self.conf)])
        for node in ["node1", "node2"]:
            self._start(["slurmd", "-D", "-N", node, "-f", str(self.conf)])
        self._wait(lambda: self.call("sinfo", "-h", "-o", "%T %D").strip() == "idle 2", "Slurm's nodes")

    def _start(self, command: list[str]) -> None:
        log = (self.folder / "daemons.log").open("ab")
        environment = {**os.environ, "SLURM_CONF": str(self.conf)}
        self.daemons.append(subprocess.Popen(command, stdout=log, stderr=log, env=environment))

    def _wait(self, ready, what: str, seconds: float = 60.0) -> None:
        end = time.monotonic() + seconds
        while not ready():
            if time.monotonic() > end:
                self.close()
                raise NotHere(f"{what} did not start within {seconds:.0f} s (see {self.folder})")
            time.sleep(0.2)

    def call(self, *command: str, cwd: Path | None = None) -> str:
        """Runs a command of Slurm, and returns what it prints."""
        environment = {**os.environ, "SLURM_CONF": str(self.conf)}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=cwd, check=False)
        return done.stdout if done.returncode == 0 else f"exit code {done.returncode}: {done.stderr}"

    def close(self) -> None:
        """Ends all daemons."""
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in self.daemons:
            try:
                daemon.wait(timeout=10)
            except subprocess.TimeoutExpired:
                daemon.kill()
