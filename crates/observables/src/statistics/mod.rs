//! Means of correlated series and their errors.
//!
//! Samples of a simulation are correlated, so that n of them are worth n_eff = n/g independent ones,
//! where g = 1 + 2 Σ_{t≥1} ρ(t) is the statistical inefficiency and ρ the normalised autocorrelation.
//! The standard error of the mean is σ √(g/n).
//!
//! - [`estimate`]: the beginning is cut where that leaves most independent samples, then mean and error;
//! - [`estimate_stationary`]: the same without a cut;
//! - [`autocorrelation_time`]: g by automatic windowing;
//! - [`blocking_curve`]: the same error by another road, with the plateau that shows it is one;
//! - [`ratio`], [`about_line`]: quantities made from two correlated series;
//! - [`drift`]: a straight line through a series with the error of its slope.
//!
//! Where an error cannot be told (a single sample), it is NaN, never zero.

mod autocorrelation;
mod blocking;
mod combined;
mod drift;
mod equilibration;
#[cfg(test)]
pub(crate) mod synthetic;

pub use autocorrelation::{Autocorrelation, autocorrelation_time, normalized_autocorrelation};
pub use blocking::{
    BlockingCurve, BlockingLevel, FEWEST_BLOCKS, blocking_curve, error_from_blocks,
};
pub use combined::{about_line, common_cut, ratio};
pub(crate) use drift::slope_error;
pub use drift::{Drift, RunningLine, drift};
pub use equilibration::{LARGEST_CUT, equilibration_cut};

use lennard_core::Estimate;

/// Arithmetic mean; NaN for an empty series.
#[must_use]
pub fn mean(series: &[f64]) -> f64 {
    // Deviations from the first value are summed: a constant series has exactly that mean.
    let Some(&first) = series.first() else {
        return f64::NAN;
    };
    first + series.iter().map(|x| x - first).sum::<f64>() / series.len() as f64
}

/// The population variance, Σ(x − x̄)²/n; NaN for an empty series.
#[must_use]
pub fn variance(series: &[f64]) -> f64 {
    let mean = mean(series);
    series.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / series.len() as f64
}

/// Mean, error and number of independent samples after the equilibration cut.
///
/// The cut is that of [`equilibration_cut`], the error that of [`estimate_stationary`].
#[must_use]
pub fn estimate(series: &[f64]) -> Estimate {
    estimate_after(series, equilibration_cut(series))
}

/// As [`estimate`], for a series that is known to be stationary: nothing is cut.
///
/// The standard error is σ √(g/(n−1)) with g from [`autocorrelation_time`] and n_eff = n/g; a constant
/// series has error 0, a single sample error NaN, an empty series is NaN with n_eff = 0.
///
/// ```
/// use lennard_core::random::Streams;
/// use lennard_observables::statistics::estimate_stationary;
/// use rand_distr::{Distribution, StandardNormal};
///
/// // Each value twice: g = 1 + 2·½ = 2, so 4000 samples are worth about 2000.
/// let noise = Streams::new(1).noise("example");
/// let series: Vec<f64> = (0..2000)
///     .map(|i| StandardNormal.sample(&mut noise.at(i, 0)))
///     .flat_map(|x: f64| [x, x])
///     .collect();
/// let found = estimate_stationary(&series);
/// assert!((found.n_effective / 2000.0 - 1.0).abs() < 0.2);
/// assert!((found.standard_error * 2000.0_f64.sqrt() - 1.0).abs() < 0.1);
/// ```
#[must_use]
pub fn estimate_stationary(series: &[f64]) -> Estimate {
    estimate_after(series, 0)
}

/// As [`estimate`], with a cut that is given, in samples.
#[must_use]
pub fn estimate_after(series: &[f64], cut: usize) -> Estimate {
    let rest = &series[cut.min(series.len())..];
    let n = rest.len() as f64;
    let inefficiency = autocorrelation_time(rest).inefficiency;
    Estimate {
        mean: mean(rest),
        standard_error: if rest.len() < 2 {
            f64::NAN
        } else {
            (variance(rest) * inefficiency / (n - 1.0)).sqrt()
        },
        n_effective: if rest.is_empty() {
            0.0
        } else {
            n / inefficiency
        },
        equilibration_cut: cut as u64,
    }
}
