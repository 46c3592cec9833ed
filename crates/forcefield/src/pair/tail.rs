//! Tail corrections of a homogeneous fluid beyond the cutoff, where g(r) = 1 is assumed.

use std::f64::consts::PI;

use serde::Serialize;

use super::{Mixture, as_one_fluid};
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
    let (r_cut, formula) = (o.truncation.r_cut, o.potential.formula());
    let (energy, virial) = (formula.tail_energy(r_cut), formula.tail_virial(r_cut));
    let n = n_atoms as f64;
    let pairs_density = 2.0 * PI * n * (n / volume);
    Some(Tail::new(pairs_density * energy, -pairs_density * virial, n, volume))
}

/// The tail correction of a mixture in `volume` σ³; `None` where the options have it off.
///
/// U_tail = (2π/V)·Σ_ab N_a·N_b·∫ r² u_ab dr from r_cut,ab to ∞, and W_tail = −(2π/V)·Σ_ab N_a·N_b·∫ r³ u_ab′ dr, over all
/// ordered pairs of species. With u_ab(r) = ε·f(r/σ) both integrals are ε·σ³ times the integrals of f from r_cut/σ on.
#[must_use]
pub fn tail_of_mixture(o: &ForceFieldOptions, mixture: &Mixture, volume: f64) -> Option<Tail> {
    if !o.truncation.tail_correction {
        return None;
    }
    if let Some(truncation) = as_one_fluid(&o.truncation, mixture) {
        let one = ForceFieldOptions { truncation, ..*o };
        return tail_correction(&one, mixture.n_atoms(), volume);
    }
    let (mut energy, mut virial) = (0.0, 0.0);
    let formula = o.potential.formula();
    for (pairs, pair) in mixture.ordered_pairs() {
        let r_cut = pair.r_cut / pair.sigma;
        let unit = pairs * pair.epsilon * pair.sigma.powi(3);
        energy += unit * formula.tail_energy(r_cut);
        virial += unit * formula.tail_virial(r_cut);
    }
    let density = 2.0 * PI / volume;
    let n = mixture.n_atoms() as f64;
    Some(Tail::new(density * energy, -density * virial, n, volume))
}

/// The tail correction of `n_atoms` particles, or of a mixture where there is one.
#[must_use]
pub fn tail_in(
    o: &ForceFieldOptions,
    mixture: Option<&Mixture>,
    n_atoms: usize,
    volume: f64,
) -> Option<Tail> {
    match mixture {
        Some(mixture) => tail_of_mixture(o, mixture, volume),
        None => tail_correction(o, n_atoms, volume),
    }
}

impl Tail {
    /// The tail with these totals of `n` particles, ε.
    fn new(energy: f64, virial: f64, n: f64, volume: f64) -> Self {
        Self { energy, virial, pressure: virial / (3.0 * volume), energy_per_particle: energy / n }
    }
}
