"""Ctrl-C in a process of its own."""

from __future__ import annotations

import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")

SCRIPT = """
import os, signal, sys, threading, time
import lennard, numpy as np
n, steps = int(sys.argv[1]), int(sys.argv[2])
# A shell that starts a command in the background has it ignore this signal.
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = dict(density=0.8, temperature=1.0, n=n, seed=2)
simulation = lennard.Simulation.liquid(**scene)
sent = []
def send():
    time.sleep(0.5)
    sent.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=send).start()
try:
    simulation.run(steps)
    print("not interrupted")
except KeyboardInterrupt:
    print("interrupted", time.perf_counter() - sent[0])
simulation.end_stage()
done = simulation.steps_done
simulation.step(25)
other = lennard.Simulation.liquid(**scene)
other.step(done + 25)
print("same" if np.array_equal(simulation.positions, other.positions) else "other bits")
"""


def interrupted(n: int, steps: int) -> tuple[list[str], float]:
    made = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(n), str(steps)], capture_output=True, text=True, timeout=120
    )
    assert made.returncode == 0, made.stderr
    words = made.stdout.split()
    assert words[0] == "interrupted", made.stdout
    return words[2:], float(words[1])


def test_ctrl_c_stops_a_run_which_then_goes_on_to_the_same_bits():
    rest, _ = interrupted(864, 1_000_000)
    assert rest == ["same"]


def test_the_command_of_the_package_answers_ctrl_c_as_the_program_does(tmp_path, liquid):
    scene = tmp_path / "long.toml"
    scene.write_text(liquid + '[[stage]]\nname = "long"\nsteps = 10000000\n')
    script = (
        "import os, signal, sys, threading, time\n"
        "threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
        f"sys.argv = ['lennard', 'run', {str(scene)!r}, '--out', {str(tmp_path / 'run')!r}]\n"
        "from lennard._cli import main\nmain()\n"
    )
    made = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert made.returncode == 4, made.stderr
    assert "stopped on request after step" in made.stderr
    assert "Traceback" not in made.stderr
    assert list((tmp_path / "run").glob("checkpoint-*.lennard"))
