//! The multiple-tau correlator: autocorrelations over many decades of time in bounded memory.

use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

use crate::ladder::Ladder;

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
    products: Ladder,
    /// Of each level, the first of a pair that waits for its partner before it goes to the next level.
    waiting: Vec<Option<Vec<f64>>>,
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
        let products = Ladder::new(channels, interval, longest_lag);
        Self { channels, waiting: vec![None; products.levels()], products }
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
        self.products.sums.begin_sample();
        let mut value = sample.to_vec();
        for (l, waiting) in self.waiting.iter_mut().enumerate() {
            self.products.push(l, &value, |now, then| now * then);
            match waiting.take() {
                None => {
                    *waiting = Some(value);
                    return;
                }
                Some(first) => {
                    value = first.iter().zip(&value).map(|(a, b)| 0.5 * (a + b)).collect();
                }
            }
        }
    }

    /// The running integral of each block of the run, up to the lag with index `last` of
    /// [`Correlator::correlation`]. The errors of numbers made from the integral come from it.
    pub fn integral_blocks(&self, last: usize) -> Vec<Vec<f64>> {
        let (times, quantities) = self.products.reached();
        let end = (last + 1).min(quantities.len());
        self.products
            .sums
            .complete_rows(&quantities[..end])
            .iter()
            .map(|row| running_integral(&times[..end], row))
            .collect()
    }

    /// What was found so far, at the lags that were reached.
    pub fn correlation(&self) -> Correlation {
        let (times, quantities) = self.products.reached();
        let sums = &self.products.sums;
        let values: Vec<f64> = quantities.iter().filter_map(|q| sums.mean(*q)).collect();
        let integral = running_integral(&times, &values);
        let errors = quantities.iter().map(|q| sums.standard_error(*q)).collect();
        let integral_errors = (0..quantities.len())
            .map(|end| {
                let blocks: Vec<f64> = sums
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
        let Self { channels: _, products, waiting } = self;
        products.sums.save(&mut to.section("products"));
        products.save(to);
        for (l, waiting) in waiting.iter().enumerate() {
            to.put_f64(&format!("waiting_{l}"), waiting.as_deref().unwrap_or_default());
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.products.sums.restore(&from.section("products"))?;
        self.products.restore(from)?;
        for (l, waiting) in self.waiting.iter_mut().enumerate() {
            let name = format!("waiting_{l}");
            let found = from.f64(&name)?;
            if !(found.is_empty() || found.len() == self.channels) {
                return Err(from.misfit(&name, format!("{} values", found.len())));
            }
            *waiting = (!found.is_empty()).then(|| found.to_vec());
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
