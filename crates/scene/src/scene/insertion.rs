//! What trial particles see of the fluid that a scene describes, and what observables are built for.

use std::sync::Arc;

use lennard_core::random::Streams;
use lennard_core::{Own, PeriodicBox, SpeciesTable};
use lennard_forcefield::{ForceFieldError, Model, tail_in};
use lennard_observables::{BuildContext, Insertion, TrialEnergies};

use crate::Scene;

/// The energies of pairs of species as the forces of a scene have them, and the tails of trial particles.
#[derive(Debug)]
struct Trials {
    /// Row by row, `[species]²`.
    pairs: Vec<TrialPair>,
    /// V·∂U_tail/∂N of each species, ε·σ³.
    tails: Vec<f64>,
}

/// A pair of species: u(r) = ε·f(r/σ), where the formula f has its own cutoff.
#[derive(Debug)]
struct TrialPair {
    formula: Model,
    sigma: f64,
    epsilon: f64,
}

impl Trials {
    fn of(scene: &Scene, species: &SpeciesTable) -> Result<Self, ForceFieldError> {
        let n = species.n_species();
        let pair = |k: usize| -> Result<TrialPair, ForceFieldError> {
            let pair = scene.species_pair(k / n, k % n);
            let own = scene.truncation.at_cutoff(pair.r_cut / pair.sigma);
            Ok(TrialPair {
                formula: Model::new(&scene.potential, &own)?,
                sigma: pair.sigma,
                epsilon: pair.epsilon,
            })
        };
        Ok(Self {
            pairs: (0..n * n).map(pair).collect::<Result<_, _>>()?,
            tails: (0..n).map(|a| tail_of_one_more(scene, species, a)).collect(),
        })
    }

    fn pair(&self, a: usize, b: usize) -> &TrialPair {
        &self.pairs[a * self.tails.len() + b]
    }
}

impl TrialEnergies for Trials {
    fn cutoff(&self, a: usize, b: usize) -> f64 {
        let pair = self.pair(a, b);
        pair.formula.r_cut * pair.sigma
    }

    fn sum(&self, a: usize, b: usize, squared_distances: &[f64]) -> f64 {
        let pair = self.pair(a, b);
        let per_square = 1.0 / (pair.sigma * pair.sigma);
        let energies = squared_distances.iter().map(|r2| pair.formula.eval(r2 * per_square).energy);
        pair.epsilon * energies.sum::<f64>()
    }

    fn tail(&self, a: usize) -> f64 {
        self.tails[a]
    }
}

/// V·∂U_tail/∂N_a. U_tail is quadratic in the numbers of particles, so that half the difference of one more and one less is exact.
fn tail_of_one_more(scene: &Scene, species: &SpeciesTable, a: usize) -> f64 {
    let counts: Vec<usize> = (0..species.n_species()).map(|b| species.count(b)).collect();
    let energy = |count: usize| {
        let mut counts = counts.clone();
        counts[a] = count;
        let species = scene.species_in_order(&counts);
        let mixture = scene.mixture_of(&species);
        let n = species.n_particles();
        let tail = tail_in(&scene.force_field(), mixture.as_ref(), n, 1.0);
        tail.map_or(0.0, |tail| tail.energy)
    };
    0.5 * (energy(counts[a] + 1) - energy(counts[a] - 1))
}

impl Scene {
    /// What an observable may know of this scene, where it samples every so many steps of `dt` τ.
    #[must_use]
    pub fn observable_context(
        &self,
        cell: PeriodicBox,
        species: &SpeciesTable,
        dt: f64,
        every: u64,
    ) -> BuildContext {
        BuildContext {
            cell,
            n_atoms: species.n_particles(),
            own: Own::all_of(species.n_particles()),
            dt,
            every,
            r_cut: self.longest_cutoff(),
            molecules: self.molecules(),
            species: species.clone(),
            insertion: self.insertion(species),
        }
    }

    /// What trial particles need; `None` where the measured stages do not hold one temperature, and for molecules.
    fn insertion(&self, species: &SpeciesTable) -> Option<Insertion> {
        let wanted = self.observables.iter().any(|o| o.options.spec().needs_temperature);
        let measured = self.measured_stages().next()?;
        if !wanted || self.molecule.is_some() || !measured.holds_one_temperature() {
            return None;
        }
        let energies = Trials::of(self, species).ok()?;
        Some(Insertion {
            temperature: measured.temperature,
            streams: Streams::new(self.system.seed),
            energies: Arc::new(energies),
        })
    }
}
