//! A series whose true mean is known to be zero takes noise out of a value.

use super::mean;

/// Blocks of the series, whose means tell how the value follows the control: each is longer than most correlations.
const BLOCKS: usize = 50;
/// Fewer samples in a block say nothing of long correlations, and the value stays.
const FEWEST_IN_A_BLOCK: usize = 10;

/// A value less what it owes to a control, with its influence series likewise.
///
/// The control z has a true mean of zero, so that f − c·z̄ has the same expectation as f for any fixed c. The error is smallest for
/// c = cov(ȳ, z̄)/var(z̄) over long blocks, with the influence y of f. c is known to a part in √(2·50), and makes the error
/// larger by one part in 100 at most.
///
/// Source: P. Glasserman, Monte Carlo Methods in Financial Engineering (2003), section 4.1, for control variates.
pub(crate) fn less_control(
    value: f64,
    mut influence: Vec<f64>,
    control: &[f64],
) -> (f64, Vec<f64>) {
    let length = influence.len() / BLOCKS;
    if length < FEWEST_IN_A_BLOCK || control.len() != influence.len() {
        return (value, influence);
    }
    let (own, seen) = (mean(&influence), mean(control));
    let of_blocks = |series: &[f64], about: f64| -> Vec<f64> {
        let blocks = series.chunks_exact(length);
        blocks.map(|block| mean(block) - about).collect()
    };
    let (y, z) = (of_blocks(&influence, own), of_blocks(control, seen));
    let product: f64 = y.iter().zip(&z).map(|(y, z)| y * z).sum();
    let square: f64 = z.iter().map(|z| z * z).sum();
    let follows = product / square;
    // Nothing to take out where the control is constant.
    if !follows.is_finite() {
        return (value, influence);
    }
    for (y, z) in influence.iter_mut().zip(control) {
        *y -= follows * (z - seen);
    }
    (value - follows * seen, influence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::synthetic::Ar1;

    /// A value whose noise is one part the control and one part its own: half of the variance goes.
    #[test]
    fn what_follows_the_control_goes_and_the_mean_stays() {
        let (mut plain, mut less) = (Vec::new(), Vec::new());
        for seed in 0..200 {
            let control = Ar1::new(0.8, 2 * seed).series(2000);
            let own = Ar1::new(0.8, 2 * seed + 1).series(2000);
            let y: Vec<f64> = own.iter().zip(&control).map(|(o, z)| o - z).collect();
            let found = 3.0 + mean(&y);
            let centred = y.iter().map(|y| y - mean(&own)).collect();
            plain.push(found);
            less.push(less_control(found, centred, &control).0);
        }
        let spread = |values: &[f64]| crate::statistics::variance(values);
        let ratio = spread(&less) / spread(&plain);
        // 200 seeds know a variance to a tenth.
        assert!((ratio - 0.5).abs() < 0.15, "{ratio}");
        let error = (spread(&less) / 200.0).sqrt();
        assert!((mean(&less) - 3.0).abs() < 3.0 * error);
    }

    #[test]
    fn a_constant_control_and_a_short_series_change_nothing() {
        let y: Vec<f64> = Ar1::new(0.5, 1).series(2000);
        let constant = vec![0.0; 2000];
        assert_eq!(less_control(1.0, y.clone(), &constant), (1.0, y.clone()));
        let short = y[..400].to_vec();
        assert_eq!(less_control(1.0, short.clone(), &short), (1.0, short));
    }
}
