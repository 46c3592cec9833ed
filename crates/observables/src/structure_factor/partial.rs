//! The partial structure factors of a mixture.

use crate::Findings;
use glam::DVec2;
use lennard_core::{SpeciesTable, View};

use super::StructureFactor;
use crate::averages::of_blocks;
use crate::binned::Part;
use crate::blocks::BlockedSums;
use crate::species_pairs::SpeciesPair;

/// The composition of a mixture varies over long distances more than twice as much as in an ideal mixture: its species gather.
const GATHERS: f64 = 2.0;

/// Standard errors beyond [`GATHERS`] from which it is said.
const CERTAIN: f64 = 4.0;

/// The partial structure factors of a mixture, with ρ_a(k) = Σ_{j∈a} exp(−i k·r_j):
///
/// S_ab(k) = ⟨Re ρ_a·ρ_b*⟩/√(N_a·N_b). For an ideal gas S_aa = 1 and S_ab = 0.
///
/// Of two species also the factors of number and concentration, with ρ = ρ_1 + ρ_2 and c = x_2·ρ_1 − x_1·ρ_2:
/// S_NN = ⟨|ρ|²⟩/N, which is the factor of all particles, S_NC = ⟨Re ρ·c*⟩/N and S_CC = ⟨|c|²⟩/N. In an ideal mixture S_CC is
/// x_1·x_2 at every k. (A. B. Bhatia and D. E. Thornton, Phys. Rev. B 2, 3004 (1970).)
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Species(SpeciesPair),
    NumberConcentration,
    Concentration,
}

impl Part for Kind {
    fn section(&self) -> String {
        match self {
            Self::Species(pair) => pair.section(),
            Self::NumberConcentration => "number_concentration".into(),
            Self::Concentration => "concentration".into(),
        }
    }
}

impl Kind {
    /// What is averaged of a mixture; nothing where there is one species.
    pub(super) fn of_mixture(species: &SpeciesTable) -> impl Iterator<Item = Self> + use<> {
        let of_two: &[Self] = match species.n_species() {
            2 => &[Self::NumberConcentration, Self::Concentration],
            _ => &[],
        };
        SpeciesPair::of_mixture(species).map(Self::Species).chain(of_two.iter().copied())
    }

    fn suffix(self, species: &SpeciesTable) -> String {
        match self {
            Self::Species(pair) => pair.suffix(species),
            Self::NumberConcentration => "_NC".into(),
            Self::Concentration => "_CC".into(),
        }
    }

    /// What one wave vector adds, given ρ_a of all species.
    fn of(self, species: &SpeciesTable, densities: &[DVec2]) -> f64 {
        let n = species.n_particles() as f64;
        let all = || densities[0] + densities[1];
        let concentration =
            || species.fraction(1) * densities[0] - species.fraction(0) * densities[1];
        match self {
            Self::Species(pair) => {
                let (a, b) = (species.count(pair.a) as f64, species.count(pair.b) as f64);
                densities[pair.a].dot(densities[pair.b]) / (a * b).sqrt()
            }
            Self::NumberConcentration => all().dot(concentration()) / n,
            Self::Concentration => concentration().length_squared() / n,
        }
    }
}

impl StructureFactor {
    /// ρ(k) of all particles for each wave vector of a sample, whose parts are added where there are several species.
    pub(super) fn sample_densities(&mut self, view: &View<'_>) -> Vec<DVec2> {
        let (own, positions, cell) = (view.system.own(), &view.state.positions, view.cell());
        let (species, vectors) = (&self.species, &self.vectors);
        if !species.is_mixture() {
            return vectors.densities(own, positions, cell);
        }
        let of_species = vectors.densities_by_species(own, species, positions, cell);
        for (_, factors) in &mut self.factors.parts {
            factors.begin_sample();
        }
        let mut here = vec![DVec2::ZERO; of_species.len()];
        let mut total = Vec::with_capacity(vectors.len());
        for (k, vector) in vectors.iter().enumerate() {
            for (here, densities) in here.iter_mut().zip(&of_species) {
                *here = densities[k];
            }
            for (kind, factors) in &mut self.factors.parts {
                factors.add(vector.shell, kind.of(species, &here), 1);
            }
            total.push(here.iter().sum());
        }
        total
    }

    /// Adds what the partial factors say, and gives their columns beside k: nothing where there is one species.
    pub(super) fn finish_partial(
        &self,
        parts: &[(Kind, BlockedSums)],
        wave_numbers: &[f64],
        findings: &mut Findings,
    ) -> Vec<(String, Vec<f64>)> {
        let mut columns = Vec::new();
        for (kind, factors) in parts {
            let suffix = kind.suffix(&self.species);
            let [values, errors] = factors.curve(0..wave_numbers.len(), 1.0);
            columns.push((format!("structure_factor{suffix}"), values));
            columns.push((format!("standard_error{suffix}"), errors));
            if *kind == Kind::Concentration {
                self.add_concentration(factors, wave_numbers[0], findings);
            }
        }
        columns
    }

    /// S_CC at the smallest wave number in x_1·x_2, and whether the species gather.
    fn add_concentration(&self, factors: &BlockedSums, k: f64, findings: &mut Findings) {
        let ideal = self.species.fraction(0) * self.species.fraction(1);
        let Some(mean) = factors.mean(0) else {
            return;
        };
        let blocks: Vec<f64> = factors.block_means(0).iter().map(|s| s / ideal).collect();
        let average = of_blocks("concentration_fluctuations", "", mean / ideal, &blocks, 0.0);
        let (value, error) = (average.estimate.mean, average.estimate.standard_error);
        findings.remark(format!(
            "concentration_fluctuations is S_CC/(x₁·x₂) at the smallest wave number, {k:.3} σ⁻¹: 1 in an ideal mixture"
        ));
        if value - GATHERS > CERTAIN * error {
            findings.remark(format!(
                "the species gather: over {:.1} σ the composition varies {value:.1} times as much as in an ideal mixture, which may be separating",
                std::f64::consts::TAU / k
            ));
        }
        findings.averages.push(average);
    }
}
