//! Probabilities of χ² and of counts, and how a table has them.

use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

/// What χ² is.
pub(super) const CHI_SQUARED_IN_WORDS: &str = "χ² is the sum of (difference/standard error)²: near the number of points where an equation is exact.";

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

/// P(X ≤ k) and P(X ≥ k) of a binomial variable: `n` trials of probability `p`.
pub(super) fn binomial_tails(k: usize, n: usize, p: f64) -> (f64, f64) {
    let Ok(distribution) = Binomial::new(p, n as u64) else {
        return (f64::NAN, f64::NAN);
    };
    let above = match k {
        0 => 1.0,
        k => distribution.sf(k as u64 - 1),
    };
    (distribution.cdf(k as u64), above)
}

/// P(χ² ≤ x) and P(χ² ≥ x) with `n` degrees of freedom.
pub(super) fn chi_squared_tails(x: f64, n: usize) -> (f64, f64) {
    match ChiSquared::new(n as f64) {
        Ok(distribution) if x > 0.0 => (distribution.cdf(x), distribution.sf(x)),
        _ => (0.0, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_chi_squared_are_those_of_the_tables() {
        // 0.1 % and 99.9 % points, from tables.
        for (n, low, high) in [
            (1, 1.571e-6, 10.828),
            (2, 0.002_001, 13.816),
            (9, 1.152, 27.877),
            (29, 10.986, 58.301),
            (100, 61.918, 149.449),
        ] {
            let (below, _) = chi_squared_tails(low, n);
            let (_, above) = chi_squared_tails(high, n);
            assert!((below - 1e-3).abs() < 2e-6, "{n}: {below}");
            assert!((above - 1e-3).abs() < 2e-6, "{n}: {above}");
        }
        assert_eq!(chi_squared_tails(0.0, 5), (0.0, 1.0));
    }

    #[test]
    fn tails_of_a_binomial_are_its_sums() {
        let (below, above) = binomial_tails(1, 3, 0.5);
        assert!((below - 0.5).abs() < 1e-12 && (above - 0.875).abs() < 1e-12);
        let (below, above) = binomial_tails(30, 30, 0.95);
        assert!((below - 1.0).abs() < 1e-9 && (above - 0.95_f64.powi(30)).abs() < 1e-9);
    }

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
