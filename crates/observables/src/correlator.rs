//! The multiple-tau correlator: autocorrelations over many decades of time in bounded memory.

use std::collections::VecDeque;

use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

use crate::blocks::BlockedSums;

/// Values that each level remembers.
const POINTS: usize = 16;

#[derive(Debug, Clone, Default, PartialEq)]
struct Level {
    /// Latest first, each `channels` values.
    history: VecDeque<Vec<f64>>,
    /// The first of a pair that waits for its partner before it goes to the next level.
    waiting: Option<Vec<f64>>,
}

/// The autocorrelation C(t) = ⟨a(t₀)·a(t₀ + t)⟩ of one or several equivalent channels, averaged over channels.
///
/// Level 0 sees every sample and serves lags of 0 to 15 samples. Level ℓ sees the means of pairs of the level
/// before, and serves lags of 8·2^ℓ to 15·2^ℓ. The averaging blurs the function by 2^ℓ samples, at lags at
/// least eight times as long. Its integral stays the same where the function is smooth. The mean is not
/// subtracted.
///
/// Source: J. Ramírez, S. K. Sukumaran, B. Vorselaars and A. E. Likhtman, "Efficient on the fly calculation
/// of time correlation functions in computer simulations", J. Chem. Phys. 133, 154103 (2010), section III.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlator {
    channels: usize,
    interval: f64,
    levels: Vec<Level>,
    products: BlockedSums,
}

/// A correlation function with its errors and its running integral.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Lags in τ, rising from 0.
    pub times: Vec<f64>,
    /// C at each lag.
    pub values: Vec<f64>,
    /// Standard errors from blocks of the run.
    pub errors: Vec<f64>,
    /// ∫₀^t C by the trapezoidal rule.
    pub integral: Vec<f64>,
    /// Standard errors of the integral.
    pub integral_errors: Vec<f64>,
}

impl Correlator {
    /// Nothing seen yet: `channels` values a sample, samples `interval` τ apart, lags up to at least
    /// `longest_lag` τ.
    pub fn new(channels: usize, interval: f64, longest_lag: f64) -> Self {
        let reach = (POINTS - 1) as f64 * interval;
        let levels = (longest_lag / reach).log2().ceil().clamp(0.0, 40.0) as usize + 1;
        Self {
            channels,
            interval,
            levels: vec![Level::default(); levels],
            products: BlockedSums::new(levels * POINTS),
        }
    }

    /// The same without the products that end in the first `discarded` part of the samples, from 0 to 1.
    pub fn after(&self, discarded: f64) -> Self {
        Self { products: self.products.after(discarded), ..self.clone() }
    }

    /// Takes one sample, one value for each channel.
    ///
    /// # Panics
    /// Where their number is not the number of channels: that is a bug of the caller.
    pub fn push(&mut self, sample: &[f64]) {
        assert_eq!(sample.len(), self.channels, "one value for each channel");
        self.products.begin_sample();
        let mut value = sample.to_vec();
        for (l, level) in self.levels.iter_mut().enumerate() {
            level.history.truncate(POINTS - 1);
            level.history.push_front(value);
            let now = &level.history[0];
            for (lag, then) in level.history.iter().enumerate().skip(first_lag(l)) {
                let sum: f64 = now.iter().zip(then).map(|(a, b)| a * b).sum();
                self.products.add(l * POINTS + lag, sum / self.channels as f64, 1);
            }
            match level.waiting.take() {
                None => {
                    level.waiting = Some(now.clone());
                    return;
                }
                Some(first) => {
                    value = first.iter().zip(now).map(|(a, b)| 0.5 * (a + b)).collect();
                }
            }
        }
    }

    /// The running integral of each block of the run, up to the lag with index `last` of
    /// [`Correlator::correlation`]. The errors of numbers made from the integral come from it.
    pub fn integral_blocks(&self, last: usize) -> Vec<Vec<f64>> {
        let (lags, quantities) = self.reached();
        let end = last.min(quantities.len().saturating_sub(1));
        let times: Vec<f64> = lags.iter().take(end + 1).map(|lag| lag * self.interval).collect();
        self.products
            .complete_rows(&quantities[..times.len()])
            .iter()
            .map(|row| running_integral(&times, row))
            .collect()
    }

    /// The lags that were reached, in samples, and where their sums are.
    fn reached(&self) -> (Vec<f64>, Vec<usize>) {
        (0..self.levels.len())
            .flat_map(|l| (first_lag(l)..POINTS).map(move |k| ((k << l) as f64, l * POINTS + k)))
            .filter(|(_, q)| self.products.total(*q).1 > 0)
            .unzip()
    }

