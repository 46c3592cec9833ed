//! Kirkwood–Buff integrals by two routes.

mod integral;
mod routes;
mod tables;

use crate::{BuildContext, Findings, Observable, ObservableError, ObservableSpec, recipe};
use lennard_core::{SpeciesTable, View, persist};

use crate::averages::{of_blocks, tell_discarded, with_choice};
use crate::blocks::BlockedSums;
use crate::error::{within, within_box};
use crate::pairs::{count_distances, count_distances_by_species};
use crate::seen_box::SeenBox;
use crate::species_pairs::SpeciesPair;
use crate::wave_vectors::WaveVectors;

const SPEC: ObservableSpec = ObservableSpec {
    name: "kirkwood-buff",
    summary: "Kirkwood–Buff integrals of the species from g(r) and from S(k → 0), with thermodynamic factor and compressibility",
    equation: "G_ab = ∫ (g_ab − 1) 4πr² dr = [S_ab(0) − δ_ab]/(ρ √(x_a x_b))",
    source: "J. G. Kirkwood and F. P. Buff, J. Chem. Phys. 19, 774 (1951); weight for finite range: P. Krüger and \
             T. J. H. Vlugt, Phys. Rev. E 97, 051301 (2018); fixed numbers: P. Ganguly and N. F. A. van der Vegt, \
             J. Chem. Theory Comput. 9, 1347 (2013)",
    suits: crate::Suits::Atoms,
    every: 100,
    surroundings: crate::Surroundings::Periodic,
    alone: Some("looks at pairs up to half the box"),
    ..ObservableSpec::PLAIN
};

/// The integral from a range shorter by this part must agree with the integral over the whole range.
const SHORTER: f64 = 0.85;

lennard_core::options! {
    /// Options of [`KirkwoodBuff`].
    pub struct KirkwoodBuffOptions {
        /// Largest distance of the integral.
        r_max: Option<f64> = None, else "half the shortest side", Words("a number above 0, at most half the shortest box side"), in "σ";
        /// Number of bins of equal width.
        bins: usize = 250, Whole(20, 100_000);
        /// Number of smallest wave numbers from which S(k) is carried to k = 0 by a line in k².
        shells: usize = 4, Whole(3, 100);
    }
}

recipe!(KirkwoodBuffOptions, |options, context| KirkwoodBuff::new(options, context)?);

/// The integrals G_ab of Kirkwood and Buff, in σ³. A particle of species a has ρ_b·G_ab particles of species b around it in excess
/// of the mean.
///
/// **From g(r).** g_ab is taken relative to the density that is left outside r in a box with fixed numbers. Its integral has a
/// weight that stands for the range beyond. The mean over ab and ba is told.
///
/// **From S(k).** S_ab(k) of the smallest wave numbers is carried to k = 0 by a line in k², and
/// G_ab = [S_ab(0) − δ_ab]/(ρ√(x_a·x_b)).
///
/// With two species the thermodynamic factor follows, Γ = 1/[1 + ρx_a·x_b·(G_aa + G_bb − 2G_ab)], and the isothermal
/// compressibility from
///
/// ρTκ = Γ·[1 + ρ(x_a·G_aa + x_b·G_bb) + ρ²x_a·x_b·(G_aa·G_bb − G_ab²)].
///
/// One species has ρTκ = 1 + ρG. Both routes must agree, and the integral must be the same over a range shorter by 15 %.
#[derive(Debug, Clone, PartialEq)]
pub struct KirkwoodBuff {
    seen: SeenBox,
    species: SpeciesTable,
    r_max: f64,
    bins: usize,
    pairs: Vec<SpeciesPair>,
    /// Pairs of particles in each bin, pair of species after pair of species, weighted by the volume of the sample.
    counts: BlockedSums,
    vectors: WaveVectors,
    /// S_ab in each shell of wave numbers, pair of species after pair of species.
    factors: BlockedSums,
    temperature: BlockedSums,
}

impl KirkwoodBuff {
    /// Nothing seen yet.
    ///
    /// # Errors
    /// [`ObservableError`] where `r_max` is beyond half the shortest side, or a number is out of range.
    pub fn new(
        options: &KirkwoodBuffOptions,
        context: &BuildContext,
    ) -> Result<Self, ObservableError> {
        within_box("r_max", options.r_max, &context.cell)?;
        let r_max = options.r_max.unwrap_or(context.cell.largest_cutoff());
        within("bins", options.bins, 20..=100_000)?;
        within("shells", options.shells, 3..=100)?;
        let vectors = WaveVectors::smallest(context.cell.lengths(), options.shells);
        let pairs: Vec<SpeciesPair> = SpeciesPair::all(&context.species).collect();
        Ok(Self {
            seen: SeenBox::new(&context.cell),
            species: context.species.clone(),
            r_max,
            bins: options.bins,
            counts: BlockedSums::new(pairs.len() * options.bins),
            factors: BlockedSums::new(pairs.len() * vectors.shells()),
            temperature: BlockedSums::new(1),
            pairs,
            vectors,
        })
    }

