//! The pairs of the sample by distance: of each two species, and of the sites of molecules.

use lennard_core::{Momentum, State, System};
use lennard_observables::{count_distances, count_distances_by_species};
use lennard_scene::Scene;

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
    pub fn inverse_mass(&self) -> f64 {
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
    pub fn of(scene: &Scene, system: System) -> Self {
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
    pub fn units(&self) -> f64 {
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
    pub fn has_bonds(&self) -> bool {
        !self.system.molecules.are_atoms()
    }

    /// The mass of all particles, where they are alike.
    pub fn common_mass(&self) -> Option<f64> {
        let first = self.kinds.first()?.masses[0];
        let masses = self.kinds.iter().flat_map(|kind| kind.masses);
        masses.into_iter().all(|m| m == first).then_some(first)
    }

    /// Degrees of freedom of a motion that keeps the total momentum.
    pub fn n_dof(&self) -> f64 {
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
            true => count_distances_by_species(species, &state.positions, &state.cell, reach, &all)
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
