//! The radial distribution function.

use lennard_core::{
    Findings, Observable, ObservableSpec, Persist, RestoreError, StateReader, StateWriter, Table,
    View, Want,
};

use crate::averages::{of_blocks, tell_discarded};
use crate::blocks::BlockedSums;
use crate::error::{positive, within};
use crate::extrema::{Extremum, extrema, fitted_extremum, smoothed};
use crate::pairs::{count_distances, count_distances_inside};
use crate::seen_box::SeenBox;
use crate::{BuildContext, ObservableError, Recipe, Surroundings};

const SPEC: ObservableSpec = ObservableSpec {
    name: "rdf",
    summary: "radial distribution function g(r), its peaks, and the coordination number",
    equation: "g(r) = V/(N(N−1)) · ⟨Σ_{i≠j} δ(r − r_ij)⟩/(4πr²); n(r) = (N−1)/V ∫₀^r g 4πs² ds",
    source: "J.-P. Hansen and I. R. McDonald, Theory of Simple Liquids, 4th ed. (2013), equations 2.5.8 and 2.5.13",
    dynamic: false,
    suits: lennard_core::Suits::All,
};

/// Largest distance where the scene gives none, in σ: liquid structure is gone there.
const DEFAULT_R_MAX: f64 = 6.0;

/// Blocks of histograms from which the errors come.
const BLOCKS: usize = 64;

/// A peak of g(r) counts where the curve has come down from it by this much, and by four standard errors.
const SMALLEST_PROMINENCE: f64 = 0.02;

/// Standard errors that a peak must stand out by.
const PROMINENCE_SIGMAS: f64 = 4.0;

/// A cubic is fitted to g(r) within this distance (σ) of its first peak, and of its first minimum. The minimum is flat: its
/// lowest bin wanders by a tenth of σ from run to run.
const PEAK_HALF_WIDTH: f64 = 0.1;
const MINIMUM_HALF_WIDTH: f64 = 0.25;

/// g(r) is averaged over this distance (σ) on both sides before its extrema are looked for.
const SMOOTHING: f64 = 0.05;

/// The first minimum lies this far (σ) beyond the first peak.
const MINIMUM_BEYOND_PEAK: std::ops::Range<f64> = 0.2..0.9;

/// A fit that reaches less than this part of the highest bin does not describe the peak.
const SHARPEST_FITTED: f64 = 0.8;

/// Where g(r) does not fall below this after its first peak there is no shell of neighbors to be counted: a gas has none.
const SHELL_BELOW: f64 = 0.9;

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

    fn default_every(&self) -> u64 {
        100
    }

    fn surroundings(&self) -> Surroundings {
        Surroundings::Periodic
    }

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
/// normalised by the number of *other* particles, N − 1: for an ideal gas of any N it is exactly 1. (With N in
/// place of N − 1, as some programs have it, it would be smaller by 1/N.) Of molecules, g is between sites of different
/// molecules, and N − 1 is the number of sites of the others. The error of each bin comes from
/// the scatter over successive blocks of the run.
///
/// The coordination number is n(r) at the first minimum of g after its first peak. Both are extrema of cubics fitted
/// around them, and their errors come from a jackknife over blocks of the run in which the extrema move along.
#[derive(Debug, Clone, PartialEq)]
pub struct RadialDistribution {
    seen: SeenBox,
    n_atoms: usize,
    /// Sites of each molecule; 1 for atoms.
    sites: usize,
    r_max: f64,
    bins: usize,
    counts: BlockedSums,
}

impl RadialDistribution {
    /// Nothing counted yet.
    ///
    /// # Errors
    /// [`ObservableError`] where `r_max` is beyond half the shortest side, or there are no bins.
    pub fn new(options: &RdfOptions, context: &BuildContext) -> Result<Self, ObservableError> {
        let largest = context.cell.largest_cutoff();
        positive("r_max", options.r_max)?;
        let r_max = options.r_max.unwrap_or(largest.min(DEFAULT_R_MAX));
        if r_max > largest {
            return Err(ObservableError::new(
                "r_max",
                r_max,
                format!("at most half the shortest side of the box, {largest}"),
            ));
        }
        within("bins", options.bins, 1..=100_000)?;
        Ok(Self {
            seen: SeenBox::new(&context.cell),
            n_atoms: context.n_atoms,
            sites: context.molecules.sites(),
            r_max,
            bins: options.bins,
            counts: BlockedSums::new(options.bins, BLOCKS),
        })
    }

    fn width(&self) -> f64 {
        self.r_max / self.bins as f64
    }

    /// The middles of the bins in σ.
    #[must_use]
    pub fn radii(&self) -> Vec<f64> {
        (0..self.bins)
            .map(|k| (k as f64 + 0.5) * self.width())
            .collect()
    }

