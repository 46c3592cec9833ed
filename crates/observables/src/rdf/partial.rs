//! The partial radial distribution functions of a mixture.

use crate::Findings;

use super::RadialDistribution;
use crate::blocks::BlockedSums;
use crate::species_pairs::SpeciesPair;

impl RadialDistribution {
    /// Adds what the partial functions say, and gives their columns beside r: nothing where there is one species. From the counts
    /// of the pairs of each two species comes
    ///
    /// g_ab = V/(N_a·N_b)·⟨Σ_{i∈a, j∈b} δ(r − r_ij)⟩/(4πr²), with N_a(N_a − 1) where a = b.
    ///
    /// The coordination number n_ab is the mean number of neighbors of species b around a particle of species a, up to the
    /// first minimum of g_ab. It is n_ba·N_b/N_a.
    pub(super) fn finish_partial(
        &self,
        pairs: &[(SpeciesPair, BlockedSums)],
        findings: &mut Findings,
    ) -> Vec<(String, Vec<f64>)> {
        let (species, mut columns) = (&self.species, Vec::new());
        for (pair, counts) in pairs {
            let suffix = pair.suffix(species);
            let ordered = pair.ordered(species);
            if ordered == 0.0 {
                findings.remark(format!("g{suffix}(r) needs two particles"));
                continue;
            }
            let weight = if pair.a == pair.b { 2.0 } else { 1.0 };
            let mut reading = self.reading_of(weight, ordered).named(suffix.clone());
            reading.add_neighbors(&suffix, weight / species.count(pair.a) as f64);
            if pair.a != pair.b {
                let other = pair.reversed().suffix(species);
                reading.add_neighbors(&other, weight / species.count(pair.b) as f64);
            }
            let (g, error) = reading.distribution(counts);
            reading.add_peaks(counts, findings, &g, &error);
            columns.push((format!("g{suffix}"), g));
            columns.push((format!("standard_error{suffix}"), error));
            for (which, suffix) in reading.neighbors() {
                columns.push((format!("coordination{suffix}"), reading.running(counts, which)));
            }
        }
        if !pairs.is_empty() {
            findings.remark(
            "coordination_number_a_b counts particles of species b around a particle of species a",
        );
        }
        columns
    }
}
