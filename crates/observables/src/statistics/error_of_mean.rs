//! The standard error of the mean of a correlated series, and how well that error is itself known.

use super::{mean, variance};

/// The mean of a series knows itself to this error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorOfMean {
    /// Standard error of the mean; NaN for fewer than [`FEWEST_BLOCKS`] samples, 0 for a constant series.
    pub standard_error: f64,
    /// Independent samples that the series is worth, n·σ²/v: the number n of samples at most.
    pub n_effective: f64,
    /// The same by the widest window, where that has less.
    pub least_effective: f64,
    /// Degrees of freedom ν of the error: it is known to 1/√(2ν) of its value.
    pub freedom: f64,
}

/// The fewest samples or blocks that give an error.
pub const FEWEST_BLOCKS: usize = 4;

/// Longer series are first averaged in blocks, which leaves the error of the mean as it is.
const MOST_BLOCKS: usize = 2048;

/// Degrees of freedom of the windows, from the widest window to the narrowest. The widest reaches correlations of a
/// twentieth of the series; narrower ones know the error better where nothing is left to be reached.
const FREEDOMS: [f64; 4] = [8.0, 16.0, 32.0, 64.0];

/// A narrower window is taken where every wider window agrees with it. The variance of the wider window may be higher by the
/// first number of standard deviations of their difference, and lower by the second. The first number is smaller because
/// errors that are too small do more harm.
const AGREEMENT: [f64; 2] = [1.2, 2.5];

/// Windows with fewer degrees of freedom do not speak against a narrower window that is higher. Their variance is often low
/// by chance: of independent samples, one mean in 25 had less than 0.55 of its error when they did.
const FEWEST_TO_LOWER: f64 = 16.0;

/// The flat-top window can give a small or negative value where samples are anticorrelated. The value is therefore raised to
/// this part of its standard deviation at least. The standard deviation is taken from Bartlett's window, whose spectrum is
/// never negative.
const LOWEST_PART: f64 = 0.5;

/// Estimates the standard error of the mean of a correlated series.
///
/// The squared error is v/n, with v = Σ_t ρ-weighted covariances γ(t): the spectrum of the series at frequency zero. The
/// window k(t) is flat up to half its width and falls to zero at its whole width (a flat-top window). Correlations
/// shorter than the flat part therefore count in full. A window of width b over n samples leaves ν = 3n/(4b) degrees of
/// freedom. Taking the mean off the samples makes v too small by Σk/n, which is put back.
///
/// Four widths are tried, from n/11 (ν = 8) to n/85 (ν = 64). The narrowest one with which all wider ones agree is taken.
/// A slow part of small amplitude, which an estimate of the correlation function loses in its noise, shows in the
/// widest windows.
///
/// The error is never smaller than the error of independent samples. Anticorrelation over short times often hides a correlation that falls as 1/t
/// and lasts longer than the widest window. Hits of a thin gas on a thermal wall are such a series: a slow particle
/// comes back after any time.
///
/// The error is widened by the factor 1 + 5/(4ν) + 49/(32ν²), the first terms of Cornish and Fisher. Two
/// errors then cover as much of Student's t with ν degrees of freedom as two standard deviations cover of a normal
/// distribution.
///
/// Sources: D. N. Politis and J. P. Romano, "Bias-corrected nonparametric spectral estimation", J. Time Ser. Anal. 16, 67
/// (1995), for the window; M. B. Priestley, Spectral Analysis and Time Series (1981), section 6.2.4, for ν.
#[must_use]
pub fn error_of_mean(series: &[f64]) -> ErrorOfMean {
    error_with_overlap(series, 0.0)
}

