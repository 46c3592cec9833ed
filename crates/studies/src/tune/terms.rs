//! A truncated potential by bins of distance, and how two of them differ.

use lennard_forcefield::{Model, TruncationOptions};
use lennard_scene::Scene;

use super::TuneError;
use crate::lab::Value;

/// Width of the bins of distance, σ.
pub(super) const BIN_WIDTH: f64 = 0.02;

/// How two truncations differ in a mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// On the same configurations.
    pub direct: Value,
    /// By the change of structure.
    pub response: Value,
}

impl Change {
    /// The sum, in which a response r ± e counts as r³/(r² + e²), as far as it stands out of its noise. A response
    /// that is lost in noise adds an uncertainty and no error.
    pub fn total(&self) -> Value {
        let (r, e) = (self.response.mean, self.response.standard_error);
        let weight = if r == 0.0 {
            0.0
        } else {
            r * r / (r * r + e * e)
        };
        let unsure = e * weight.sqrt().max(0.5);
        Value {
            mean: self.direct.mean + weight * r,
            standard_error: self.direct.standard_error.hypot(unsure),
            n_effective: self.response.n_effective,
        }
    }
}

/// A truncated potential, bin by bin of distance.
#[derive(Debug, Clone)]
pub(super) struct Terms {
    /// U(r), ε.
    pub energy: Vec<f64>,
    /// U(r) of which the forces are the gradient, ε.
    pub conserved: Vec<f64>,
    /// r·F(r), ε.
    pub virial: Vec<f64>,
    /// Tail corrections of U a particle and of P.
    pub tail: [f64; 2],
}

impl Terms {
    /// Of a truncation of the scene's potential; cutoffs beyond the sight of the survey end there.
    pub fn of(
        scene: &Scene,
        truncation: TruncationOptions,
        n_atoms: usize,
        volume: f64,
        sight: f64,
    ) -> Result<Self, TuneError> {
        let bins = bins_within(sight);
        let sight = bins as f64 * BIN_WIDTH;
        let truncation = TruncationOptions {
            r_cut: truncation.r_cut.min(sight),
            ..truncation
        };
        let model = Model::new(&scene.potential, &truncation)
            .map_err(|e| scene.source.invalid(&e.key(), e.found(), e.allowed()))?;
        let mut terms = Self {
            energy: vec![0.0; bins],
            conserved: vec![0.0; bins],
            virial: vec![0.0; bins],
            tail: [0.0; 2],
        };
        // Below half a diameter no pair is ever found.
        for bin in (0.5 / BIN_WIDTH) as usize..bins {
            let low = bin as f64 * BIN_WIDTH;
            let share = ((model.r_cut - low) / BIN_WIDTH).clamp(0.0, 1.0);
            if share == 0.0 {
                break;
            }
            let r = low + 0.5 * share * BIN_WIDTH;
            let pair = model.eval(r * r);
            terms.energy[bin] = share * pair.energy;
            terms.conserved[bin] = share * (pair.energy - model.energy_at_cutoff);
            terms.virial[bin] = share * r * r * pair.force;
        }
        let mut options = scene.force_field();
        options.truncation = truncation;
        let tail = lennard_forcefield::tail_correction(&options, n_atoms, volume);
        if let Some(tail) = tail {
            terms.tail = [tail.energy_per_particle, tail.pressure];
        }
        Ok(terms)
    }
}

/// Whole bins up to a distance.
pub(super) fn bins_within(sight: f64) -> usize {
    // The share of a bin that rounding may take is no bin.
    (sight / BIN_WIDTH + 1e-6) as usize
}

/// Σ counts·weights.
pub(super) fn dot(counts: &[f32], weights: &[f64]) -> f64 {
    counts
        .iter()
        .zip(weights)
        .map(|(c, w)| f64::from(*c) * w)
        .sum()
}
