//! The radial distribution function.

mod entropy;
mod partial;
mod reading;

use crate::{
    BuildContext, Findings, Observable, ObservableError, ObservableSpec, Recipe, Surroundings,
    Table,
};
use lennard_core::{SpeciesTable, View, persist};

use crate::averages::tell_discarded;
use crate::binned::Binned;
use crate::error::{within, within_box};
use crate::pairs::{count_distances_by_species, count_distances_inside, count_distances_of_all};
use crate::seen_box::SeenBox;
use crate::species_pairs::SpeciesPair;

use reading::Reading;

const SPEC: ObservableSpec = ObservableSpec {
    name: "rdf",
    summary: "radial distribution function g(r), its peaks, and the coordination number",
    equation: "g(r) = V/(N(N−1)) · ⟨Σ_{i≠j} δ(r − r_ij)⟩/(4πr²); n(r) = (N−1)/V ∫₀^r g 4πs² ds",
    source: "J.-P. Hansen and I. R. McDonald, Theory of Simple Liquids, 4th ed. (2013), equations 2.5.8 and 2.5.13",
    every: 100,
    surroundings: Surroundings::Periodic,
    alone: None,
    ..ObservableSpec::PLAIN
};

/// Largest distance where the scene gives none, in σ: liquid structure is gone there.
const DEFAULT_R_MAX: f64 = 6.0;

lennard_core::options! {
    /// Options of [`RadialDistribution`].
    pub struct RdfOptions {
        /// Largest distance.
        r_max: Option<f64> = None, else "the smaller of half the shortest side and 6", Words("a number above 0, at most half the shortest box side"), in "σ";
        /// Number of bins of equal width.
        bins: usize = 300, Whole(1, 100_000);
    }
}

impl Recipe for RdfOptions {
    const SPEC: &'static ObservableSpec = &SPEC;

    fn build(&self, context: &BuildContext) -> Result<Box<dyn Observable>, ObservableError> {
        Ok(Box::new(RadialDistribution::new(self, context)?))
    }
}

/// The radial distribution function in bins of equal width.
///
/// Bin k holds the pairs with k·w ≤ r < (k + 1)·w, w = r_max/bins, and
///
/// g_k = 2·⟨pairs in the bin·V⟩ / (N(N − 1)·(4π/3)(r_{k+1}³ − r_k³)),
///
/// normalised by the number of *other* particles, N − 1: for an ideal gas of any N it is exactly 1. Some programs have
/// N in place of N − 1, which makes g smaller by 1/N. In a fluid of molecules, g counts pairs of sites of different
/// molecules, and N − 1 is the number of sites of the other molecules. The error of each bin comes from the scatter
/// over successive blocks of the run.
///
/// In a mixture, g_ab is the same for the pairs of species a and b.
///
/// The coordination number is n(r) at the first minimum of g after its first peak. Minimum and peak are the extrema
/// of fitted cubics. Their errors come from a jackknife over blocks of the run, in which the extrema are fitted
/// anew.
#[derive(Debug, Clone, PartialEq)]
pub struct RadialDistribution {
    seen: SeenBox,
    n_atoms: usize,
    /// Sites of each molecule; 1 for atoms.
    sites: usize,
    r_max: f64,
    bins: usize,
    species: SpeciesTable,
    counts: Binned<SpeciesPair>,
}

impl RadialDistribution {
    /// Nothing counted yet.
    ///
    /// # Errors
    /// [`ObservableError`] where `r_max` is beyond half the shortest side, or there are no bins.
    pub fn new(options: &RdfOptions, context: &BuildContext) -> Result<Self, ObservableError> {
        let largest = context.cell.largest_cutoff();
        within_box("r_max", options.r_max, &context.cell)?;
        let r_max = options.r_max.unwrap_or(largest.min(DEFAULT_R_MAX));
        within("bins", options.bins, 1..=100_000)?;
        Ok(Self {
            seen: SeenBox::new(&context.cell),
            n_atoms: context.n_atoms,
            sites: context.molecules.sites(),
            r_max,
            bins: options.bins,
            species: context.species.clone(),
            counts: Binned::new("counts", options.bins, SpeciesPair::of_mixture(&context.species)),
        })
    }