/// As [`error_of_mean`], for values that each look `overlap` places ahead and so are correlated that far. No window is
/// narrower than one and a half overlaps.
#[must_use]
pub fn error_with_overlap(series: &[f64], overlap: f64) -> ErrorOfMean {
    let n = series.len();
    let no_error = |freedom| ErrorOfMean {
        standard_error: f64::NAN,
        n_effective: n as f64,
        least_effective: n as f64,
        freedom,
    };
    if n < FEWEST_BLOCKS || !mean(series).is_finite() {
        return no_error(0.0);
    }
    let of_samples = variance(series);
    if of_samples <= 0.0 {
        return ErrorOfMean { standard_error: 0.0, ..no_error(f64::INFINITY) };
    }
    let per_block = n.div_ceil(MOST_BLOCKS);
    let blocks: Vec<f64> = series.chunks_exact(per_block).map(mean).collect();
    let found = spectra_at_zero(&blocks, overlap / per_block as f64);
    let narrowest = (0..found.len()).rev().find(|&at| agrees(&found, at));
    let (at_zero, freedom) = found[narrowest.unwrap_or(0)];
    let squared = (at_zero / blocks.len() as f64).max(of_samples / n as f64);
    let widest = found[0].0 / blocks.len() as f64;
    ErrorOfMean {
        standard_error: squared.sqrt() * widening(freedom),
        n_effective: of_samples / squared,
        least_effective: of_samples / squared.max(widest),
        freedom,
    }
}

/// The two-error quantile of Student's t over 2.
fn widening(freedom: f64) -> f64 {
    1.0 + 1.25 / freedom + 49.0 / (32.0 * freedom * freedom)
}

/// The spectrum at frequency zero of a short series, Σγ(t), by each window with its degrees of freedom, the widest first.
fn spectra_at_zero(series: &[f64], overlap: f64) -> Vec<(f64, f64)> {
    let n = series.len() as f64;
    let width = |freedom: f64| 0.75 * n / freedom;
    if width(FREEDOMS[0]) <= 1.0 {
        // So few are blocks, and taken as independent.
        return vec![(variance(series) * n / (n - 1.0), n - 1.0)];
    }
    let narrowest = (1.5 * overlap).max(1.0);
    let covariances = covariances(series, width(FREEDOMS[0]).ceil() as usize);
    FREEDOMS
        .iter()
        .enumerate()
        .filter(|(k, freedom)| *k == 0 || width(**freedom) >= narrowest)
        .map(|(_, &freedom)| {
            let value = windowed(&covariances, n, width(freedom), freedom);
            (value, freedom)
        })
        .collect()
}

/// Whether every wider window agrees with the one at `at`.
fn agrees(found: &[(f64, f64)], at: usize) -> bool {
    let (value, freedom) = found[at];
    found[..at].iter().all(|&(wider, of_wider)| {
        let difference = (wider / value).ln() / (2.0 / of_wider - 2.0 / freedom).sqrt();
        let may_lower = of_wider >= FEWEST_TO_LOWER;
        difference < AGREEMENT[0] && (difference > -AGREEMENT[1] || !may_lower)
    })
}

/// The spectrum at zero with the window of degrees of freedom `freedom`, of a series of many samples.
pub(super) fn spectrum_with(series: &[f64], freedom: f64) -> f64 {
    let n = series.len() as f64;
    let width = (0.75 * n / freedom).max(1.0);
    windowed(&covariances(series, width.ceil() as usize), n, width, freedom)
}

/// γ(t) for t = 0, …, `longest`.
fn covariances(series: &[f64], longest: usize) -> Vec<f64> {
    let centre = mean(series);
    let centred: Vec<f64> = series.iter().map(|x| x - centre).collect();
    (0..=longest.min(series.len() - 1))
        .map(|lag| {
            let pairs = centred.len() - lag;
            let products = centred.iter().zip(&centred[lag..]).map(|(a, b)| a * b);
            products.sum::<f64>() / pairs as f64
        })
        .collect()
}