    /// What a pair count in bin `k`, weighted by the volume of its sample, is multiplied by to give g.
    fn normalisation(&self, k: usize) -> f64 {
        let n = self.n_atoms as f64;
        let (inner, outer) = (k as f64 * self.width(), (k + 1) as f64 * self.width());
        let shell = 4.0 / 3.0 * std::f64::consts::PI * (outer.powi(3) - inner.powi(3));
        2.0 * self.seen.first_volume() / (n * (n - self.sites as f64) * shell)
    }

    /// g(r) in each bin with its standard error.
    #[must_use]
    pub fn distribution(&self) -> (Vec<f64>, Vec<f64>) {
        self.distribution_of(&self.counts)
    }

    fn distribution_of(&self, counts: &BlockedSums) -> (Vec<f64>, Vec<f64>) {
        (0..self.bins)
            .map(|k| {
                let factor = self.normalisation(k);
                let mean = counts.mean(k).unwrap_or(f64::NAN);
                (mean * factor, counts.standard_error(k) * factor)
            })
            .unzip()
    }

    /// Mean number of neighbors within `r`, from the mean pair counts of the bins.
    fn neighbors_within(&self, r: f64, pairs: &[f64]) -> f64 {
        let bins = r / self.width();
        let whole = (bins.floor() as usize).min(pairs.len());
        let inner: f64 = pairs[..whole].iter().sum();
        let last = pairs.get(whole).map_or(0.0, |p| p * bins.fract());
        self.neighbors_per_pair() * (inner + last)
    }

    /// Neighbors of a particle for each pair that is counted, with the mean weight of the samples taken off.
    fn neighbors_per_pair(&self) -> f64 {
        2.0 / self.n_atoms as f64 / (self.seen.volume() / self.seen.first_volume())
    }

    fn distribution_from(&self, pairs: &[f64]) -> Vec<f64> {
        let bins = pairs.iter().enumerate();
        bins.map(|(k, p)| p * self.normalisation(k)).collect()
    }

    /// The extremum near `start` as a function of the mean pair counts: (place, height). The peaks of a crystal at rest are
    /// narrower than any fit, and stay where they are.
    fn extremum(&self, g: &[f64], start: &Extremum) -> impl Fn(&[f64]) -> (f64, f64) {
        let radii = self.radii();
        let (bin, place, maximum) = (start.bin, start.place, start.maximum);
        let half_width = if maximum {
            PEAK_HALF_WIDTH
        } else {
            MINIMUM_HALF_WIDTH
        };
        let from = |g: &[f64], start: f64| fitted_extremum(&radii, g, start, half_width, maximum);
        // All start from where the whole run has it, and end where their own data have it.
        let describes = |height: f64| !maximum || height > SHARPEST_FITTED * g[bin];
        let whole = from(g, place)
            .filter(|(_, height)| describes(*height))
            .map(|(place, _)| place);
        let radii = self.radii();
        move |pairs| {
            let g = self.distribution_from(pairs);
            whole
                .and_then(|start| fitted_extremum(&radii, &g, start, half_width, maximum))
                .unwrap_or((place, g[bin]))
        }
    }

    /// The same extremum at its sharpest: a peak is averaged only to be found.
    fn sharpest(&self, found: &Extremum, g: &[f64]) -> Extremum {
        if !found.maximum {
            return *found;
        }
        let radii = self.radii();
        let near = |k: &usize| (radii[*k] - found.place).abs() <= SMOOTHING.max(self.width());
        let bin = (0..self.bins)
            .filter(near)
            .max_by(|&a, &b| g[a].total_cmp(&g[b]))
            .unwrap_or(found.bin);
        Extremum {
            bin,
            place: radii[bin],
            ..*found
        }
    }

    /// Where the first minimum after a peak is looked for; `None` where there is no shell of neighbors.
    fn first_minimum(&self, smooth: &[f64], peak: f64) -> Option<Extremum> {
        let radii = self.radii();
        let within = |r: f64| MINIMUM_BEYOND_PEAK.contains(&(r - peak));
        let lowest = (0..self.bins)
            .filter(|&k| within(radii[k]))
            .map(|k| smooth[k])
            .min_by(f64::total_cmp)?;
        let first = (0..self.bins).find(|&k| within(radii[k]) && smooth[k] == lowest)?;
        // Between two shells of a crystal all bins are empty: the middle one stands for them.
        let as_low = smooth[first..].iter().take_while(|g| **g == lowest);
        let bin = first + as_low.count() / 2;
        // The lowest at the end of the range is none: the curve still falls there.
        let inside = bin + 1 < self.bins && within(radii[bin + 1]) && within(radii[bin - 1]);
        (inside && smooth[bin] < SHELL_BELOW).then(|| Extremum {
            maximum: false,
            bin,
            place: radii[bin],
            height: smooth[bin],
        })
    }

