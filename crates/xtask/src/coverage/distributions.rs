//! The two distributions that say how far a share or a χ² may be off by chance.

use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

/// P(X ≤ k) and P(X ≥ k) of a binomial variable: `n` trials of probability `p`.
#[must_use]
pub fn binomial_tails(k: usize, n: usize, p: f64) -> (f64, f64) {
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
#[must_use]
pub fn chi_squared_tails(x: f64, n: usize) -> (f64, f64) {
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
}
