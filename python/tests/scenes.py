"""Six scenes that have little in common."""

from __future__ import annotations

BASE = """
[system]
n_atoms = 256
density = {density}
temperature = {temperature}
seed = {seed}
"""

STAGES = """
[[stage]]
name = "equilibrate"
steps = 120
thermostat = "bussi"

[[stage]]
name = "measure"
steps = 200
"""


def _base(density: float, temperature: float, seed: int) -> str:
    return BASE.format(density=density, temperature=temperature, seed=seed)


SCENES = {
    "liquid": _base(0.8442, 0.722, 1)
    + STAGES
    + '[[observable]]\nkind = "rdf"\nevery = 20\n[output]\ntrajectory_every = 40\n',
    "mixed-precision": _base(0.3, 2.0, 2) + '[kernel]\nprecision = "mixed"\n' + STAGES,
    "smooth": _base(0.6, 1.5, 3)
    + '[truncation]\nkind = "force-shift"\nr_cut = 2.4\n'
    + STAGES
    + '[[observable]]\nkind = "msd"\nevery = 5\n',
    "langevin": _base(0.7, 1.2, 4)
    + '[[stage]]\nname = "hold"\nsteps = 250\ntemperature = 1.4\nthermostat = { kind = "langevin" }\n'
    + "[output]\ntrajectory_every = 50\nforces = true\nunwrapped = true\n",
    "pressure": _base(0.8, 1.0, 5)
    + '[truncation]\nr_cut = 2.5\n[[stage]]\nname = "hold"\nsteps = 240\nthermostat = "bussi"\n'
    + "barostat = { kind = \"stochastic-cell-rescaling\", pressure = 1.0 }\n",
    "walls": _base(0.6, 1.2, 6)
    + '[[wall]]\nkind = "lennard-jones-9-3"\naxis = "z"\n[potential]\nkind = "mie"\nrepulsive = 12\n[truncation]\ntail_correction = false\n'
    + STAGES,
}
