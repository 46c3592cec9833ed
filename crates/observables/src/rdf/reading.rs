//! What is read off counts of pairs by distance: g(r), its peaks, and neighbors.

use crate::{Findings, Table, statistics};

use crate::averages::of_blocks;
use crate::blocks::BlockedSums;
use crate::extrema::{Extremum, extrema, fitted_extremum, smoothed};

/// A peak of g(r) counts where the curve has come down from it by this much, and by four standard errors.
const SMALLEST_PROMINENCE: f64 = 0.02;

/// Standard errors that a peak must stand out by.
const PROMINENCE_SIGMAS: f64 = 4.0;

/// A cubic is fitted to g(r) within this distance (σ) of its first peak, and of its first minimum. The minimum is flat: its
/// lowest bin wanders by a tenth of σ from run to run.
const PEAK_HALF_WIDTH: f64 = 0.1;
const MINIMUM_HALF_WIDTH: f64 = 0.25;

/// Where the first peak of a fluid with σ = 1 lies. Particles that are smaller have narrower peaks, nearer by.
const USUAL_PEAK: f64 = 1.1;

/// g(r) is averaged over this distance (σ) on both sides before its extrema are looked for.
const SMOOTHING: f64 = 0.05;

/// The first minimum lies this far (σ) beyond the first peak.
const MINIMUM_BEYOND_PEAK: std::ops::Range<f64> = 0.2..0.9;

/// A fit that reaches less than this part of the highest bin does not describe the peak.
const SHARPEST_FITTED: f64 = 0.8;

/// Where g(r) does not fall below this after its first peak there is no shell of neighbors to be counted: a gas has none.
const SHELL_BELOW: f64 = 0.9;

/// How counts of pairs in bins of equal width become g(r) and numbers of neighbors.
pub(super) struct Reading {
    radii: Vec<f64>,
    width: f64,
    /// What the mean count of each bin, weighted by the volume of its sample, is multiplied by to give g.
    pub(super) normalisation: Vec<f64>,
    /// Volume of the shell of each bin, σ³.
    shells: Vec<f64>,
    /// The mean volume in first volumes: the mean weight of a sample.
    volume: f64,
    /// What the names of results end with, and neighbors of a particle for each pair in the box.
    neighbors: Vec<(String, f64)>,
    /// The end of the names of peaks: empty for all pairs.
    suffix: String,
    /// Whether peaks are fitted over a distance that shrinks with their place.
    narrow: bool,
}

impl Reading {
    /// g = `scale`·(mean count)/(`ordered`·volume of the shell), where `ordered` is the number of ordered pairs in the box.
    pub(super) fn new(radii: Vec<f64>, width: f64, scale: f64, ordered: f64, volume: f64) -> Self {
        let of_bin = |k: usize| {
            let (inner, outer) = (k as f64 * width, (k + 1) as f64 * width);
            4.0 / 3.0 * std::f64::consts::PI * (outer.powi(3) - inner.powi(3))
        };
        let shells: Vec<f64> = (0..radii.len()).map(of_bin).collect();
        let normalisation = shells.iter().map(|shell| scale / (ordered * shell));
        Self {
            normalisation: normalisation.collect(),
            shells,
            radii,
            width,
            volume,
            neighbors: Vec::new(),
            suffix: String::new(),
            narrow: false,
        }
    }

    /// Results are named after a pair of species.
    pub(super) fn named(mut self, suffix: String) -> Self {
        self.suffix = suffix;
        self.narrow = true;
        self
    }

    /// Also counts neighbors, `per_pair` of each particle for each pair.
    pub(super) fn add_neighbors(&mut self, suffix: &str, per_pair: f64) {
        self.neighbors.push((suffix.to_owned(), per_pair / self.volume));
    }

    /// The kinds of neighbors that are counted, by the end of their name.
    pub(super) fn neighbors(&self) -> impl Iterator<Item = (usize, &str)> {
        let all = self.neighbors.iter().enumerate();
        all.map(|(which, (suffix, _))| (which, suffix.as_str()))
    }