    fn width(&self) -> f64 {
        self.r_max / self.bins as f64
    }

    /// The middles of the bins in σ.
    #[must_use]
    pub fn radii(&self) -> Vec<f64> {
        (0..self.bins).map(|k| (k as f64 + 0.5) * self.width()).collect()
    }

    /// How counts of all pairs are read.
    fn reading(&self) -> Reading {
        let (n, sites) = (self.n_atoms as f64, self.sites as f64);
        let mut reading = self.reading_of(2.0, n * (n - sites));
        reading.add_neighbors("", 2.0 / n);
        reading
    }

    /// How counts of pairs are read that stand for `weight` ordered pairs each, of `ordered` in all.
    fn reading_of(&self, weight: f64, ordered: f64) -> Reading {
        let scale = weight * self.seen.first_volume();
        let volume = self.seen.volume() / self.seen.first_volume();
        Reading::new(self.radii(), self.width(), scale, ordered, volume)
    }

    /// g(r) in each bin with its standard error.
    #[must_use]
    pub fn distribution(&self) -> (Vec<f64>, Vec<f64>) {
        self.reading().distribution(&self.counts.whole)
    }
}

impl Observable for RadialDistribution {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let cell = view.cell();
        self.seen.see(cell);
        let weight = cell.volume() / self.seen.first_volume();
        let (own, positions) = (view.system.own(), &view.state.positions);
        let mut found = count_distances_of_all(own, positions, cell, self.r_max, self.bins);
        if self.sites > 1 {
            let inside = count_distances_inside(self.sites, positions, cell, self.r_max, self.bins);
            for (all, inside) in found.iter_mut().zip(inside) {
                *all -= inside;
            }
        }
        // In a box that stays, whole numbers below 2⁵³ add exactly.
        let weighted = |found: Vec<u64>| found.into_iter().map(move |pairs| weight * pairs as f64);
        if self.species.is_mixture() {
            let by_species =
                count_distances_by_species(&self.species, own, positions, cell, self.r_max, &found);
            for ((_, counts), found) in self.counts.parts.iter_mut().zip(by_species) {
                counts.add_sample(weighted(found));
            }
        }
        self.counts.whole.add_sample(weighted(found));
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        let counts = self.counts.after(discarded);
        let samples = counts.whole.samples();
        if samples == 0 {
            return findings;
        }
        let reading = self.reading();
        let (g, error) = reading.distribution(&counts.whole);
        let running = reading.running(&counts.whole, 0);
        reading.add_peaks(&counts.whole, &mut findings, &g, &error);
        let partial = self.finish_partial(&counts.parts, &mut findings);
        findings.averages.extend(self.two_body_entropy(&counts));
        tell_discarded(&mut findings, self.counts.whole.samples() - samples);
        let valid = self.seen.half_shortest();
        if valid < self.r_max {
            findings.remark(format!(
                "g(r) counts up to half the box, which was {valid:.3} σ at its smallest: beyond, pairs are missing"
            ));
        }
        let table = Table::new(
                "rdf",
                format!(
                    "radial distribution function over {samples} configurations; r is the middle of the bin, coordination counts up to its outer edge"
                ),
            )
            .with("r", "σ", self.radii())
            .with("g", "", g)
            .with("standard_error", "", error)
            .with("coordination", "", running);
        findings.tables.insert(
            0,
            partial.into_iter().fold(table, |table, (name, numbers)| table.with(name, "", numbers)),
        );
        findings.remark("g(r) is normalised by N − 1: exactly 1 for an ideal gas");
        findings
    }
}

persist!(RadialDistribution { ..counts, seen as "box", fixed n_atoms, sites, r_max, bins, species });

#[cfg(test)]
mod tests;
