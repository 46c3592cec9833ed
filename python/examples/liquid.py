"""A liquid: averages with errors, g(r), and the equation of state."""

import lennard

simulation = lennard.Simulation.liquid(density=0.8, temperature=1.0, n=500, seed=1, r_cut=4.0)
simulation.equilibrate(2000, thermostat=lennard.thermostat.bussi(tau=0.5))
run = simulation.run(10_000, measure=[lennard.observable.rdf(every=50), "msd"])

pressure = run.averages["pressure"]
print(f"P = {pressure}, from {pressure.n_eff:.0f} independent samples")
print(run.compare()[["quantity", "measured", "reference", "difference", "standard_error"]])

peak = run.rdf["g"].argmax()
print(f"first peak of g(r): {run.rdf['g'][peak]:.2f} at {run.rdf['r'][peak]:.2f} σ")
