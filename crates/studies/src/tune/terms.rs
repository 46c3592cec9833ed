//! A truncated potential by bins of distance, and how two of them differ.

use lennard_forcefield::{Mixture, Model, SpeciesPair, TruncationOptions};
use lennard_scene::Scene;

use super::TuneError;
use super::pairs::{BIN_WIDTH, Fluid, PairKind};
use crate::lab::Value;

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
        let weight = if r == 0.0 { 0.0 } else { r * r / (r * r + e * e) };
        let unsure = e * weight.sqrt().max(0.5);
        Value {
            mean: self.direct.mean + weight * r,
            standard_error: self.direct.standard_error.hypot(unsure),
            n_effective: self.response.n_effective,
        }
    }
}

/// A truncated potential, bin by bin of distance, for each two species in turn.
#[derive(Debug, Clone)]
pub(super) struct Terms {
    /// U(r), ε.
    pub energy: Vec<f64>,
    /// U(r) of which the forces are the gradient, ε.
    pub conserved: Vec<f64>,
    /// r·F(r), ε.
    pub virial: Vec<f64>,
    /// (1/m_a + 1/m_b)·(U″ + 2U′/r), ε/(m·σ²): the Laplacian that a pair adds, by masses.
    pub laplacian: Vec<f64>,
    /// Tail corrections of U a particle and of P.
    pub tail: [f64; 2],
}

impl Terms {
    /// Of a truncation of the scene's potential; cutoffs beyond the sight of the survey end there.
    pub fn of(
        scene: &Scene,
        truncation: TruncationOptions,
        fluid: &Fluid,
        volume: f64,
        sight: f64,
    ) -> Result<Self, TuneError> {
        let bins = bins_within(sight);
        let sight = bins as f64 * BIN_WIDTH;
        let mut scene = scene.clone();
        scene.truncation = truncation;
        let mut terms = Self {
            energy: Vec::new(),
            conserved: Vec::new(),
            virial: Vec::new(),
            laplacian: Vec::new(),
            tail: [0.0; 2],
        };
        for kind in &fluid.kinds {
            let pair = within(&scene, kind.species, sight);
            terms.add(&model_of(&scene, &pair)?, &pair, kind, bins);
        }
        let species = fluid.system().species();
        let mixture = scene.mixture.as_ref().map(|_| {
            let pair = |a, b| within(&scene, [a, b], sight);
            let of_particle: Vec<u8> =
                (0..species.n_particles()).map(|i| species.of(i) as u8).collect();
            Mixture::new(species.n_species(), pair, of_particle)
        });
        let mixture = mixture.transpose().map_err(|e| TuneError::Force(e.to_string()))?;
        let mut options = scene.force_field();
        options.truncation.r_cut = truncation.r_cut.min(sight);
        let n_atoms = species.n_particles();
        let tail = lennard_forcefield::tail_in(&options, mixture.as_ref(), n_atoms, volume);
        if let Some(tail) = tail {
            terms.tail = [tail.energy / fluid.units(), tail.pressure];
        }
        Ok(terms)
    }

    /// Adds the bins of a pair of species.
    fn add(&mut self, model: &Model, pair: &SpeciesPair, kind: &PairKind, bins: usize) {
        let (sigma, epsilon) = (pair.sigma, pair.epsilon);
        let end = model.r_cut * sigma;
        for bin in 0..bins {
            let low = bin as f64 * BIN_WIDTH;
            let share = ((end - low) / BIN_WIDTH).clamp(0.0, 1.0);
            // Below half a diameter no pair is ever found.
            let [energy, conserved, virial, laplacian] =
                if bin < (0.5 * sigma / BIN_WIDTH) as usize || share == 0.0 {
                    [0.0; 4]
                } else {
                    let r = low + 0.5 * share * BIN_WIDTH;
                    let found = model.eval(r * r / (sigma * sigma));
                    let force = epsilon * found.force / (sigma * sigma);
                    let curvature = epsilon * found.curvature / (sigma * sigma);
                    [
                        share * (epsilon * found.energy),
                        share * (epsilon * (found.energy - model.energy_at_cutoff)),
                        share * r * r * force,
                        share * kind.inverse_mass() * (curvature - 2.0 * force),
                    ]
                };
            self.energy.push(energy);
            self.conserved.push(conserved);
            self.virial.push(virial);
            self.laplacian.push(laplacian);
        }
    }
}

/// The parameters of a pair of species, with a cutoff within the sight.
fn within(scene: &Scene, [a, b]: [usize; 2], sight: f64) -> SpeciesPair {
    let pair = scene.species_pair(a, b);
    SpeciesPair { r_cut: pair.r_cut.min(sight), ..pair }
}

/// The f of u_ab(r) = ε_ab·f(r/σ_ab) for a pair of species; a switch keeps its share of the cutoff.
pub(super) fn model_of(scene: &Scene, pair: &SpeciesPair) -> Result<Model, TuneError> {
    let r_cut = pair.r_cut / pair.sigma;
    let truncation = TruncationOptions {
        r_cut,
        switch_from: (scene.truncation.switch_from)
            .map(|from| from * r_cut / scene.truncation.r_cut),
        ..scene.truncation
    };
    let model = Model::new(&scene.potential, &truncation)
        .map_err(|e| scene.source.invalid(&e.key(), e.found(), e.allowed()))?;
    Ok(model)
}

/// Whole bins up to a distance.
pub(super) fn bins_within(sight: f64) -> usize {
    // The share of a bin that rounding may take is no bin.
    (sight / BIN_WIDTH + 1e-6) as usize
}

/// Σ counts·weights.
pub(super) fn dot(counts: &[f32], weights: &[f64]) -> f64 {
    counts.iter().zip(weights).map(|(c, w)| f64::from(*c) * w).sum()
}
