//! Autocorrelation and statistical inefficiency.

use super::{mean, variance};

/// What the correlation of a series costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Autocorrelation {
    /// Statistical inefficiency g = 1 + 2 Σ ρ(t): the number of samples that are worth one independent
    /// one. Below 1 where successive samples are anticorrelated, though never below 10/√n (or 1 where that
    /// is more than 1): a small value must stand out from the noise of its estimate.
    pub inefficiency: f64,
    /// The largest lag of the sum, in samples.
    pub window: usize,
    /// Whether the correlation was seen to decay, within an eighth of the series; where it was not,
    /// `inefficiency` is a lower bound.
    pub decayed: bool,
}

/// The smallest inefficiency that is believed is this over √n. Its estimate over a window W has noise
/// √(4W/n), W some ten lags: anticorrelation is credited only where it exceeds the noise, which errs on
/// the side of too large errors.
const SMALLEST_INEFFICIENCY_ROOT_N: f64 = 10.0;

/// Ratio of the decay time to the integrated autocorrelation time assumed by the automatic window;
/// Wolff's recommended value is 1.5.
const WINDOW_RATIO: f64 = 1.5;

/// Lags looked at before the series is averaged in pairs instead, so that the cost stays linear.
const MOST_LAGS: usize = 256;

/// Series shorter than this are not averaged in pairs: too few blocks would be left.
const SHORTEST_HALVED: usize = 1024;

/// The correlation counts as gone where it stays below this many standard errors of its own.
const QUIET_SIGMAS: f64 = 3.0;

/// Lags over which it must stay quiet, at least; besides half of the lags that went before.
const QUIET_LAGS: usize = 5;

/// A window beyond this part of the series has too few independent stretches to show a decay.
const LONGEST_WINDOW: f64 = 0.125;

/// The normalised autocorrelation ρ(t), `[max_lag + 1]` with ρ(0) = 1, of a series of n samples:
/// ρ(t) = Σ_i (x_i − x̄)(x_{i+t} − x̄) / ((n − t) σ²). All zero but ρ(0) for a constant series.
#[must_use]
pub fn normalized_autocorrelation(series: &[f64], max_lag: usize) -> Vec<f64> {
    let centred = centred(series);
    let variance = variance(series);
    (0..=max_lag.min(series.len().saturating_sub(1)))
        .map(|lag| match (lag, variance > 0.0) {
            (0, _) => 1.0,
            (_, true) => covariance(&centred, lag) / variance,
            (_, false) => 0.0,
        })
        .collect()
}

fn centred(series: &[f64]) -> Vec<f64> {
    let mean = mean(series);
    series.iter().map(|x| x - mean).collect()
}

fn covariance(centred: &[f64], lag: usize) -> f64 {
    let n = centred.len() - lag;
    let sum: f64 = centred[..n]
        .iter()
        .zip(&centred[lag..])
        .map(|(a, b)| a * b)
        .sum();
    sum / n as f64
}

/// The statistical inefficiency g = 1 + 2 Σ_{t=1}^{W} ρ(t).
///
/// The window W is the larger of two: Wolff's automatic one, where the truncation error exp(−W/τ)
/// falls below the noise √(W/n), and the lag after which ρ stays inside its own noise, which a
/// correlation that oscillates reaches later. The bias of the estimated mean is taken out by the factor
/// 1 + (2W + 1)/n. Where the correlation is longer than 256 samples, neighbors are averaged in pairs
/// first, which leaves the error of the mean as it is.
///
/// Source: U. Wolff, "Monte Carlo errors with less errors", Comput. Phys. Commun. 156, 143 (2004),
/// equations 31, 49 and 52; M. S. Bartlett's formula for the noise of ρ.
#[must_use]
pub fn autocorrelation_time(series: &[f64]) -> Autocorrelation {
    let n = series.len();
    let variance_of_samples = if n < 2 { 0.0 } else { variance(series) };
    if variance_of_samples.is_nan() || variance_of_samples <= 0.0 {
        return Autocorrelation {
            inefficiency: 1.0,
            window: 0,
            decayed: true,
        };
    }
    let smallest = (SMALLEST_INEFFICIENCY_ROOT_N / (n as f64).sqrt()).min(1.0);
    let mut blocks = series.to_vec();
    let mut block = 1;
    loop {
        let found = windowed(&blocks);
        if found.decayed || blocks.len() < SHORTEST_HALVED {
            // g·σ²/n is the squared error of the mean, whichever blocks it is taken from.
            let factor = block as f64 * variance(&blocks) / variance_of_samples;
            return Autocorrelation {
                inefficiency: (found.inefficiency * factor).clamp(smallest, n as f64),
                window: found.window * block,
                decayed: found.decayed,
            };
        }
        blocks = blocks
            .chunks_exact(2)
            .map(|p| 0.5 * (p[0] + p[1]))
            .collect();
        block *= 2;
    }
}

