"""One sweep by Slurm, by GNU parallel and by dask, stopped and killed on the way: `cargo xtask cluster`."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import cluster
import pytest
from cluster import NotHere, Slurm, install

import lennard_validation as lv

pytestmark = pytest.mark.cluster

BASE = """
[system]
n_atoms = 256
density = 0.5
temperature = 1.5
seed = 3

[truncation]
kind = "cut"
r_cut = 2.5

[[stage]]
name = "production"
steps = 4000
"""
SWEEP = 'base = "base.toml"\n[grid]\ndensity = [0.3, 0.4, 0.5, 0.6]\ntemperature = [1.5, 2.0, 2.5]\n'


@pytest.fixture(scope="module")
def place(tmp_path_factory) -> Path:
    """A sweep of twelve points in a folder, and its table by one process in `one`."""
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "base.toml").write_text(BASE, encoding="utf-8")
    (folder / "sweep.toml").write_text(SWEEP, encoding="utf-8")
    sweep(folder, "--out", "one", "--quiet")
    return folder


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    try:
        install(cluster.PROGRAMS, cluster.PACKAGES)
        started = Slurm(tmp_path_factory.mktemp("slurm"))
    except NotHere as reason:
        pytest.skip(str(reason))
    yield started
    started.close()


def environment() -> dict[str, str]:
    """The program under test is `lennard` on the path, as scripts call it."""
    programs = lv.binary().resolve().parent
    return {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}


def sweep(folder: Path, *arguments: str) -> str:
    command = ["lennard", "sweep", "sweep.toml", *arguments]
    done = subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def same_as_one_process(folder: Path, out: str) -> None:
    sweep(folder, "--out", out, "--collect", "--quiet")
    assert (folder / out / "table.csv").read_bytes() == (folder / "one" / "table.csv").read_bytes()
    for state in (folder / "one").glob("*/final.xyz"):
        there = folder / out / state.parent.name / "final.xyz"
        assert there.read_bytes() == state.read_bytes(), there


def submit(slurm: Slurm, folder: Path, script: str, *options: str) -> str:
    """Gives a script to Slurm, and returns the number of the job."""
    (folder / "job.sbatch").write_text(script, encoding="utf-8")
    path = f"--export=ALL,PATH={environment()['PATH']}"
    return slurm.call("sbatch", "--parsable", path, *options, "job.sbatch", cwd=folder).strip()


def ended(slurm: Slurm, job: str, seconds: float = 300.0) -> bool:
    end = time.monotonic() + seconds
    while slurm.call("squeue", "-h", "-j", job).strip().startswith(job):
        if time.monotonic() > end:
            return False
        time.sleep(0.3)
    return True


def test_an_array_of_slurm_on_two_nodes_gives_the_table_of_one_process(slurm, place):
    script = sweep(place, "--out", "slurm", "--emit", "slurm")
    job = submit(slurm, place, script)
    assert re.fullmatch(r"\d+", job), job
    assert ended(slurm, job)
    same_as_one_process(place, "slurm")


def test_a_task_that_slurm_stops_goes_on_to_the_same_bits(slurm, place):
    steps = ["--set", "stage.production.steps=200000"]
    sweep(place, "--out", "long", "--point", "5", "--quiet", *steps)
    script = sweep(place, "--out", "requeued", "--emit", "slurm", *steps)
    job = submit(slurm, place, script, "--array=5")
    point = place / "requeued" / "rho0.4-T2.5"
    end = time.monotonic() + 60
    while not (point / "thermo.csv").exists() and time.monotonic() < end:
        time.sleep(0.05)
    time.sleep(0.5)
    requeued = slurm.call("scontrol", "requeue", f"{job}_5")
    assert "exit code" not in requeued, requeued
    # Slurm holds a task that comes back for two minutes; nobody needs to wait for that.
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        state = slurm.call("squeue", "-h", "-j", job, "-o", "%t %r").strip()
        if state.startswith("PD"):
            slurm.call("scontrol", "update", f"JobId={job}_5", "StartTime=now")
            break
        time.sleep(0.3)
    assert list(point.glob("*.lennard")), "the task left no checkpoint"
    assert ended(slurm, job)
    assert (point / "final.xyz").read_bytes() == (place / "long" / "rho0.4-T2.5" / "final.xyz").read_bytes()
    stopped = "".join(log.read_text() for log in place.glob(f"slurm-{job}_*.out"))
    assert "stopped on request" in stopped, stopped


def test_gnu_parallel_runs_the_script(place):
    try:
        install(["parallel"], ["parallel"])
    except NotHere as reason:
        pytest.skip(str(reason))
    script = sweep(place, "--out", "parallel", "--emit", "parallel")
    subprocess.run(["bash", "-c", script], cwd=place, env=environment(), check=True)
    same_as_one_process(place, "parallel")


@pytest.fixture(scope="module")
def distributed(tmp_path_factory) -> Path:
    """The package `distributed` in a folder of its own."""
    folder = tmp_path_factory.mktemp("dask")
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--target", str(folder), "distributed==2026.8.0"]
    if subprocess.run(command, check=False, capture_output=True).returncode != 0:
        pytest.skip("dask's package distributed cannot be installed")
    return folder


DASK = """
import os, signal, subprocess, sys, time
from distributed import Client, LocalCluster

def point(k):
    command = ["lennard", "sweep", "sweep.toml", "--out", "dask", "--quiet", "--point", str(k)]
    while subprocess.run(command, capture_output=True).returncode == 2:
        time.sleep(0.2)  # the process of the killed worker may still be at work there
    return os.getpid()

if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        jobs = [client.submit(point, k) for k in range(12)]
        time.sleep(1.0)
        os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
        print(len(client.gather(jobs)))
"""


def test_dask_runs_the_points_of_a_killed_worker_again(place, distributed):
    (place / "by_dask.py").write_text(DASK, encoding="utf-8")
    variables = {**environment(), "PYTHONPATH": str(distributed)}
    command = [sys.executable, "by_dask.py"]
    done = subprocess.run(command, cwd=place, env=variables, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "12"
    same_as_one_process(place, "dask")


def test_a_point_that_is_killed_again_and_again_ends_with_the_same_bits(place):
    settings = ["stage.production.steps=60000", "checkpoint.every_steps=2000"]
    arguments = ["--point", "7", "--quiet", *(word for setting in settings for word in ("--set", setting))]
    sweep(place, "--out", "calm", *arguments)
    command = ["lennard", "sweep", "sweep.toml", "--out", "killed", *arguments]
    kills = 0
    for k in range(20):
        process = subprocess.Popen(command, cwd=place, env=environment(), stderr=subprocess.DEVNULL)
        try:
            process.wait(timeout=0.05 + 0.03 * k)
            break
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait()
            kills += 1
    assert kills > 2
    sweep(place, "--out", "killed", *arguments)
    last = "rho0.5-T2/final.xyz"
    assert (place / "killed" / last).read_bytes() == (place / "calm" / last).read_bytes()
