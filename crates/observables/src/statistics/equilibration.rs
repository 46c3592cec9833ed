//! Where the equilibrated part of a series begins, and whether it has one.

use super::error_of_mean::spectrum_with;
use super::mean;

/// At most this part of a series is discarded: what is left must be able to speak for itself.
pub const LARGEST_CUT: f64 = 0.6;

/// A transient counts where its height, at any of seven decay times, exceeds this many standard errors. By chance, about
/// 1 stationary series in 100 exceeds it, whatever its correlation (the study `studies/coverage` publishes the rates).
pub const TRANSIENT_ERRORS: f64 = 3.5;

/// After a cut the bar is this much higher: each look at a rest is one more chance to be misled.
const AFTER_A_CUT: f64 = 1.0;

/// The bar for a series that is one of many of the same run: 1 in 1000 passes it by chance.
pub const TRANSIENT_OF_MANY_ERRORS: f64 = 5.0;

/// Decay times that are tried, in lengths of the series. The longest differs from a straight line by 2 %.
const DECAY_TIMES: [f64; 7] = [0.02, 0.05, 0.1, 0.2, 0.4, 1.0, 3.0];

/// What is left of a transient may bias the mean by this part of its standard error.
const LARGEST_BIAS: f64 = 0.25;

/// Degrees of freedom of the noise that a transient is held against.
const FREEDOM: f64 = 16.0;

/// Detection works on at most this many block means of the series.
const MOST_BLOCKS: usize = 512;

/// Shorter series are not cut: their correlation looks like a trend.
const SHORTEST: usize = 32;

/// Cuts that are tried after a transient, in parts of what is left.
const CUT_STEP: f64 = 0.02;

/// A series that still changes at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trend {
    /// Mean of the first third.
    pub first: f64,
    /// Mean of the last third.
    pub last: f64,
    /// Height of the fitted transient in its standard errors.
    pub errors: f64,
}

/// Where a series is in equilibrium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equilibration {
    /// Samples to discard at the start.
    pub cut: usize,
    /// What still changes after that; `None` where nothing does.
    pub trend: Option<Trend>,
}

/// An exponential a·e^{−t/(rT)} about a constant, fitted to a series of length T.
struct Transient {
    height: f64,
    /// r.
    decay: f64,
    /// |a| in its standard errors.
    errors: f64,
    /// Spectrum at zero of what is left of the series without it.
    noise: f64,
}

/// Finds the part to discard at the start of a series, and tells whether the rest still changes.
///
/// A constant and an exponential of each of seven decay times are fitted by least squares. The exponential counts where
/// its height passes [`TRANSIENT_ERRORS`] standard errors. The noise is what the fit leaves: a trend must not hide behind
/// an error that the trend has made large. The cut is where the rest of the exponential biases the mean by less than a
/// fourth of its standard error. The series behind the cut is then tested again. Where that cut would be beyond
/// [`LARGEST_CUT`], the run is too short for its own relaxation: nothing is cut, and the trend is reported.
///
/// The search for the largest n_eff (J. D. Chodera, J. Chem. Theory Comput. 12, 1799 (2016)), which this replaces, cuts
/// nothing where a transient fills the run.
#[must_use]
pub fn equilibration(series: &[f64]) -> Equilibration {
    let whole = Equilibration { cut: 0, trend: None };
    if series.len() < SHORTEST || !mean(series).is_finite() {
        return whole;
    }
    let per_block = series.len().div_ceil(MOST_BLOCKS);
    let blocks: Vec<f64> = series.chunks_exact(per_block).map(mean).collect();
    let most = (LARGEST_CUT * blocks.len() as f64) as usize;
    let mut start = 0;
    while let Some(transient) = transient(&blocks[start..], bar(start)) {
        let rest = blocks.len() - start;
        match transient.harmless_after(rest).map(|cut| start + cut) {
            Some(cut) if cut <= most && blocks.len() - cut >= SHORTEST => start = cut,
            _ => {
                return Equilibration {
                    cut: start * per_block,
                    trend: Some(thirds(&blocks[start..], transient.errors)),
                };
            }
        }
    }
    Equilibration { cut: start * per_block, ..whole }
}

/// The bar for what is left after a cut of so many samples, in standard errors.
#[must_use]
pub fn bar(cut: usize) -> f64 {
    TRANSIENT_ERRORS + if cut > 0 { AFTER_A_CUT } else { 0.0 }
}

/// Whether a series changes from its beginning to its end by more than chance: the test of [`equilibration`], with the
/// bar `errors`, and no cut.
#[must_use]
pub fn trend(series: &[f64], errors: f64) -> Option<Trend> {
    if series.len() < SHORTEST || !mean(series).is_finite() {
        return None;
    }
    let per_block = series.len().div_ceil(MOST_BLOCKS);
    let blocks: Vec<f64> = series.chunks_exact(per_block).map(mean).collect();
    transient(&blocks, errors).map(|found| thirds(&blocks, found.errors))
}

fn thirds(blocks: &[f64], errors: f64) -> Trend {
    let third = blocks.len() / 3;
    Trend { first: mean(&blocks[..third]), last: mean(&blocks[blocks.len() - third..]), errors }
}