fn windowed(covariances: &[f64], n: f64, width: f64, freedom: f64) -> f64 {
    let sum = |weight: &dyn Fn(f64) -> f64| {
        let (mut value, mut weights) = (covariances[0], 1.0);
        for (lag, covariance) in covariances.iter().enumerate().skip(1) {
            let k = weight(lag as f64 / width);
            value += 2.0 * k * covariance;
            weights += 2.0 * k;
        }
        value / (1.0 - weights / n)
    };
    let flat_top = sum(&|t| {
        if t <= 0.5 { 1.0 } else { (2.0 - 2.0 * t).max(0.0) }
    });
    let bartlett = sum(&|t| (1.0 - t).max(0.0));
    let lowest = LOWEST_PART * (2.0 / freedom).sqrt() * bartlett;
    flat_top.max(lowest).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{Ar1, damped_rotation, free_gas_between_thermal_walls};
    use super::*;

    /// Shares of series whose mean lies within one and two errors of 0, and the spread of means over printed errors.
    fn coverage(series: impl Fn(u64) -> Vec<f64>, seeds: u64) -> (f64, f64, f64) {
        let found: Vec<(f64, f64)> = (0..seeds)
            .map(|seed| {
                let series = series(seed);
                (mean(&series), error_of_mean(&series).standard_error)
            })
            .collect();
        let share = |errors: f64| {
            let within = found.iter().filter(|(m, e)| m.abs() <= errors * e).count();
            within as f64 / seeds as f64
        };
        let means: Vec<f64> = found.iter().map(|f| f.0).collect();
        let squares: Vec<f64> = found.iter().map(|f| f.1 * f.1).collect();
        (share(1.0), share(2.0), (variance(&means) / mean(&squares)).sqrt())
    }

    #[test]
    fn errors_cover_whatever_the_correlation() {
        // n independent samples from 50 (the fewest that are judged) to all.
        for (n, phi) in
            [(250, 0.0_f64), (250, 0.67), (2000, 0.0), (2000, 0.9), (2000, 0.95), (20_000, 0.99)]
        {
            let (one, two, ratio) = coverage(|seed| Ar1::new(phi, seed).series(n), 600);
            // 600 seeds know the shares to 1.9 % and 0.9 %: the bars are three of these beyond 62 to 74 % and 93 %.
            assert!((0.60..0.76).contains(&one), "n {n}, φ {phi}: {one}");
            assert!(two > 0.90, "n {n}, φ {phi}: {two}");
            assert!((0.80..1.12).contains(&ratio), "n {n}, φ {phi}: {ratio}");
        }
    }

    #[test]
    fn hardly_any_error_is_far_too_small() {
        let far_too_small = |phi: f64, n: usize| {
            let exact = ((1.0 + phi) / ((1.0 - phi) * n as f64)).sqrt();
            let error = |seed| error_of_mean(&Ar1::new(phi, seed).series(n)).standard_error;
            let few = (0..1000).filter(|&seed| error(seed) < 0.55 * exact);
            few.count()
        };
        // 0.3 % each; with the widest window as a judge of the others it was 4 %.
        for (phi, n) in [(0.0, 2000), (0.8, 4000)] {
            let found = far_too_small(phi, n);
            assert!(found <= 12, "{phi}: {found} of 1000");
        }
    }

    #[test]
    fn a_slow_part_of_small_amplitude_is_not_lost_in_noise() {
        // A tenth of the variance, but three fourths of the error: e^{−t/10} with weight 0.9 and e^{−t/300} with 0.1.
        let slow = |seed: u64| {
            let fast = Ar1::new((-0.1_f64).exp(), 2 * seed).series(20_000);
            let slow = Ar1::new((-1.0_f64 / 300.0).exp(), 2 * seed + 1).series(20_000);
            let mix = |(a, b): (&f64, &f64)| 0.9_f64.sqrt() * a + 0.1_f64.sqrt() * b;
            fast.iter().zip(&slow).map(mix).collect()
        };
        let (one, two, ratio) = coverage(slow, 600);
        // Three standard deviations of 600 seeds below 0.63 and 0.91.
        assert!(one > 0.57 && two > 0.875 && ratio < 1.15, "{one} {two} {ratio}");
    }

    /// n_eff/n of the correlation rᵗ cos ωt: 1/(1 + 2 Re[z/(1 − z)]) with z = r e^{iω}.
    fn of_rotation(r: f64, omega: f64) -> f64 {
        let (re, im) = (r * omega.cos(), r * omega.sin());
        let denominator = (1.0 - re).powi(2) + im * im;
        1.0 / (1.0 + 2.0 * (re * (1.0 - re) - im * im) / denominator)
    }

    #[test]
    fn an_oscillating_correlation_counts_with_its_sign() {
        let (r, omega) = (0.97_f64, 0.1_f64);
        let exact = of_rotation(r, omega);
        let n = 32_768;
        let found: Vec<f64> = (0..40)
            .map(|seed| error_of_mean(&damped_rotation(r, omega, seed, n)).n_effective / n as f64)
            .collect();
        // 40 estimates with ν = 64 know their mean to 18 %/√40.
        assert!((mean(&found) / exact - 1.0).abs() < 0.15, "{} {exact}", mean(&found));
    }

    /// Narrow windows end before the correlation is negative, and give an error of twice the true one. Wider windows speak against it.
    #[test]
    fn an_oscillation_longer_than_narrow_windows_does_not_double_the_error() {
        let (r, omega) = ((-1.0_f64 / 60.0).exp(), std::f64::consts::TAU / 100.0);
        let exact = of_rotation(r, omega);
        let n = 2048;
        let parts: Vec<f64> = (0..200)
            .map(|seed| {
                let found = error_of_mean(&damped_rotation(r, omega, seed, n));
                (exact * n as f64 / found.n_effective).sqrt()
            })
            .collect();
        assert!((0.85..1.25).contains(&mean(&parts)), "{}", mean(&parts));
    }

    #[test]
    fn few_samples_have_the_wider_error_of_students_t() {
        let found = error_of_mean(&[1.0, -1.0, 1.0, -1.0]);
        assert_eq!(found.freedom, 3.0);
        // s²/n = 1/3, and the quantile of t with three degrees of freedom is 3.31 where the normal one is 2.
        assert!((found.standard_error * 3.0_f64.sqrt() - 1.65).abs() < 0.1);
        assert!((widening(8.0) - 1.18).abs() < 0.005 && (widening(64.0) - 1.02).abs() < 0.001);
        assert!(error_of_mean(&[1.0, 2.0, 3.0]).standard_error.is_nan());
        assert!(error_of_mean(&[1.0, f64::NAN, 3.0, 1.0]).standard_error.is_nan());
        assert_eq!(error_of_mean(&[0.1; 1000]).standard_error, 0.0);
    }

    #[test]
    fn no_series_is_worth_more_than_its_samples() {
        for n in [5, 30, 200, 4000, 9000] {
            let x = Ar1::new(0.0, 1).series(n + 1);
            let differences: Vec<f64> = x.windows(2).map(|p| p[1] - p[0]).collect();
            for found in [error_of_mean(&differences), error_with_overlap(&differences, 1.0)] {
                assert!(found.n_effective <= n as f64 * (1.0 + 1e-12), "{found:?}");
                assert!(found.least_effective <= found.n_effective, "{found:?}");
            }
        }
    }

    /// 200 gases of particles that fly between two thermal walls without collisions. The flight of a slow particle takes any time, so
    /// that correlations fall as 1/t.
    #[test]
    fn the_error_of_hits_on_a_thermal_wall_covers() {
        let gas = |seed| free_gas_between_thermal_walls(seed, 108, 8.0, 0.05, 6000);
        let (_, _, ratio) = coverage(gas, 200);
        // 200 seeds know their spread to 5 %. Without the bound by independent samples the ratio is 1.26.
        assert!((0.88..1.15).contains(&ratio), "{ratio}");
    }
}
