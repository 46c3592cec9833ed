//! Errors by blocking.

use crate::Table;

use super::{FEWEST_BLOCKS, variance};

/// One level of the blocking transformation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockingLevel {
    /// Samples a block.
    pub block: usize,
    /// Number of blocks n.
    pub blocks: usize,
    /// The error of the mean if blocks of this size were independent, √(c₀/(n − 1)).
    pub standard_error: f64,
    /// Its own error, standard_error/√(2(n − 1)).
    pub uncertainty: f64,
}

/// Apparent error of the mean against block size.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockingCurve {
    /// Levels with block sizes 1, 2, 4, … down to [`FEWEST_BLOCKS`] blocks.
    pub levels: Vec<BlockingLevel>,
    /// The first level on the plateau; `None` where the series is too short to reach one.
    pub plateau: Option<usize>,
}

impl BlockingCurve {
    /// The error on the plateau. Where there is no plateau, it is the error of the largest blocks, a
    /// lower bound.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        self.plateau
            .map(|level| self.levels[level])
            .or(self.levels.last().copied())
            .map_or(f64::NAN, |level| level.standard_error)
    }

    /// The curve as a table; the plateau is marked by 1.
    #[must_use]
    pub fn table(&self, name: &str, caption: &str) -> Table {
        let column = |value: fn(&BlockingLevel) -> f64| self.levels.iter().map(value).collect();
        Table::new(name, caption)
            .with("block", "samples", column(|l| l.block as f64))
            .with("blocks", "", column(|l| l.blocks as f64))
            .with("standard_error", "", column(|l| l.standard_error))
            .with("uncertainty", "", column(|l| l.uncertainty))
            .with(
                "plateau",
                "",
                (0..self.levels.len()).map(|l| f64::from(self.plateau == Some(l))).collect(),
            )
    }
}

/// The blocking transformation: neighbors are averaged in pairs again and again. The apparent error
/// rises to a plateau when the blocks are longer than the correlation.
///
/// The plateau begins with the smallest block size B for which B³ > 2n·(s_B/s_1)⁴, s being the apparent
/// errors and n the number of samples.
///
/// Sources: H. Flyvbjerg and H. G. Petersen, "Error estimates on averages of correlated data",
/// J. Chem. Phys. 91, 461 (1989), equations 20 to 28; R. M. Lee, G. J. Conduit, N. Nemec, P. López Ríos
/// and N. D. Drummond, "Strategies for improving the efficiency of quantum Monte Carlo calculations",
/// Phys. Rev. E 83, 066706 (2011), equation 17, for the choice of B.
#[must_use]
pub fn blocking_curve(series: &[f64]) -> BlockingCurve {
    let mut levels = Vec::new();
    let mut blocks = series.to_vec();
    let mut block = 1;
    while blocks.len() >= FEWEST_BLOCKS {
        let n = blocks.len() as f64;
        let standard_error = (variance(&blocks) / (n - 1.0)).sqrt();
        levels.push(BlockingLevel {
            block,
            blocks: blocks.len(),
            standard_error,
            uncertainty: standard_error / (2.0 * (n - 1.0)).sqrt(),
        });
        blocks = blocks.chunks_exact(2).map(|p| 0.5 * (p[0] + p[1])).collect();
        block *= 2;
    }
    let n = series.len() as f64;
    let plateau = levels.iter().position(|level| {
        let first = levels[0].standard_error;
        let rise = if first > 0.0 { level.standard_error / first } else { 1.0 };
        (level.block as f64).powi(3) > 2.0 * n * rise.powi(4)
    });
    BlockingCurve { levels, plateau }
}

#[cfg(test)]
mod tests {
    use super::super::mean;
    use super::super::synthetic::Ar1;
    use super::*;

    #[test]
    fn the_plateau_is_the_exact_error_of_a_first_order_process() {
        // Unit variance and g = (1 + φ)/(1 − φ): the error of the mean is √(g/n). A plateau at block size
        // B has n/B blocks and scatters by √(B/2n); its bias is about τ/B, τ = g/2.
        let (phi, n) = (0.9, 65_536);
        let exact = (1.9 / 0.1 / n as f64).sqrt();
        let mut errors = Vec::new();
        for seed in 0..40 {
            let curve = blocking_curve(&Ar1::new(phi, seed).series(n));
            let level = curve.levels[curve.plateau.expect("65 536 samples reach the plateau")];
            let scatter = (level.block as f64 / (2.0 * n as f64)).sqrt();
            let ratio = level.standard_error / exact;
            assert!((ratio - 1.0).abs() < 4.0 * scatter + 9.5 / level.block as f64);
            errors.push(ratio);
            // Uncorrelated samples would have claimed √(1/n): the blocks must tell the difference.
            assert!(curve.levels[0].standard_error < 0.3 * exact);
        }
        assert!((mean(&errors) - 1.0).abs() < 0.05, "{}", mean(&errors));
    }

    #[test]
    fn a_series_shorter_than_its_correlation_has_no_plateau() {
        let ramp: Vec<f64> = (0..64).map(f64::from).collect();
        assert_eq!(blocking_curve(&ramp).plateau, None);
    }

    #[test]
    fn a_constant_series_has_no_error() {
        let curve = blocking_curve(&[2.5; 256]);
        assert_eq!(curve.standard_error(), 0.0);
        assert!(blocking_curve(&[1.0]).standard_error().is_nan());
    }
}
