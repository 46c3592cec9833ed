//! Tail corrections of a homogeneous fluid beyond the cutoff, where g(r) = 1 is assumed.

use std::f64::consts::PI;

use serde::Serialize;

use crate::options::ForceFieldOptions;

/// What lies beyond the cutoff of a homogeneous fluid; totals for the system.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tail {
    /// U_tail = 2πNρ ∫ r² U dr from r_cut to ∞, ε.
    pub energy: f64,
    /// W_tail = −2πNρ ∫ r³ U′ dr from r_cut to ∞, ε, without a factor 1/3.
    pub virial: f64,
    /// P_tail = W_tail/(3V), ε/σ³.
    pub pressure: f64,
    /// U_tail/N, ε.
    pub energy_per_particle: f64,
}

/// The tail correction of `n_atoms` particles in `volume` σ³; `None` where the options have it off.
///
/// With −dU_tail/dV at constant N it obeys P_tail = −∂U_tail/∂V.
/// Allen and Tildesley, "Computer Simulation of Liquids", eqs. 2.144 and 2.145 in the second edition.
#[must_use]
pub fn tail_correction(o: &ForceFieldOptions, n_atoms: usize, volume: f64) -> Option<Tail> {
    if !o.truncation.tail_correction {
        return None;
    }
    let (energy, virial) = o.potential.tail_integrals(o.truncation.r_cut);
    let n = n_atoms as f64;
    let pairs_density = 2.0 * PI * n * (n / volume);
    let energy = pairs_density * energy;
    let virial = -pairs_density * virial;
    Some(Tail {
        energy,
        virial,
        pressure: virial / (3.0 * volume),
        energy_per_particle: energy / n,
    })
}
