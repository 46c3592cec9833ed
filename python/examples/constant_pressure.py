"""A liquid at constant pressure: its density beside the equation of state, and how much its volume fluctuates."""

import lennard

TEMPERATURE, PRESSURE = 1.2, 1.19
simulation = lennard.Simulation.liquid(density=0.7, temperature=TEMPERATURE, n=256, seed=3, r_cut=3.0)
bath = lennard.thermostat.bussi(tau=0.2)
barostat = lennard.barostat.stochastic_cell_rescaling(pressure=PRESSURE)
simulation.equilibrate(1500, thermostat=bath, barostat=barostat)
run = simulation.run(40_000, thermostat=bath, barostat=barostat)

density = run.averages["density"]
print(f"density {density} at P = {PRESSURE}")
print(f"the equation of state there has P = {lennard.eos.thol_2016.pressure(density.value, TEMPERATURE):.2f}")
print(f"volume of the box now: {simulation.volume:.1f} σ³")