    /// g(r) in each bin with its standard error.
    pub(super) fn distribution(&self, counts: &BlockedSums) -> (Vec<f64>, Vec<f64>) {
        let factors = self.normalisation.iter().enumerate();
        factors
            .map(|(k, factor)| {
                let mean = counts.mean(k).unwrap_or(f64::NAN);
                (mean * factor, counts.standard_error(k) * factor)
            })
            .unzip()
    }

    /// Mean number of neighbors of one kind up to the outer edge of each bin.
    pub(super) fn running(&self, counts: &BlockedSums, which: usize) -> Vec<f64> {
        let factor = self.neighbors[which].1;
        (0..self.radii.len())
            .scan(0.0, |sum, k| {
                *sum += counts.mean(k).unwrap_or(f64::NAN) * factor;
                Some(*sum)
            })
            .collect()
    }

    /// Mean number of neighbors within `r` for one neighbor a pair, from the mean pair counts of the bins.
    fn pairs_within(&self, r: f64, pairs: &[f64]) -> f64 {
        let bins = r / self.width;
        let whole = (bins.floor() as usize).min(pairs.len());
        let inner: f64 = pairs[..whole].iter().sum();
        let last = pairs.get(whole).map_or(0.0, |p| p * bins.fract());
        inner + last
    }

    fn distribution_from(&self, pairs: &[f64]) -> Vec<f64> {
        let both = pairs.iter().zip(&self.normalisation);
        both.map(|(p, factor)| p * factor).collect()
    }

    /// −2πρ ∫ (g·ln g − g + 1) r² dr up to the last bin, k_B, with its pseudo-values block by block. `density` is ρ, σ⁻³.
    ///
    /// Noise of g lowers it by a term of second order, which the mean of the pseudo-values lacks.
    pub(super) fn two_body_entropy(
        &self,
        counts: &BlockedSums,
        density: f64,
    ) -> Option<(f64, Vec<f64>)> {
        let of_bin = |(g, shell): (f64, &f64)| {
            let ordered = if g > 0.0 { g * g.ln() } else { 0.0 };
            (ordered - g + 1.0) * shell
        };
        let entropy = |pairs: &[f64]| {
            let bins = self.distribution_from(pairs).into_iter().zip(&self.shells);
            Some(-0.5 * density * bins.map(of_bin).sum::<f64>())
        };
        let (whole, blocks) = counts.jackknife(entropy)?;
        let value = if blocks.is_empty() { whole } else { statistics::mean(&blocks) };
        Some((value, blocks))
    }

    fn half_width(&self, extremum: &Extremum) -> f64 {
        match (extremum.maximum, self.narrow) {
            (true, true) => PEAK_HALF_WIDTH * (extremum.place / USUAL_PEAK).min(1.0),
            (true, false) => PEAK_HALF_WIDTH,
            (false, _) => MINIMUM_HALF_WIDTH,
        }
    }

    /// The extremum near `start` as a function of the mean pair counts: (place, height). The peaks of a crystal at rest are
    /// narrower than any fit, and stay where they are.
    fn extremum(&self, g: &[f64], start: &Extremum) -> impl Fn(&[f64]) -> (f64, f64) {
        let (bin, place, maximum) = (start.bin, start.place, start.maximum);
        let half_width = self.half_width(start);
        let from = move |g: &[f64], start: f64| {
            fitted_extremum(&self.radii, g, start, half_width, maximum)
        };
        // All start from where the whole run has it, and end where their own data have it.
        let describes = |height: f64| !maximum || height > SHARPEST_FITTED * g[bin];
        let whole = from(g, place).filter(|(_, height)| describes(*height)).map(|(place, _)| place);
        move |pairs| {
            let g = self.distribution_from(pairs);
            whole.and_then(|start| from(&g, start)).unwrap_or((place, g[bin]))
        }
    }

    /// The same extremum at its sharpest: a peak is averaged only to be found.
    fn sharpest(&self, found: &Extremum, g: &[f64]) -> Extremum {
        if !found.maximum {
            return *found;
        }
        let near = |k: &usize| (self.radii[*k] - found.place).abs() <= SMOOTHING.max(self.width);
        let bin = (0..self.radii.len())
            .filter(near)
            .max_by(|&a, &b| g[a].total_cmp(&g[b]))
            .unwrap_or(found.bin);
        Extremum { bin, place: self.radii[bin], ..*found }
    }