    fn width(&self) -> f64 {
        self.r_max / self.bins as f64
    }

    fn density(&self) -> f64 {
        self.species.n_particles() as f64 / self.seen.volume()
    }

    /// What names of results of a pair end with: nothing where there is one species.
    fn suffix(&self, pair: SpeciesPair) -> String {
        match self.species.is_mixture() {
            true => pair.suffix(&self.species),
            false => String::new(),
        }
    }

    /// The bins inside half of the shortest side that any sample had: in a box that changes, pairs farther apart are not all
    /// counted.
    fn bins_inside(&self) -> usize {
        let bins = (self.seen.half_shortest() / self.width() * (1.0 + 1e-9)) as usize;
        bins.min(self.bins)
    }
}

impl Observable for KirkwoodBuff {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let (cell, own, positions) = (view.cell(), view.system.own(), &view.state.positions);
        self.seen.see(cell);
        let all = count_distances(positions, cell, self.r_max, self.bins);
        let found = match self.species.is_mixture() {
            true => {
                count_distances_by_species(&self.species, own, positions, cell, self.r_max, &all)
            }
            false => vec![all],
        };
        let weight = cell.volume() / self.seen.first_volume();
        self.counts.add_sample(found.iter().flatten().map(|pairs| weight * *pairs as f64));
        let densities = self.vectors.densities_by_species(own, &self.species, positions, cell);
        self.factors.begin_sample();
        for (p, SpeciesPair { a, b }) in self.pairs.iter().enumerate() {
            let (n_a, n_b) = (self.species.count(*a) as f64, self.species.count(*b) as f64);
            for (k, vector) in self.vectors.iter().enumerate() {
                let product = densities[*a][k].dot(densities[*b][k]);
                let place = p * self.vectors.shells() + vector.shell;
                self.factors.add(place, product / (n_a * n_b).sqrt(), 1);
            }
        }
        self.temperature.add_sample([view.temperature()]);
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        let (counts, factors) = (self.counts.after(discarded), self.factors.after(discarded));
        let temperature = self.temperature.after(discarded).mean(0);
        let Some(temperature) = temperature.filter(|_| counts.samples() > 0) else {
            return findings;
        };
        let (bins, shells) = (self.bins_inside(), self.vectors.shells());
        let shorter = (SHORTER * bins as f64) as usize;
        let by_distance = self.route(&counts, |means| self.of_counts(means, bins));
        let by_less = self.route(&counts, |means| self.of_counts(means, shorter));
        let by_waves = self.route(&factors, |means| self.of_factors(means, shells));
        let by_fewer = self.route(&factors, |means| self.of_factors(means, shells.div_ceil(2)));
        let routes = [("", &by_distance, &by_less), ("_structure", &by_waves, &by_fewer)];
        let last = by_distance.len() - 1;
        for (route, found, otherwise) in routes {
            for (k, (name, unit)) in self.names(route).iter().enumerate() {
                let (value, blocks) = &found[k];
                if value.is_nan() {
                    continue;
                }
                // The last number is ρTκ.
                let unit_of_k = if k == last { 1.0 / (self.density() * temperature) } else { 1.0 };
                let blocks: Vec<f64> = blocks.iter().map(|b| unit_of_k * b).collect();
                let average = of_blocks(name, unit, unit_of_k * value, &blocks, 0.0);
                let change = unit_of_k * (otherwise[k].0 - value);
                let doubt = Self::doubt(k, &by_distance, &by_less, &by_waves);
                findings.averages.push(with_choice(average, change).doubted(doubt));
            }
        }
        tell_discarded(&mut findings, self.counts.samples() - counts.samples());
        let reach = bins as f64 * self.width();
        findings.remark(format!(
            "Kirkwood–Buff integrals over g(r) up to {reach:.3} σ, with a weight for the range beyond; \
             the names with _structure are from S(k) at the {shells} smallest wave numbers, by a line in k² to k = 0"
        ));
        if self.species.n_species() > 2 {
            findings.remark(
                "thermodynamic_factor and compressibility_kirkwood_buff are for one or two species",
            );
        }
        findings.tables.push(self.running(&counts, bins));
        findings.tables.push(self.factors_table(&factors));
        findings
    }
}

persist!(KirkwoodBuff {
    seen as "box",
    counts,
    factors,
    temperature,
    fixed species, r_max, bins, pairs, vectors
});

#[cfg(test)]
mod tests;
