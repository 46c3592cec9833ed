"""Diffusion of a liquid by two routes: from displacements, and from velocities."""

import lennard

simulation = lennard.Simulation.liquid(density=0.7, temperature=1.2, n=256, seed=4)
simulation.equilibrate(1000)
run = simulation.run(20_000, measure=[lennard.observable.msd(every=10), lennard.observable.vacf(every=5)])

for name, mean in run.averages.items():
    if "diffusion" in name:
        print(f"{name}: {mean}")

time, msd = run.msd["time"], run.msd["msd"]
late = time > 0.5 * time[-1]
slope = float(((msd[late] - msd[late].mean()) * (time[late] - time[late].mean())).sum())
slope /= float(((time[late] - time[late].mean()) ** 2).sum())
print(f"a sixth of the slope of the displacements: {slope / 6:.4f} σ²/τ")