    /// What was found so far, at the lags that were reached.
    pub fn correlation(&self) -> Correlation {
        let (lags, quantities) = self.reached();
        let times: Vec<f64> = lags.iter().map(|lag| lag * self.interval).collect();
        let values: Vec<f64> = quantities.iter().filter_map(|q| self.products.mean(*q)).collect();
        let integral = running_integral(&times, &values);
        let errors = quantities.iter().map(|q| self.products.standard_error(*q)).collect();
        let integral_errors = (0..quantities.len())
            .map(|end| {
                let blocks: Vec<f64> = self
                    .products
                    .complete_rows(&quantities[..=end])
                    .iter()
                    .map(|row| running_integral(&times[..=end], row)[end])
                    .collect();
                crate::statistics::error_of_mean(&blocks).standard_error
            })
            .collect();
        Correlation { times, values, errors, integral, integral_errors }
    }
}

/// The lower half of the lags of every level but the first belongs to the level before.
fn first_lag(level: usize) -> usize {
    if level == 0 { 0 } else { POINTS / 2 }
}

fn running_integral(times: &[f64], values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    (0..times.len())
        .map(|k| {
            if k > 0 {
                sum += 0.5 * (values[k] + values[k - 1]) * (times[k] - times[k - 1]);
            }
            sum
        })
        .collect()
}

impl Persist for Correlator {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { channels: _, interval: _, levels, products } = self;
        products.save(&mut to.section("products"));
        for (l, Level { history, waiting }) in levels.iter().enumerate() {
            let history: Vec<f64> = history.iter().flatten().copied().collect();
            to.put_f64(&format!("level_{l}"), &history);
            to.put_f64(&format!("waiting_{l}"), waiting.as_deref().unwrap_or_default());
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.products.restore(&from.section("products"))?;
        for (l, level) in self.levels.iter_mut().enumerate() {
            let name = format!("level_{l}");
            let history = from.f64(&name)?;
            let rows = history.len() / self.channels;
            if history.len() != rows * self.channels || rows > POINTS {
                return Err(from.misfit(&name, format!("{} values", history.len())));
            }
            let name = format!("waiting_{l}");
            let waiting = from.f64(&name)?;
            if !(waiting.is_empty() || waiting.len() == self.channels) {
                return Err(from.misfit(&name, format!("{} values", waiting.len())));
            }
            level.history = history.chunks(self.channels).map(<[f64]>::to_vec).collect();
            level.waiting = (!waiting.is_empty()).then(|| waiting.to_vec());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::synthetic::Ar1;

    fn channels(n: usize, seed: u64) -> Vec<[f64; 3]> {
        let of = |k| Ar1::new(0.95, 3 * seed + k).series(n);
        let (a, b, c) = (of(0), of(1), of(2));
        (0..n).map(|i| [a[i], b[i], c[i]]).collect()
    }

    #[test]
    fn an_exponential_correlation_is_found_over_all_levels_and_so_is_its_integral() {
        let interval = 0.01;
        let mut correlator = Correlator::new(3, interval, 5.0);
        for sample in channels(60_000, 1) {
            correlator.push(&sample);
        }
        let found = correlator.correlation();
        assert!(*found.times.last().unwrap() >= 5.0);
        assert!(found.times.windows(2).all(|t| t[0] < t[1]));
        for k in 0..found.times.len() {
            let samples = found.times[k] / interval;
            let exact = 0.95_f64.powf(samples);
            // Averaging over 2^ℓ ≤ t/8 samples blurs an exponential by (2^ℓ ln φ)²/12 at most.
            let blur = exact * (samples / 8.0 * 0.95_f64.ln()).powi(2) / 12.0;
            let off = (found.values[k] - exact).abs();
            assert!(off < 5.0 * found.errors[k] + blur + 1e-3, "{samples}: {off}");
        }
        // Trapezoidal sum of φ^k: ½(1 + φ)/(1 − φ) intervals; the coarser lags add below 2 %.
        let exact = 0.5 * 1.95 / 0.05 * interval;
        // Beyond 150 samples the function is below 5e-4 and only noise would be added.
        let end = found.times.partition_point(|t| *t < 1.5);
        let (value, error) = (found.integral[end], found.integral_errors[end]);
        assert!(error < 0.15 * exact);
        assert!((value - exact).abs() < 4.0 * error + 0.02 * exact, "{value} {exact}");
    }

    #[test]
    fn a_constant_has_a_constant_correlation() {
        let mut correlator = Correlator::new(1, 1.0, 200.0);
        (0..1000).for_each(|_| correlator.push(&[2.0]));
        assert!(correlator.correlation().values.iter().all(|c| *c == 4.0));
    }
}
