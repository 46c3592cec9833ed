//! The pairs of the sample by distance, of each two species and of the sites of molecules, and what a truncated potential gives for
//! them.

use lennard_core::{Momentum, State, System};
use lennard_forcefield::{Mixture, Model, SpeciesPair, TruncationOptions};
use lennard_observables::{Estimate, count_distances, count_distances_by_species};
use lennard_scene::Scene;

use crate::StudyError;

/// Width of the bins of distance, σ.
pub(super) const BIN_WIDTH: f64 = 0.02;

/// Two species with what all their pairs have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PairKind {
    /// The two, by number.
    pub species: [usize; 2],
    /// Pairs of particles in a homogeneous fluid: N_a·N_b, or N_a²/2.
    pub pairs: f64,
    /// Masses of the two, m.
    pub masses: [f64; 2],
}

impl PairKind {
    /// 1/m_a + 1/m_b, the inverse of the reduced mass.
    pub(crate) fn inverse_mass(&self) -> f64 {
        self.masses.iter().map(|m| m.recip()).sum()
    }
}

/// What the sample is made of.
#[derive(Debug, Clone)]
pub(super) struct Fluid {
    system: System,
    /// All pairs of species a ≤ b.
    pub kinds: Vec<PairKind>,
}

/// Pairs at one moment: for each [`PairKind`] in turn, one number for each bin of distance.
pub(super) struct Counts {
    /// Pairs that a force acts between.
    pub pairs: Vec<f32>,
    /// Σ (r·R)/r² over pairs of sites, with the vector R between the centres of their molecules: r·F times this is the
    /// molecular virial. `None` for atoms, where it is the number of pairs.
    pub leverage: Option<Vec<f32>>,
}

impl Fluid {
    /// The fluid of a scene that begins with these species of particles.
    pub(crate) fn of(scene: &Scene, system: System) -> Self {
        let species = system.species();
        let kinds = scene.species_pairs().map(|[a, b]| {
            let [n_a, n_b] = [a, b].map(|a| species.count(a) as f64);
            PairKind {
                species: [a, b],
                pairs: if a == b { 0.5 * n_a * n_a } else { n_a * n_b },
                masses: [a, b].map(|a| species.species(a).mass),
            }
        });
        Self { kinds: kinds.collect(), system: system.bonded(scene.molecules()) }
    }

    /// What moves.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Molecules; particles where there are none. Energies are given for each of them.
    pub(crate) fn units(&self) -> f64 {
        self.system.n_molecules() as f64
    }

    /// What energies are given for each of, in a word.
    pub fn unit(&self) -> &'static str {
        match self.has_bonds() {
            true => "molecule",
            false => "particle",
        }
    }

    /// Whether there are molecules.
    pub(crate) fn has_bonds(&self) -> bool {
        !self.system.molecules.are_atoms()
    }

    /// The mass of all particles, where they are alike.
    pub(crate) fn common_mass(&self) -> Option<f64> {
        let first = self.kinds.first()?.masses[0];
        let masses = self.kinds.iter().flat_map(|kind| kind.masses);
        masses.into_iter().all(|m| m == first).then_some(first)
    }

    /// Degrees of freedom of a motion that keeps the total momentum.
    pub(crate) fn n_dof(&self) -> f64 {
        self.system.n_dof(Momentum::Conserved)
    }

    /// The pairs of a state in so many bins of distance.
    pub fn count(&self, state: &State, bins: usize) -> Counts {
        let reach = bins as f64 * BIN_WIDTH;
        if self.has_bonds() {
            return self.count_sites(state, bins);
        }
        let all = count_distances(&state.positions, &state.cell, reach, bins);
        let species = self.system.species();
        let counts = match species.is_mixture() {
            true => count_distances_by_species(
                species,
                self.system.own(),
                &state.positions,
                &state.cell,
                reach,
                &all,
            )
            .concat(),
            false => all,
        };
        Counts { pairs: counts.iter().map(|n| *n as f32).collect(), leverage: None }
    }

    /// The same for sites of molecules. The two ends of a bond are no pair.
    fn count_sites(&self, state: &State, bins: usize) -> Counts {
        let (molecules, masses) = (&self.system.molecules, &self.system.masses);
        let (sites, exclusions) = (molecules.sites(), molecules.exclusions());
        let positions = &state.positions;
        let arms: Vec<_> = (positions.chunks_exact(sites).enumerate())
            .flat_map(|(m, own)| {
                let center = molecules.center(masses, m * sites, own);
                own.iter().map(move |r| *r - center)
            })
            .collect();
        let reach = bins as f64 * BIN_WIDTH;
        let mut pairs = vec![0.0_f32; bins];
        let mut leverage = vec![0.0_f64; bins];
        for i in 0..positions.len() {
            for j in i + 1..positions.len() {
                let r = state.cell.minimum_image(positions[i] - positions[j]);
                let r2 = r.length_squared();
                let bin = (r2.sqrt() / BIN_WIDTH) as usize;
                if r2 >= reach * reach || bin >= bins || exclusions.exclude(i, j) {
                    continue;
                }
                pairs[bin] += 1.0;
                if i / sites != j / sites {
                    leverage[bin] += r.dot(r - arms[i] + arms[j]) / r2;
                }
            }
        }
        Counts { pairs, leverage: Some(leverage.iter().map(|x| *x as f32).collect()) }
    }
}

/// How two truncations differ in a mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// On the same configurations.
    pub direct: Estimate,
    /// By the change of structure.
    pub response: Estimate,
}

impl Change {
    /// The sum, in which a response r ± e counts as r³/(r² + e²), as far as it stands out of its noise. A response
    /// that is lost in noise adds an uncertainty and no error.
    pub(crate) fn total(&self) -> Estimate {
        let (r, e) = (self.response.mean, self.response.standard_error);
        let weight = if r == 0.0 { 0.0 } else { r * r / (r * r + e * e) };
        let unsure = e * weight.sqrt().max(0.5);
        Estimate::new(
            self.direct.mean + weight * r,
            self.direct.standard_error.hypot(unsure),
            self.response.n_effective,
        )
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
    pub(crate) fn of(
        scene: &Scene,
        truncation: TruncationOptions,
        fluid: &Fluid,
        volume: f64,
        sight: f64,
    ) -> Result<Self, StudyError> {
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
        let mixture = mixture.transpose()?;
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
pub(super) fn model_of(scene: &Scene, pair: &SpeciesPair) -> Result<Model, StudyError> {
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
