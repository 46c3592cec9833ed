//! The partial radial distribution functions of a mixture.

use lennard_core::{Findings, Persist, RestoreError, SpeciesTable, StateReader, StateWriter, View};

use super::{RadialDistribution, add_sample};
use crate::blocks::BlockedSums;
use crate::pairs::count_distances_by_species;
use crate::species_pairs::SpeciesPair;

/// Counts of the pairs of each two species, from which
///
/// g_ab = V/(N_a·N_b)·⟨Σ_{i∈a, j∈b} δ(r − r_ij)⟩/(4πr²), with N_a(N_a − 1) where a = b.
///
/// The coordination number n_ab is the mean number of neighbors of species b around a particle of species a, up to the
/// first minimum of g_ab. It is n_ba·N_b/N_a.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Partial {
    pub(super) species: SpeciesTable,
    pub(super) pairs: Vec<(SpeciesPair, BlockedSums)>,
}

impl Partial {
    /// Nothing counted yet; `None` where there is one species.
    pub(super) fn new(species: &SpeciesTable, bins: usize) -> Option<Self> {
        species.is_mixture().then(|| Self {
            pairs: SpeciesPair::all(species).map(|pair| (pair, BlockedSums::new(bins))).collect(),
            species: species.clone(),
        })
    }

    /// Adds a sample, of which `all` are the counts of all pairs.
    pub(super) fn sample(&mut self, view: &View<'_>, r_max: f64, weight: f64, all: &[u64]) {
        let positions = &view.state.positions;
        let found = count_distances_by_species(&self.species, positions, view.cell(), r_max, all);
        for ((_, counts), found) in self.pairs.iter_mut().zip(found) {
            add_sample(counts, weight, &found);
        }
    }
}

impl Persist for Partial {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { species: _, pairs } = self;
        for (pair, counts) in pairs {
            counts.save(&mut to.section(&pair.section()));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        for (pair, counts) in &mut self.pairs {
            counts.restore(&from.section(&pair.section()))?;
        }
        Ok(())
    }
}

impl RadialDistribution {
    /// Adds what the partial functions say, and gives their columns beside r: nothing where there is one species.
    pub(super) fn finish_partial(
        &self,
        discarded: f64,
        findings: &mut Findings,
    ) -> Vec<(String, Vec<f64>)> {
        let mut columns = Vec::new();
        let Some(Partial { species, pairs }) = &self.partial else {
            return columns;
        };
        for (pair, counts) in pairs {
            let counts = counts.after(discarded);
            let suffix = pair.suffix(species);
            let ordered = pair.ordered(species);
            if ordered == 0.0 {
                findings.remarks.push(format!("g{suffix}(r) needs two particles"));
                continue;
            }
            let weight = if pair.a == pair.b { 2.0 } else { 1.0 };
            let mut reading = self.reading_of(weight, ordered).named(suffix.clone());
            reading.add_neighbors(&suffix, weight / species.count(pair.a) as f64);
            if pair.a != pair.b {
                let other = pair.reversed().suffix(species);
                reading.add_neighbors(&other, weight / species.count(pair.b) as f64);
            }
            let (g, error) = reading.distribution(&counts);
            reading.add_peaks(&counts, findings, &g, &error);
            columns.push((format!("g{suffix}"), g));
            columns.push((format!("standard_error{suffix}"), error));
            for (which, suffix) in reading.neighbors() {
                columns.push((format!("coordination{suffix}"), reading.running(&counts, which)));
            }
        }
        findings.remarks.push(
            "coordination_number_a_b counts particles of species b around a particle of species a"
                .into(),
        );
        columns
    }
}
