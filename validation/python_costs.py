"""What the Python package costs beside the command line: `python validation/python_costs.py` in an environment with its wheel.

Times of processors are compared, in turn, since other work on the machine lengthens wall times. A wall time stands where
nothing else says it: how soon Ctrl-C ends a run. How long the commands take to start has both.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

import lennard
from lennard.ase import Lennard

SCENE = """
[system]
n_atoms = 864
density = 0.8442
temperature = 1.0
[integrator]
dt = 0.004
[output]
thermo_every = 1000
[[stage]]
name = "production"
steps = {steps}
"""
INTERRUPTED = """
import os, signal, sys, threading, time
import lennard
# A shell has its background commands ignore the signal.
signal.signal(signal.SIGINT, signal.default_int_handler)
simulation = lennard.Simulation.liquid(density=0.8, temperature=1.0, n=int(sys.argv[1]), seed=2)
sent = []
def send():
    time.sleep(1.0)
    sent.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=send).start()
try:
    simulation.run(100_000_000)
except KeyboardInterrupt:
    print(time.perf_counter() - sent[0])
"""


def of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def callback(program: str, steps: int, pairs: int, folder: Path) -> None:
    """A run with a callback over the same run of the program."""
    scene = folder / "liquid.toml"
    scene.write_text(SCENE.format(steps=steps), encoding="utf-8")
    ratios, told = [], 0

    def tell(stage: str, done: int, total: int) -> None:
        nonlocal told
        told += 1

    for pair in range(pairs):
        before = of_children()
        out = folder / f"run-{pair}"
        command = [program, "run", os.fspath(scene), "--threads", "1", "--no-report", "--quiet", "--out", os.fspath(out)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        theirs = of_children() - before
        before = time.process_time()
        lennard.Simulation(scene, threads=1).run(progress=tell)
        ratios.append((time.process_time() - before) / theirs)
    low, high = min(ratios), max(ratios)
    print(
        f"864 particles, {steps} steps, callback called {told // pairs} times a run: "
        f"{statistics.median(ratios):.3f} of the program's time ({low:.3f} to {high:.3f}, {pairs} pairs)"
    )


def calculator(calls: int) -> None:
    """A call of the calculator for 4,000 atoms over the compiled part of it."""
    simulation = lennard.Simulation.liquid(density=0.8442, temperature=1.0, n=4000, truncation={"kind": "shift"})
    simulation.step(200)
    atoms = simulation.to_ase()
    atoms.calc = calc = Lennard(threads=1)
    atoms.get_forces()
    sides = (float(atoms.cell[0, 0]), float(atoms.cell[1, 1]), float(atoms.cell[2, 2]))
    whole, inner = [], []
    rng = np.random.default_rng(0)
    for _ in range(calls):
        atoms.positions += rng.normal(scale=1e-5, size=atoms.positions.shape)
        before = time.process_time()
        atoms.get_forces()
        whole.append(time.process_time() - before)
        positions = np.ascontiguousarray(atoms.positions)
        before = time.process_time()
        assert calc._forces is not None and calc._forces._evaluator is not None
        calc._forces._evaluator.evaluate(positions, sides, True, True, False)
        inner.append(time.process_time() - before)
    call, kernel = 1e6 * statistics.median(whole), 1e6 * statistics.median(inner)
    print(f"calculator, 4000 atoms: {call:.0f} µs a call, of which {kernel:.0f} µs compiled; {call - 1.2 * kernel:.0f} µs beyond 1.2 times that")


def interrupt(n: int, times: int) -> None:
    """From the signal to KeyboardInterrupt."""
    found = []
    for _ in range(times):
        made = subprocess.run(
            [sys.executable, "-c", INTERRUPTED, str(n)], capture_output=True, text=True, check=True, timeout=300
        )
        found.append(1e3 * float(made.stdout))
    print(f"Ctrl-C, {n} particles: {statistics.median(found):.0f} ms (at most {max(found):.0f}, {times} runs)")


def other_thread() -> None:
    """What another thread counts during a run."""
    simulation = lennard.Simulation.liquid(density=0.8442, temperature=1.0, n=864)
    done = threading.Event()
    counted = 0

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1

    thread = threading.Thread(target=count)
    thread.start()
    begin = time.perf_counter()
    before = counted
    simulation.step(20_000)
    seconds = time.perf_counter() - begin
    rate = (counted - before) / seconds
    done.set()
    thread.join()
    print(f"another thread counts {rate:.2g} times a second during a run")


def start(name: str, program: str, times: int) -> None:
    """How long `--version` takes, by the processor and by the wall."""
    used, passed = [], []
    for _ in range(times):
        before, begin = of_children(), time.perf_counter()
        subprocess.run([program, "--version"], check=True, stdout=subprocess.DEVNULL)
        passed.append(1e3 * (time.perf_counter() - begin))
        used.append(1e3 * (of_children() - before))
    clocks = (("of processors", used), ("by the wall", passed))
    told = (f"{statistics.median(found):.1f} ms {clock} (at least {min(found):.1f})" for clock, found in clocks)
    print(f"{name} --version: {', '.join(told)}, {times} calls")


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--program", default=shutil.which("lennard"), help="the program of cargo; else the one on PATH")
    arguments.add_argument("--steps", type=int, default=100_000)
    arguments.add_argument("--pairs", type=int, default=7)
    arguments.add_argument("--only", choices=["callback", "others"], help="a part; by default all")
    given = arguments.parse_args()
    if given.program is None:
        sys.exit("no program `lennard` on PATH\n  allowed: --program FILE")
    own = Path(sys.executable).parent / "lennard"
    if given.only != "others":
        with tempfile.TemporaryDirectory() as folder:
            callback(given.program, given.steps, given.pairs, Path(folder))
    if given.only == "callback":
        return
    calculator(201)
    for n in (864, 32_000, 256_000):
        interrupt(n, 5)
    other_thread()
    start("program", given.program, 21)
    if own.exists():
        start("command of the wheel", os.fspath(own), 21)


if __name__ == "__main__":
    main()
