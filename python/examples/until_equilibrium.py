"""A run that goes on until its pressure is known well enough, and that is saved on the way."""

from pathlib import Path
from tempfile import TemporaryDirectory

import lennard

simulation = lennard.Simulation.liquid(density=0.5, temperature=2.0, n=256, seed=2)
simulation.equilibrate(500)

for _ in range(20):
    simulation.step(500)
    pressure = simulation.results().averages["pressure"]
    print(f"step {simulation.steps_done}: P = {pressure}")
    if pressure.is_sound and pressure.error < 0.03:
        break

with TemporaryDirectory() as folder:
    file = Path(folder) / "state.lennard"
    simulation.save(file)
    other = lennard.Simulation.load(file)
other.step(100)
simulation.step(100)
assert (other.positions == simulation.positions).all(), "a saved simulation goes on to the bit"
