//! A straight line through a series: the drift of a conserved energy.

use super::{FEWEST_BLOCKS, Line, mean};

/// Blocks whose slopes tell the error of the slope.
const SLOPE_BLOCKS: usize = 10;

/// A straight line y = intercept + slope·t fitted by least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// The slope over the whole series.
    pub slope: f64,
    /// Its standard error from the slopes of ten successive blocks, s/√10.
    ///
    /// It is right where the series is a random walk, as rounding makes it. Where the series only
    /// fluctuates about a line, it is up to ten times too large. The line through all samples is then
    /// known better than the mean of the slopes of its parts. It errs on the safe side.
    pub standard_error: f64,
    /// The blocks that the error is from; too few for an error give their number all the same.
    pub blocks: usize,
    /// The value at t = 0.
    pub intercept: f64,
    /// Root mean square of y − (intercept + slope·t).
    pub rms: f64,
}

/// Fits a line to `values` at `times` (equally long, times rising) and tells the error of its slope.
///
/// All NaN for fewer than three samples; the error alone is NaN for fewer than 3·4.
///
/// # Panics
/// Where the two differ in length: that is a bug of the caller.
#[must_use]
pub fn drift(times: &[f64], values: &[f64]) -> Drift {
    assert_eq!(times.len(), values.len(), "one time for each value");
    let mut line = Line::default();
    for (t, y) in times.iter().zip(values) {
        line.push(*t, *y);
    }
    Drift {
        slope: line.slope(),
        standard_error: slope_error(times, values),
        blocks: slope_blocks(times.len()),
        intercept: line.intercept(),
        rms: line.rms(),
    }
}

/// Blocks whose slopes tell the error of the slope of so many samples.
fn slope_blocks(samples: usize) -> usize {
    SLOPE_BLOCKS.min(samples / 3)
}

/// The standard error of the slope from the slopes of successive blocks.
pub(crate) fn slope_error(times: &[f64], values: &[f64]) -> f64 {
    let blocks = slope_blocks(times.len());
    if blocks < FEWEST_BLOCKS {
        return f64::NAN;
    }
    let slopes: Vec<f64> = (0..blocks)
        .map(|b| {
            let range = b * times.len() / blocks..(b + 1) * times.len() / blocks;
            let mut line = Line::default();
            for (t, y) in times[range.clone()].iter().zip(&values[range]) {
                line.push(*t, *y);
            }
            line.slope()
        })
        .collect();
    let centre = mean(&slopes);
    let sum: f64 = slopes.iter().map(|s| (s - centre).powi(2)).sum();
    let n = blocks as f64;
    (sum / (n - 1.0) / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{Ar1, printed_and_spread};
    use super::*;

    fn times(n: usize) -> Vec<f64> {
        (0..n).map(|i| 0.05 * i as f64).collect()
    }

    #[test]
    fn the_error_of_the_slope_is_the_spread_over_seeds_of_a_random_walk() {
        // With ten blocks a printed error scatters by 1/√18 = 24 %; over 200 seeds its root mean square
        // is known to 2 %, the spread to 5 %. In a random walk of n steps, Var(slope) is 6/(5 n) of a
        // step's variance for the whole, and ten times as much for a block. Slopes of neighboring blocks
        // are not correlated in a walk, so s²/10 is right.
        let (n, seeds) = (2000, 200);
        let t = times(n);
        let slope = |seed| {
            let mut walk = Ar1::new(0.0, seed).series(n);
            for i in 1..n {
                walk[i] += walk[i - 1];
            }
            let found = drift(&t, &walk);
            crate::Estimate::new(found.slope, found.standard_error, 10.0)
        };
        let (_, quotient) = printed_and_spread(&(0..seeds).map(slope).collect::<Vec<_>>());
        assert!((quotient - 1.0).abs() < 0.2, "{quotient}");
    }

    #[test]
    fn the_error_of_the_slope_is_never_too_small_for_noise_about_a_line() {
        let t = times(2000);
        let mut worst = 0.0_f64;
        for seed in 0..100 {
            let y = Ar1::new(0.9, seed).series(2000);
            let found = drift(&t, &y);
            worst = worst.max((found.slope / found.standard_error).abs());
        }
        // The true slope is zero; 1/10 of the printed error is the spread, so even four of those stay small.
        assert!(worst < 1.0, "{worst}");
    }

    #[test]
    fn too_few_samples_give_no_number() {
        assert!(drift(&[0.0], &[1.0]).slope.is_nan());
        assert!(drift(&times(5), &[1.0; 5]).standard_error.is_nan());
        assert_eq!([14, 2000].map(|n| drift(&times(n), &vec![1.0; n]).blocks), [4, 10]);
    }
}