fn windowed(series: &[f64]) -> Autocorrelation {
    let n = series.len() as f64;
    let centred = centred(series);
    let variance = variance(series);
    let last_lag = MOST_LAGS.min(series.len() / 2);
    let mut rho = Vec::with_capacity(last_lag + 1);
    rho.push(1.0);
    // Σρ and Σρ² over the lags so far, and the lag since which ρ has been within its noise.
    let (mut sum, mut squares, mut quiet_since) = (0.0_f64, 0.0_f64, 0);
    let mut automatic = None;
    let inefficiency_at = |window: usize, rho: &[f64]| {
        let sum: f64 = rho[1..=window].iter().sum();
        let bias = 1.0 + (2.0 * window as f64 + 1.0) / n;
        (1.0 + 2.0 * sum) * bias
    };
    for lag in 1..=last_lag {
        let value = covariance(&centred, lag) / variance;
        rho.push(value);
        let noise = ((1.0 + 2.0 * squares) / n).sqrt();
        if value.abs() > QUIET_SIGMAS * noise {
            quiet_since = lag;
        }
        sum += value;
        squares += value * value;
        if automatic.is_none() && past_automatic_window(0.5 + sum, lag as f64, n) {
            automatic = Some(lag);
        }
        if let Some(automatic) = automatic
            && lag >= quiet_since + QUIET_LAGS.max(quiet_since / 2).min(last_lag - quiet_since)
        {
            let window = automatic.max(quiet_since);
            return Autocorrelation {
                inefficiency: inefficiency_at(window, &rho),
                window,
                decayed: window as f64 <= LONGEST_WINDOW * n,
            };
        }
    }
    Autocorrelation {
        inefficiency: inefficiency_at(last_lag, &rho),
        window: last_lag,
        decayed: false,
    }
}

/// Wolff's criterion: the error of truncating at `window` is below the statistical one. The decay time
/// is 1.5/ln((2τ+1)/(2τ−1)) for the integrated time τ so far.
fn past_automatic_window(integrated: f64, window: f64, n: f64) -> bool {
    if integrated <= 0.5 {
        return true;
    }
    let decay = WINDOW_RATIO / ((2.0 * integrated + 1.0) / (2.0 * integrated - 1.0)).ln();
    (-window / decay).exp() < decay / (window * n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::Ar1;
    use super::*;

    #[test]
    fn inefficiency_of_a_first_order_process_is_the_exact_one() {
        // x_{i+1} = φ x_i + noise has ρ(t) = φᵗ and g = (1 + φ)/(1 − φ).
        for (phi, seeds) in [(0.0, 200), (0.5, 200), (0.9, 200), (0.99, 100), (-0.5, 200)] {
            let exact = (1.0 + phi) / (1.0 - phi);
            let n = 16_384;
            let found: Vec<f64> = (0..seeds)
                .map(|seed| autocorrelation_time(&Ar1::new(phi, seed).series(n)).inefficiency)
                .collect();
            let average = mean(&found) / exact;
            // Wolff's equation 42: a single estimate scatters by √(4W/n) with W ≈ 5τ, τ = g/2; a window
            // found from noisy data leaves a bias of the same order (measured below a third of it).
            // For anticorrelated samples the noise is that of the sum of ρ, not of its small value.
            let large = exact.max(1.0);
            let scatter = (10.0 * large / n as f64).sqrt() * large / exact;
            assert!(
                (average - 1.0).abs() < 0.01 + 0.5 * scatter,
                "φ = {phi}: {average}"
            );
            let spread = variance(&found).sqrt() / exact;
            assert!(spread < 0.02 + 2.0 * scatter, "φ = {phi}: spread {spread}");
        }
    }

    #[test]
    fn an_oscillating_correlation_is_not_cut_at_its_first_trough() {
        // ρ(t) = rᵗ cos(ωt) of a damped rotation: g = 1 + 2 Re[z/(1 − z)], z = r e^{iω}.
        let (r, omega) = (0.97_f64, 0.3_f64);
        let (re, im) = (r * omega.cos(), r * omega.sin());
        let denominator = (1.0 - re).powi(2) + im * im;
        let exact = 1.0 + 2.0 * (re * (1.0 - re) - im * im) / denominator;
        let n = 32_768;
        let found: Vec<f64> = (0..40)
            .map(|seed| {
                let series = super::super::synthetic::damped_rotation(r, omega, seed, n);
                autocorrelation_time(&series).inefficiency
            })
            .collect();
        // exact = 0.62 here, small beside the decay time 1/(1 − r) = 33 that sets the noise √(4·33/n)·2τ.
        assert!(
            (mean(&found) - exact).abs() < 0.25 * exact + 0.1,
            "{} against {exact}",
            mean(&found)
        );
    }

    #[test]
    fn constant_and_tiny_series_have_no_correlation_time() {
        for series in [vec![], vec![1.0], vec![0.1; 1000]] {
            let found = autocorrelation_time(&series);
            assert_eq!(found.inefficiency, 1.0);
        }
    }

    #[test]
    fn a_series_that_never_decays_says_so() {
        let ramp: Vec<f64> = (0..800).map(f64::from).collect();
        let found = autocorrelation_time(&ramp);
        assert!(!found.decayed && found.inefficiency > 50.0, "{found:?}");
    }
}
