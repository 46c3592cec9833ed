"""A liquid near its triple point: averages with errors, g(r), and the equation of state."""

import lennard

simulation = lennard.Simulation.liquid(density=0.8442, temperature=0.722, n=256, seed=1)
simulation.equilibrate(1000, thermostat=lennard.thermostat.bussi(tau=0.5))
run = simulation.run(3000, measure=[lennard.observable.rdf(every=20), "msd"])

pressure = run.averages["pressure"]
print(f"P = {pressure}, from {pressure.n_eff:.0f} independent samples")
print(f"the equation of state of Thol 2016: {lennard.eos.thol_2016.pressure(0.8442, 0.722):.3f}")

peak = run.rdf["g"].argmax()
print(f"first peak of g(r): {run.rdf['g'][peak]:.2f} at {run.rdf['r'][peak]:.2f} σ")
