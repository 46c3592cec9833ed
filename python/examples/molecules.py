"""Rigid dumbbells: means of molecules, and bonds that keep their length."""

import numpy as np

import lennard

simulation = lennard.Simulation("dumbbell/liquid", set={"stage.production.steps": 3000, "stage.equilibrate.steps": 1000})
run = simulation.run()
print(f"{simulation.n_molecules} molecules of {simulation.n_atoms} sites")
print(f"U = {run.averages['potential_energy']}")

with simulation.view() as state:
    bonds = np.linalg.norm(state.positions[1::2] - state.positions[::2], axis=1)
print(f"bonds: {bonds.min():.9f} to {bonds.max():.9f} σ")
assert np.abs(bonds - 0.67).max() < 1e-9