    fn add_peaks(&self, counts: &BlockedSums, findings: &mut Findings, g: &[f64], error: &[f64]) {
        let radii = self.radii();
        let smooth = smoothed(&radii, g, SMOOTHING.max(0.5 * self.width()));
        let found: Vec<Extremum> = extrema(&radii, &smooth, |k| {
            let noise = if error[k].is_nan() { 0.0 } else { error[k] };
            SMALLEST_PROMINENCE.max(PROMINENCE_SIGMAS * noise)
        })
        .iter()
        .map(|e| self.sharpest(e, g))
        .collect();
        let means: Vec<f64> = (0..self.bins)
            .map(|k| counts.mean(k).unwrap_or(f64::NAN))
            .collect();
        let (places, heights) = found.iter().map(|e| self.extremum(g, e)(&means)).unzip();
        let kinds = found.iter().map(|e| if e.maximum { 1.0 } else { -1.0 });
        findings.tables.push(
            Table::new(
                "rdf_peaks",
                "maxima (kind 1) and minima (kind −1) of g(r), from cubics fitted around them",
            )
            .with("kind", "", kinds.collect())
            .with("r", "σ", places)
            .with("g", "", heights),
        );
        let Some(top) = found.iter().find(|e| e.maximum) else {
            findings.remarks.push("g(r) has no peak".into());
            return;
        };
        let peak_of = self.extremum(g, top);
        if let Some((height, blocks)) = counts.jackknife(|pairs| Some(peak_of(pairs).1)) {
            findings
                .averages
                .push(of_blocks("rdf_first_peak", "", height, &blocks, 0.0));
        }
        let Some(minimum) = self.first_minimum(&smooth, top.place) else {
            findings.remarks.push(format!(
                "g(r) does not fall below {SHELL_BELOW} after its first peak: no shell, no coordination number"
            ));
            return;
        };
        let minimum_of = self.extremum(g, &minimum);
        let number = |pairs: &[f64]| Some(self.neighbors_within(minimum_of(pairs).0, pairs));
        if let Some((number, blocks)) = counts.jackknife(number) {
            findings
                .averages
                .push(of_blocks("coordination_number", "", number, &blocks, 0.0));
        }
        findings.remarks.push(format!(
            "first peak of g(r) at {:.3} σ, coordination number up to the first minimum at {:.3} σ",
            peak_of(&means).0,
            minimum_of(&means).0
        ));
    }
}

impl Observable for RadialDistribution {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want::NOTHING
    }

    fn sample(&mut self, view: &View<'_>) {
        let cell = view.cell();
        self.seen.see(cell);
        let weight = cell.volume() / self.seen.first_volume();
        let positions = &view.state.positions;
        let mut found = count_distances(positions, cell, self.r_max, self.bins);
        if self.sites > 1 {
            let inside = count_distances_inside(self.sites, positions, cell, self.r_max, self.bins);
            for (all, inside) in found.iter_mut().zip(inside) {
                *all -= inside;
            }
        }
        self.counts.begin_sample();
        let (sums, counts) = self.counts.current();
        for ((sum, count), pairs) in sums.iter_mut().zip(counts).zip(found) {
            // In a box that stays, whole numbers below 2⁵³ add exactly.
            *sum += weight * pairs as f64;
            *count += 1;
        }
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        let counts = self.counts.after(discarded);
        if counts.samples() == 0 {
            return findings;
        }
        let (g, error) = self.distribution_of(&counts);
        let factor = self.neighbors_per_pair();
        let running: Vec<f64> = (0..self.bins)
            .scan(0.0, |sum, k| {
                *sum += counts.mean(k).unwrap_or(f64::NAN) * factor;
                Some(*sum)
            })
            .collect();
        self.add_peaks(&counts, &mut findings, &g, &error);
        tell_discarded(&mut findings, self.counts.samples() - counts.samples());
        let valid = self.seen.half_shortest();
        if valid < self.r_max {
            findings.remarks.push(format!(
                "g(r) counts up to half the box, which was {valid:.3} σ at its smallest: beyond, pairs are missing"
            ));
        }
        findings.tables.insert(
            0,
            Table::new(
                "rdf",
                format!(
                    "radial distribution function over {} configurations; r is the middle of the bin, coordination counts up to its outer edge",
                    counts.samples()
                ),
            )
            .with("r", "σ", self.radii())
            .with("g", "", g)
            .with("standard_error", "", error)
            .with("coordination", "", running),
        );
        findings
            .remarks
            .push("g(r) is normalised by N − 1: exactly 1 for an ideal gas".into());
        findings
    }
}

impl Persist for RadialDistribution {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.counts.save(&mut to.section("counts"));
        self.seen.save(&mut to.section("box"));
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.counts.restore(&from.section("counts"))?;
        self.seen.restore(&from.section("box"))
    }
}

#[cfg(test)]
mod tests;
