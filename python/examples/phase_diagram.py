"""The coexistence of vapor and liquid from an equation of state, and where a state lies."""

import numpy as np

import lennard

thol = lennard.eos.thol_2016
print(f"{thol.name}: critical temperature {thol.critical_temperature:.3f} ε/k_B")
for temperature in np.arange(0.7, 1.3, 0.1):
    both = thol.coexistence(float(temperature))
    assert both is not None, "below the critical point"
    print(f"T = {temperature:.1f}: vapor {both.vapor_density:.4f}, liquid {both.liquid_density:.4f}, P = {both.pressure:.4f}")

densities = np.linspace(0.05, 0.8, 6)
print("P along T = 1.5:", np.round(thol.pressure(densities, 1.5), 3))
