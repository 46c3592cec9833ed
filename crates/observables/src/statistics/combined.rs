//! Quantities made from two correlated series.

use crate::Estimate;

use super::{equilibration, estimate_after, mean};

/// The latest equilibration cut of several series of one run, in samples. Averages that are combined
/// must be taken over the same samples.
#[must_use]
pub fn common_cut(series: &[&[f64]]) -> usize {
    series.iter().map(|s| equilibration(s).cut).max().unwrap_or(0)
}

/// The ratio of two means, R = ⟨a⟩/⟨b⟩, with the error of the correlated pair, after `cut` samples, and the series z whose
/// mean has that error.
///
/// To first order the ratio fluctuates as z_i = (a_i − R·b_i)/⟨b⟩, whose mean is zero. The error of R is
/// the error of the mean of z, correlation included. The bias of the ratio, −⟨δz δb⟩/⟨b⟩ per independent
/// sample, is of second order and not corrected.
///
/// # Panics
/// Where the two series differ in length: that is a bug of the caller.
#[must_use]
pub fn ratio(numerator: &[f64], denominator: &[f64], cut: usize) -> (Estimate, Vec<f64>) {
    assert_eq!(numerator.len(), denominator.len(), "both series come from the same samples");
    let start = cut.min(numerator.len());
    let (a, b) = (&numerator[start..], &denominator[start..]);
    let below = mean(b);
    let value = mean(a) / below;
    let z: Vec<f64> = a.iter().zip(b).map(|(x, y)| (x - value * y) / below).collect();
    let estimate = Estimate { mean: value, ..estimate_after(&z, 0).with_cut(cut) };
    (estimate, z)
}

/// The mean of a quantity with the error of its difference from a line in another one, after `cut` samples.
///
/// A run at a measured temperature T̄ is compared with an equation of state at that T̄, so that T and U
/// err together. With the slope s = ∂U_EOS/∂T the difference Ū − U_EOS(T̄) fluctuates as d_i = U_i −
/// s·(T_i − T̄), which has the mean Ū. The mean and the error of d are returned. In a run at constant
/// energy U falls as T rises, and the error of d is larger than the error of U.
///
/// # Panics
/// Where the two series differ in length: that is a bug of the caller.
#[must_use]
pub fn about_line(values: &[f64], abscissae: &[f64], slope: f64, cut: usize) -> Estimate {
    assert_eq!(values.len(), abscissae.len(), "both series come from the same samples");
    let start = cut.min(values.len());
    let (y, x) = (&values[start..], &abscissae[start..]);
    let centre = mean(x);
    let differences: Vec<f64> = y.iter().zip(x).map(|(y, x)| y - slope * (x - centre)).collect();
    // The mean of d is the mean of the values, since Σ(x − x̄) is zero except for rounding.
    Estimate { mean: mean(y), ..estimate_after(&differences, 0).with_cut(cut) }
}

/// Sets the cut of an estimate that was made from the rest of a series.
trait WithCut {
    fn with_cut(self, cut: usize) -> Self;
}

impl WithCut for Estimate {
    fn with_cut(self, cut: usize) -> Self {
        Self { equilibration_cut: cut as u64, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{Ar1, printed_and_spread};
    use super::*;

    /// The spread of 200 means over the root mean square of their errors.
    fn spread_over_printed(make: impl Fn(u64) -> Estimate) -> f64 {
        printed_and_spread(&(0..200).map(make).collect::<Vec<_>>()).1
    }

    #[test]
    fn the_error_of_a_ratio_carries_the_correlation_of_its_parts() {
        // b = 10 + x and a = 20 + 2x + 0.3y: the ratio is 2, and only y moves it.
        let make = |seed| {
            let x = Ar1::new(0.8, seed).series(4000);
            let y = Ar1::new(0.8, 10_000 + seed).series(4000);
            let b: Vec<f64> = x.iter().map(|x| 10.0 + x).collect();
            let a: Vec<f64> = x.iter().zip(&y).map(|(x, y)| 20.0 + 2.0 * x + 0.3 * y).collect();
            let found = ratio(&a, &b, 0).0;
            // g = 9: the error is 0.3/10·√(9/4000).
            let exact = 0.03 * (9.0_f64 / 4000.0).sqrt();
            // One error is known to a tenth or, where the widest window is taken, to a fourth.
            assert!((0.3..3.0).contains(&(found.standard_error / exact)));
            assert!((found.mean - 2.0).abs() < 5.0 * exact);
            found
        };
        // 200 seeds know their spread to 1/√400 = 5 %: three of these.
        let quotient = spread_over_printed(make);
        assert!((quotient - 1.0).abs() < 0.15, "{quotient}");
    }

    #[test]
    fn the_difference_from_an_equation_of_state_has_the_error_of_the_correlated_pair() {
        // At constant energy u = e − 1.5·t exactly; against a line of slope 2 the difference fluctuates
        // 3.5 times as much as t, while u alone would promise 1.5.
        let make = |seed| {
            let t = Ar1::new(0.7, seed).series(3000);
            let u: Vec<f64> = t.iter().map(|t| -4.0 - 1.5 * t).collect();
            let found = about_line(&u, &t, 2.0, 0);
            // The true line passes through (0, −4): the difference is the tested quantity.
            Estimate { mean: found.mean - (-4.0 + 2.0 * mean(&t)), ..found }
        };
        let quotient = spread_over_printed(make);
        assert!((quotient - 1.0).abs() < 0.15, "{quotient}");
    }

    #[test]
    fn the_common_cut_is_the_latest() {
        let quiet = Ar1::new(0.0, 1).series(2000);
        let mut late = quiet.clone();
        for x in &mut late[..300] {
            *x += 20.0;
        }
        let cut = common_cut(&[&quiet, &late]);
        assert_eq!(cut, equilibration(&late).cut);
        assert!(cut >= 300, "{cut}");
        let found = about_line(&quiet, &late, 0.0, cut);
        assert_eq!(found.equilibration_cut, cut as u64);
    }
}
