"""The mixture of Kob and Andersen: where the first neighbors of each species stand."""

import lennard

steps = {"stage.production.steps": 2000, "stage.equilibrate.steps": 2000}
simulation = lennard.Simulation("mixture/kob-andersen", set=steps)
run = simulation.run()

table = run.rdf
for pair in ("A_A", "A_B", "B_B"):
    g = table[f"g_{pair}"]
    print(f"g({pair.replace('_', ' ')}): first peak {g.max():.2f} at {table['r'][g.argmax()]:.2f} σ")
assert table["g_A_B"].max() > table["g_A_A"].max(), "an A and a B attract each other most"
