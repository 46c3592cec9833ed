"""A loop of one's own: a liquid is cooled step by step, and its state is looked at between the steps."""

import numpy as np

import lennard

simulation = lennard.Simulation.liquid(density=0.85, temperature=2.0, n=256, seed=6)
for temperature in np.linspace(2.0, 0.8, 5):
    simulation.equilibrate(400, temperature=float(temperature))
    with simulation.view() as state:
        fastest = np.sqrt((state.velocities**2).sum(axis=1)).max()
    print(f"T = {simulation.temperature:.2f}: U = {simulation.potential_energy:.3f} ε, fastest {fastest:.1f} σ/τ")

print("the same from the command line:")
print(simulation.scene.splitlines()[0])
