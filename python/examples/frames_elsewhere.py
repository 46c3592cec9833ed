"""Frames in memory: a structure factor by numpy, and g(r) by MDAnalysis beside Lennard's own."""

import numpy as np

import lennard

simulation = lennard.Simulation.liquid(density=0.8, temperature=1.0, n=256, seed=5)
simulation.equilibrate(500)
run = simulation.run(400, trajectory_every=40, measure=[lennard.observable.rdf(every=40)])
frames = run.frames
assert frames is not None
print(frames)

length = float(frames.box[0, 0])
waves = 2 * np.pi / length * np.array([[6, 0, 0], [0, 6, 0], [0, 0, 6]])
amplitudes = np.exp(1j * frames.positions @ waves.T).sum(axis=1)
factor = (np.abs(amplitudes) ** 2).mean() / frames.positions.shape[1]
print(f"S(k = {6 * 2 * np.pi / length:.2f}/σ) = {factor:.2f}")

try:
    from MDAnalysis.analysis.rdf import InterRDF
except ImportError:
    print("MDAnalysis is not installed")
else:
    atoms = frames.to_mdanalysis().atoms
    theirs = InterRDF(atoms, atoms, nbins=250, range=(0.5, 3.0), exclusion_block=(1, 1)).run().results
    peak = theirs.rdf.argmax()
    print(f"first peak: {theirs.rdf[peak]:.2f} at {theirs.bins[peak]:.2f} σ by MDAnalysis, {run.rdf['g'].max():.2f} here")