    /// Where the first minimum after a peak is looked for; `None` where there is no shell of neighbors.
    fn first_minimum(&self, smooth: &[f64], peak: f64) -> Option<Extremum> {
        let (radii, bins) = (&self.radii, self.radii.len());
        let within = |r: f64| MINIMUM_BEYOND_PEAK.contains(&(r - peak));
        let lowest =
            (0..bins).filter(|&k| within(radii[k])).map(|k| smooth[k]).min_by(f64::total_cmp)?;
        let first = (0..bins).find(|&k| within(radii[k]) && smooth[k] == lowest)?;
        // Between two shells of a crystal all bins are empty: the middle one stands for them.
        let as_low = smooth[first..].iter().take_while(|g| **g == lowest);
        let bin = first + as_low.count() / 2;
        // The lowest at the end of the range is none: the curve still falls there.
        let inside = bin + 1 < bins && within(radii[bin + 1]) && within(radii[bin - 1]);
        (inside && smooth[bin] < SHELL_BELOW).then(|| Extremum {
            maximum: false,
            bin,
            place: radii[bin],
            height: smooth[bin],
        })
    }

    /// Adds the peaks of g(r), and the neighbors up to the first minimum.
    pub(super) fn add_peaks(
        &self,
        counts: &BlockedSums,
        findings: &mut Findings,
        g: &[f64],
        error: &[f64],
    ) {
        let (radii, suffix) = (&self.radii, &self.suffix);
        let smooth = smoothed(radii, g, SMOOTHING.max(0.5 * self.width));
        let found: Vec<Extremum> = extrema(radii, &smooth, |k| {
            let noise = if error[k].is_nan() { 0.0 } else { error[k] };
            SMALLEST_PROMINENCE.max(PROMINENCE_SIGMAS * noise)
        })
        .iter()
        .map(|e| self.sharpest(e, g))
        .collect();
        let [means, _] = counts.curve(0..radii.len(), 1.0);
        let (places, heights) = found.iter().map(|e| self.extremum(g, e)(&means)).unzip();
        let kinds = found.iter().map(|e| if e.maximum { 1.0 } else { -1.0 });
        findings.tables.push(
            Table::new(
                format!("rdf_peaks{suffix}"),
                format!(
                    "maxima (kind 1) and minima (kind −1) of g{suffix}(r), from cubics fitted around them"
                ),
            )
            .with("kind", "", kinds.collect())
            .with("r", "σ", places)
            .with("g", "", heights),
        );
        let Some(top) = found.iter().find(|e| e.maximum) else {
            findings.remark(format!("g{suffix}(r) has no peak"));
            return;
        };
        let peak_of = self.extremum(g, top);
        if let Some((height, blocks)) = counts.jackknife(|pairs| Some(peak_of(pairs).1)) {
            let name = format!("rdf_first_peak{suffix}");
            findings.averages.push(of_blocks(&name, "", height, &blocks, 0.0));
        }
        let Some(minimum) = self.first_minimum(&smooth, top.place) else {
            findings.remark(format!(
                "g{suffix}(r) does not fall below {SHELL_BELOW} after its first peak: no shell, no coordination number"
            ));
            return;
        };
        let minimum_of = self.extremum(g, &minimum);
        for (suffix, per_pair) in &self.neighbors {
            let number =
                |pairs: &[f64]| Some(per_pair * self.pairs_within(minimum_of(pairs).0, pairs));
            if let Some((number, blocks)) = counts.jackknife(number) {
                let name = format!("coordination_number{suffix}");
                findings.averages.push(of_blocks(&name, "", number, &blocks, 0.0));
            }
        }
        findings.remark(format!(
            "first peak of g{suffix}(r) at {:.3} σ, coordination number up to the first minimum at {:.3} σ",
            peak_of(&means).0,
            minimum_of(&means).0
        ));
    }
}
