//! The two distributions that say how far a share or a χ² may be off by chance.

/// P(X ≤ k) and P(X ≥ k) of a binomial variable: `n` trials of probability `p`.
#[must_use]
pub fn binomial_tails(k: usize, n: usize, p: f64) -> (f64, f64) {
    let mut term = n as f64 * (1.0 - p).ln();
    let (mut below, mut above) = (0.0, 0.0);
    for i in 0..=n {
        let probability = term.exp();
        if i <= k {
            below += probability;
        }
        if i >= k {
            above += probability;
        }
        term += ((n - i) as f64 / (i + 1) as f64).ln() + (p / (1.0 - p)).ln();
    }
    (below.min(1.0), above.min(1.0))
}

/// P(χ² ≤ x) and P(χ² ≥ x) with `n` degrees of freedom.
///
/// The lower tail is the regularised incomplete gamma function P(n/2, x/2); its series and its continued fraction
/// (Abramowitz and Stegun 6.5.29 and 6.5.31) converge on either side of their common bound.
#[must_use]
pub fn chi_squared_tails(x: f64, n: usize) -> (f64, f64) {
    if x <= 0.0 || n == 0 {
        return (0.0, 1.0);
    }
    let (a, z) = (n as f64 / 2.0, x / 2.0);
    let factor = (a * z.ln() - z - ln_gamma_of_half(n)).exp();
    if z < a + 1.0 {
        let (mut term, mut sum, mut k) = (1.0 / a, 1.0 / a, a);
        while term > sum * f64::EPSILON {
            k += 1.0;
            term *= z / k;
            sum += term;
        }
        let below = factor * sum;
        (below, 1.0 - below)
    } else {
        // Lentz's method.
        const MOST: u32 = 10_000;
        let mut b = z + 1.0 - a;
        let (mut c, mut d) = (f64::INFINITY, 1.0 / b);
        let mut fraction = d;
        for i in 1..MOST {
            let i = f64::from(i);
            let numerator = -i * (i - a);
            b += 2.0;
            d = 1.0 / (numerator * d + b);
            c = b + numerator / c;
            let change = c * d;
            fraction *= change;
            if (change - 1.0).abs() < f64::EPSILON {
                break;
            }
        }
        let above = factor * fraction;
        (1.0 - above, above)
    }
}

/// ln Γ(n/2), by its recurrence from Γ(1) = 1 and Γ(½) = √π.
fn ln_gamma_of_half(n: usize) -> f64 {
    let (mut x, mut sum) = if n.is_multiple_of(2) {
        (1.0, 0.0)
    } else {
        (0.5, std::f64::consts::PI.ln() / 2.0)
    };
    while x + 0.5 < n as f64 / 2.0 {
        sum += f64::ln(x);
        x += 1.0;
    }
    sum
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
