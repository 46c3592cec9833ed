"""Argon with ASE: relaxed by ASE's optimizer, then run by the engine, then back to ASE."""

from ase import units
from ase.build import bulk
from ase.optimize import BFGS

import lennard.ase
from lennard.ase import ARGON, Lennard

atoms = bulk("Ar", "fcc", a=5.4, cubic=True) * (4, 4, 4)
atoms.rattle(0.1, seed=1)
atoms.calc = Lennard(**ARGON, rc=3.0 * ARGON["sigma"], truncation="force-shift")
BFGS(atoms, logfile=None).run(fmax=0.01)
print(f"energy of the crystal: {1000 * atoms.get_potential_energy() / len(atoms):.2f} meV for each atom")

simulation = lennard.ase.simulation(
    atoms, **ARGON, rc=3.0 * ARGON["sigma"], truncation="force-shift", dt=4 * units.fs, temperature=60
)
simulation.run(1000)
hot = simulation.to_ase(**ARGON, mass=float(atoms.get_masses()[0]))
print(f"after {simulation.steps_done} steps: {hot.get_temperature():.0f} K")
