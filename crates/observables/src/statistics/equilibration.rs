//! Where the equilibrated part of a series begins.

use super::autocorrelation_time;

/// At most this part of a series is cut off: what is left must be able to speak for itself.
pub const LARGEST_CUT: f64 = 0.5;

/// Detection works on at most this many block means of the series.
const MOST_BLOCKS: usize = 2048;

/// Candidate cuts, geometrically spaced between 1/1000 and [`LARGEST_CUT`] of the series.
const CANDIDATES: u32 = 40;

/// Series shorter than this are not cut: their correlation cannot be told from a trend.
const SHORTEST: usize = 32;

/// A later cut must leave 1 + this/√n_eff times the independent samples of the full series: the estimate of
/// n_eff has relative noise of a few times 1/√n_eff, and the best of many noisy values is as likely chance as
/// relaxation. Without this the printed error of a short stationary series comes out too small, by a third
/// at ten independent samples.
const WORTHWHILE: f64 = 3.0;

/// The number of samples to cut off at the start: the cut t₀ that leaves the largest number of
/// independent samples, n_eff(t₀) = (n − t₀)/g(t₀), with g the statistical inefficiency of the rest.
///
/// Cutting a transient lowers g by more than it lowers n; cutting more only loses samples. At most half
/// of the series is cut, and nothing where the gain is within the noise of n_eff.
///
/// Source: J. D. Chodera, "A simple method for automated equilibration detection in molecular
/// simulations", J. Chem. Theory Comput. 12, 1799 (2016), equations 10 to 12.
#[must_use]
pub fn equilibration_cut(series: &[f64]) -> usize {
    if series.len() < SHORTEST {
        return 0;
    }
    let block = series.len().div_ceil(MOST_BLOCKS);
    let blocks: Vec<f64> = series.chunks_exact(block).map(super::mean).collect();
    let n = blocks.len() as f64;
    let independent = |cut: usize| {
        let rest = &blocks[cut..];
        rest.len() as f64 / autocorrelation_time(rest).inefficiency.max(1.0)
    };
    let smallest = (n / 1000.0).max(1.0);
    let ratio = (LARGEST_CUT * n / smallest).powf(1.0 / f64::from(CANDIDATES));
    let full = independent(0);
    let mut best = (0, full * (1.0 + WORTHWHILE / full.sqrt()));
    let mut last = 0;
    for k in 0..=CANDIDATES {
        let cut = (smallest * ratio.powi(k as i32)).round() as usize;
        if cut == last {
            continue;
        }
        last = cut;
        let found = independent(cut);
        if found > best.1 {
            best = (cut, found);
        }
    }
    best.0 * block
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::Ar1;
    use super::super::{estimate, mean, variance};
    use super::*;

    #[test]
    fn a_transient_is_cut_and_its_bias_gone() {
        // A start 8σ away that decays over 200 samples: after five decay times (1000) it is below 0.06σ.
        let mut cuts = Vec::new();
        for seed in 0..40 {
            let mut series = Ar1::new(0.8, seed).series(8192);
            for (i, x) in series.iter_mut().enumerate() {
                *x += 8.0 * (-(i as f64) / 200.0).exp();
            }
            let found = estimate(&series);
            cuts.push(found.equilibration_cut as f64);
            assert!(found.mean.abs() < 5.0 * found.standard_error + 0.03);
        }
        let average = mean(&cuts);
        assert!((400.0..1600.0).contains(&average), "{average}");
    }

    #[test]
    fn a_stationary_series_is_rarely_cut_and_its_printed_error_is_the_spread_of_its_mean() {
        // 400 seeds: the spread of the means is known to 1/√800 = 3.5 %, and the selection of the cut
        // may bias the printed error by a few per cent more.
        for phi in [0.0_f64, 0.9] {
            let found: Vec<_> = (0..400)
                .map(|seed| estimate(&Ar1::new(phi, 1000 + seed).series(2000)))
                .collect();
            let means: Vec<f64> = found.iter().map(|e| e.mean).collect();
            let printed = mean(
                &found
                    .iter()
                    .map(|e| e.standard_error.powi(2))
                    .collect::<Vec<_>>(),
            )
            .sqrt();
            let ratio = variance(&means).sqrt() / printed;
            let cut = mean(
                &found
                    .iter()
                    .map(|e| e.equilibration_cut as f64)
                    .collect::<Vec<_>>(),
            );
            assert!((0.88..1.15).contains(&ratio), "φ = {phi}: {ratio}");
            assert!(cut < 0.1 * 2000.0, "φ = {phi}: {cut}");
        }
    }

    #[test]
    fn constant_and_short_series_are_not_cut() {
        assert_eq!(equilibration_cut(&[1.0; 1000]), 0);
        assert_eq!(equilibration_cut(&[9.0, 1.0, 1.0, 1.0]), 0);
        assert_eq!(equilibration_cut(&[]), 0);
    }
}
