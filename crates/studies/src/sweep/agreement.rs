//! What the differences of all points say together.

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::SweptPoint;
use crate::compare::{Row, Verdict};

/// The differences of one quantity over all points that are single stable phases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// Which quantity.
    pub quantity: String,
    /// Points that it is judged at.
    pub points: usize,
    /// How many of them agree.
    pub agree: usize,
    /// How many of them have a tolerance that is too large to see a difference.
    pub too_coarse: usize,
    /// Mean difference.
    pub mean_difference: f64,
    /// Largest difference by size, with its sign.
    pub largest_difference: f64,
    /// Largest standard error.
    pub largest_standard_error: f64,
    /// Σ (difference/error)² with the statistical errors alone.
    pub chi_squared: f64,
    /// Probability of a sum at least so large, were the equation exact.
    pub p_value: f64,
    /// The same with the equation's own uncertainty added in quadrature.
    pub chi_squared_with_reference: f64,
    /// Probability of a sum at least so large, were the equation off by its own uncertainty at random.
    pub p_value_with_reference: f64,
}

/// Sums up one quantity; `None` where no point is judged by it.
#[must_use]
pub fn agreement(points: &[SweptPoint], quantity: &str) -> Option<Agreement> {
    let rows: Vec<&Row> = points
        .iter()
        .filter_map(|p| p.compared.as_ref())
        .filter(|c| c.state.is_single_stable_phase())
        .flat_map(|c| &c.rows)
        .filter(|r| r.quantity == quantity)
        .filter(|r| r.verdict.is_judged())
        .collect();
    let differences: Vec<f64> = rows.iter().filter_map(|r| r.difference).collect();
    if differences.is_empty() {
        return None;
    }
    let errors: Vec<(f64, f64)> = rows
        .iter()
        .map(|r| (r.combined_error.unwrap_or(f64::NAN), r.reference_error.unwrap_or(0.0)))
        .collect();
    let chi = |with_reference: bool| -> f64 {
        differences
            .iter()
            .zip(&errors)
            .map(|(d, (own, reference))| {
                let error = if with_reference { own.hypot(*reference) } else { *own };
                (d / error).powi(2)
            })
            .sum()
    };
    let (plain, with) = (chi(false), chi(true));
    let count = |verdict: Verdict| rows.iter().filter(|r| r.verdict == verdict).count();
    Some(Agreement {
        quantity: quantity.to_owned(),
        points: differences.len(),
        agree: count(Verdict::Agrees),
        too_coarse: count(Verdict::TooCoarse),
        mean_difference: differences.iter().sum::<f64>() / differences.len() as f64,
        largest_difference: differences
            .iter()
            .copied()
            .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a }),
        largest_standard_error: errors.iter().map(|(own, _)| *own).fold(0.0, f64::max),
        chi_squared: plain,
        p_value: tail_probability(plain, differences.len()),
        chi_squared_with_reference: with,
        p_value_with_reference: tail_probability(with, differences.len()),
    })
}

/// A probability for a table: what is too small for a number is said to be below the smallest.
#[must_use]
pub fn probability_words(p: f64) -> String {
    if p < f64::MIN_POSITIVE { "< 10⁻³⁰⁷".into() } else { crate::report::significant(p, 2) }
}

/// The probability that a sum of `n` squares of standard normal numbers is at least `chi_squared`.
pub(super) fn tail_probability(chi_squared: f64, n: usize) -> f64 {
    if !chi_squared.is_finite() {
        return f64::NAN;
    }
    ChiSquared::new(n as f64).map_or(f64::NAN, |d| d.sf(chi_squared))
}

#[cfg(test)]
mod tests {
    use super::{probability_words, tail_probability};

    #[test]
    fn tail_probabilities_are_those_of_the_tables() {
        // Two degrees of freedom: e^{−x/2}; ten: the 5 % point is 18.307.
        assert!((tail_probability(3.0, 2) - (-1.5_f64).exp()).abs() < 1e-9);
        assert!((tail_probability(18.307, 10) - 0.05).abs() < 1e-5);
        assert!(tail_probability(f64::NAN, 3).is_nan());
        assert_eq!(probability_words(tail_probability(1e5, 3)), "< 10⁻³⁰⁷");
        assert_eq!(probability_words(0.0512), "0.051");
    }
}
