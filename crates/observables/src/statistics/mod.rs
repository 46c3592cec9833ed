//! Means of correlated series and their errors.
//!
//! Samples of a simulation are correlated, so that n of them are worth n_eff independent ones. The squared standard
//! error of the mean is σ²/n_eff.
//!
//! - [`equilibration`]: the part to discard at the start, and whether the rest still changes;
//! - [`estimate`]: mean and error after that part; [`estimate_after`]: after a part that is given;
//! - [`error_of_mean`]: the error, and how well it is itself known;
//! - [`blocking_curve`]: the same error by another road, with the plateau that shows it is one;
//! - [`ratio`], [`about_line`]: quantities made from two correlated series;
//! - [`Line`]: the straight line of least squares; [`drift`]: one through a series, with the error of its slope.
//!
//! Where an error is not known (a single sample), it is NaN, never zero.

mod blocking;
mod combined;
mod control;
mod drift;
mod equilibration;
mod error_of_mean;
mod line;
#[cfg(test)]
pub(crate) mod synthetic;

pub use blocking::{BlockingCurve, BlockingLevel, blocking_curve};
pub use combined::{about_line, common_cut, ratio};
pub(crate) use control::less_control;
pub(crate) use drift::slope_error;
pub use drift::{Drift, drift};
pub use equilibration::{
    Equilibration, LARGEST_CUT, TRANSIENT_ERRORS, TRANSIENT_OF_MANY_ERRORS, Trend, bar,
    equilibration, trend,
};
pub use error_of_mean::{ErrorOfMean, FEWEST_BLOCKS, error_of_mean, error_with_overlap};
pub use line::Line;

use crate::Estimate;

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

/// Mean, error and number of independent samples after the part that [`equilibration`] discards.
#[must_use]
pub fn estimate(series: &[f64]) -> Estimate {
    estimate_after(series, equilibration(series).cut)
}

/// As [`estimate`], for a series that is known to be stationary: nothing is discarded.
///
/// A constant series has error 0, fewer than [`FEWEST_BLOCKS`] samples have error NaN, an empty series is NaN with
/// n_eff = 0.
///
/// ```
/// use lennard_core::random::Streams;
/// use lennard_observables::statistics::estimate_stationary;
/// use rand_distr::{Distribution, StandardNormal};
///
/// // Each value twice: 4000 samples are worth about 2000.
/// let noise = Streams::new(1).noise("example");
/// let series: Vec<f64> = (0..2000)
///     .map(|i| StandardNormal.sample(&mut noise.at(i, 0)))
///     .flat_map(|x: f64| [x, x])
///     .collect();
/// let found = estimate_stationary(&series);
/// // The error is known to 1/√(2·freedom), 9 % here: four of these.
/// assert!((found.standard_error * 2000.0_f64.sqrt() - 1.0).abs() < 0.36);
/// ```
#[must_use]
pub fn estimate_stationary(series: &[f64]) -> Estimate {
    estimate_after(series, 0)
}

/// As [`estimate`], with a cut that is given, in samples.
#[must_use]
pub fn estimate_after(series: &[f64], cut: usize) -> Estimate {
    let rest = &series[cut.min(series.len())..];
    let error = error_of_mean(rest);
    Estimate {
        mean: mean(rest),
        standard_error: error.standard_error,
        n_effective: error.n_effective,
        least_effective: error.least_effective,
        freedom: error.freedom,
        equilibration_cut: cut as u64,
    }
}
