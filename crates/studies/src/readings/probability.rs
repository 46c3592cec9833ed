//! Probabilities of χ² and of counts, and how a table has them.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A probability for a table: what is too small for a number is said to be below the smallest.
#[must_use]
pub(super) fn probability_words(p: f64) -> String {
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