/// The most significant transient, if it passes the bar.
fn transient(blocks: &[f64], bar: f64) -> Option<Transient> {
    let n = blocks.len();
    let centre = mean(blocks);
    let mut best: Option<Transient> = None;
    for decay in DECAY_TIMES {
        if decay * (n as f64) < 2.0 {
            continue;
        }
        let shape: Vec<f64> =
            (0..n).map(|i| (-(i as f64 + 0.5) / n as f64 / decay).exp()).collect();
        let level = mean(&shape);
        let (mut squares, mut products) = (0.0, 0.0);
        for (f, y) in shape.iter().zip(blocks) {
            squares += (f - level).powi(2);
            products += (f - level) * (y - centre);
        }
        let height = products / squares;
        let rest: Vec<f64> =
            shape.iter().zip(blocks).map(|(f, y)| y - height * (f - level)).collect();
        // The fit takes about half a degree of freedom of each of two parameters off the lowest frequencies.
        let noise = spectrum_with(&rest, FREEDOM) / (1.0 - 1.0 / FREEDOM);
        let errors = height.abs() / (noise / squares).sqrt();
        if best.as_ref().is_none_or(|b| errors > b.errors) {
            best = Some(Transient { height, decay, errors, noise });
        }
    }
    best.filter(|found| found.errors > bar)
}

impl Transient {
    /// Blocks of `n` after which the rest of it biases the mean by less than a fourth of the standard error.
    fn harmless_after(&self, n: usize) -> Option<usize> {
        let n = n as f64;
        let parts = (1..).map(|k| f64::from(k) * CUT_STEP);
        let cut = parts.take_while(|cut| *cut < 1.0).find(|cut| {
            let kept = 1.0 - cut;
            let tail = (-cut / self.decay).exp() * (1.0 - (-kept / self.decay).exp());
            let bias = self.height.abs() * self.decay / kept * tail;
            bias < LARGEST_BIAS * (self.noise / (kept * n)).sqrt()
        })?;
        Some((cut * n).ceil() as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{Ar1, printed_and_spread};
    use super::super::{estimate, mean};
    use super::*;

    /// A process of `independent` independent samples among 2000, with a transient of `height` standard deviations and a
    /// decay time of `decay` runs.
    fn relaxing(independent: f64, height: f64, decay: f64, seed: u64) -> Vec<f64> {
        let n = 2000;
        let phi = (-2.0 * independent / f64::from(n)).exp();
        let mut series = Ar1::new(phi, seed).series(n as usize);
        for (i, x) in series.iter_mut().enumerate() {
            *x += height * (-(i as f64) / (decay * f64::from(n))).exp();
        }
        series
    }

    #[test]
    fn of_200_runs_that_still_relax_at_their_end_190_say_so() {
        let mut seed = 0;
        let mut silent = Vec::new();
        for independent in [100.0, 500.0] {
            for height in [-5.0, 10.0] {
                for decay in [0.3, 0.5, 1.0, 2.0] {
                    for _ in 0..13 {
                        seed += 1;
                        let series = relaxing(independent, height, decay, seed);
                        if equilibration(&series).trend.is_none() {
                            silent.push((independent, height, decay));
                        }
                    }
                }
            }
        }
        // 208 runs.
        assert!(silent.len() <= 10, "{} silent: {silent:?}", silent.len());
    }

    #[test]
    fn of_200_stationary_runs_at_most_10_complain_and_hardly_one_is_cut() {
        for independent in [50.0, 500.0] {
            let found: Vec<Equilibration> = (0..200)
                .map(|seed| equilibration(&relaxing(independent, 0.0, 1.0, 5000 + seed)))
                .collect();
            let complaints = found.iter().filter(|e| e.trend.is_some()).count();
            let cut = found.iter().filter(|e| e.cut > 0).count();
            assert!(complaints <= 10 && cut <= 10, "{complaints} {cut}");
        }
    }

    #[test]
    fn a_transient_that_is_over_is_cut_and_its_bias_gone() {
        let found: Vec<_> =
            (0..100).map(|seed| estimate(&relaxing(500.0, 8.0, 0.08, seed))).collect();
        let cuts: Vec<f64> = found.iter().map(|e| e.equilibration_cut as f64).collect();
        // The bias falls below a fourth of the error (0.25/√300) after some five decay times of 160 samples.
        assert!((600.0..1100.0).contains(&mean(&cuts)), "{}", mean(&cuts));
        let off: Vec<f64> = found.iter().map(|e| e.mean / e.standard_error).collect();
        // 100 seeds know the mean to a tenth of an error.
        assert!(mean(&off).abs() < 0.5, "{}", mean(&off));
        let within = off.iter().filter(|z| z.abs() < 2.0).count();
        assert!(within >= 86, "{within}");
    }

    #[test]
    fn a_stationary_series_keeps_its_error() {
        for phi in [0.0_f64, 0.9] {
            let found: Vec<_> =
                (0..400).map(|seed| estimate(&Ar1::new(phi, 1000 + seed).series(2000))).collect();
            // 400 seeds know the spread to 3.5 %. Errors of independent samples are 6 % too large, since they are never below their own.
            let (_, ratio) = printed_and_spread(&found);
            assert!((0.82..1.12).contains(&ratio), "φ = {phi}: {ratio}");
        }
    }

    #[test]
    fn constant_and_short_series_are_not_cut() {
        for series in [&[1.0; 1000][..], &[9.0, 1.0, 1.0, 1.0], &[]] {
            let found = equilibration(series);
            assert_eq!((found.cut, found.trend), (0, None));
        }
    }

    #[test]
    fn a_step_half_way_is_no_equilibrium() {
        let mut series = relaxing(500.0, 0.0, 1.0, 3);
        series[1300..].iter_mut().for_each(|x| *x -= 5.0);
        let trend = equilibration(&series).trend.expect("it changes");
        assert!(trend.first - trend.last > 4.0, "{trend:?}");
    }
}
