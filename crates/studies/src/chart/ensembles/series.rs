//! The volume of a run, step by step.

use lennard_core::Want;
use lennard_engine::{Action, EngineError, Follower, Operation, Schedule, Simulation, Trigger};
use lennard_observables::statistics;
use std::ops::ControlFlow;

use crate::lab::Value;

/// Follows a run and keeps its volume after a step from which on it counts.
pub(super) struct Volumes {
    every: u64,
    from: u64,
    schedule: Schedule,
    /// σ³.
    pub found: Vec<f64>,
}

impl Volumes {
    /// Looks every so many steps, after the first `from`.
    pub fn new(every: u64, from: u64) -> Self {
        let look = Operation::new(Action::Call, Trigger::Every(every)).wanting(Want::NOTHING);
        Self { every, from, schedule: Schedule::empty().with(look), found: Vec::new() }
    }
}

impl Follower for Volumes {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        let step = simulation.state.step;
        if step.is_multiple_of(self.every) && step > self.from {
            self.found.push(simulation.state.cell.volume());
        }
        Ok(ControlFlow::Continue(()))
    }
}

/// The variance of a correlated series with its standard error: the mean square about the mean, over 1 − 1/n for n independent
/// samples.
pub(super) fn variance(series: &[f64]) -> Value {
    let mean = statistics::estimate_stationary(series);
    let squares: Vec<f64> = series.iter().map(|x| (x - mean.mean).powi(2)).collect();
    let found = statistics::estimate_stationary(&squares);
    let n = mean.n_effective.max(2.0);
    let unbiased = n / (n - 1.0);
    Value {
        mean: unbiased * found.mean,
        standard_error: unbiased * found.standard_error,
        n_effective: found.n_effective,
    }
}

#[cfg(test)]
mod tests {
    use lennard_core::random::Streams;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn the_variance_of_a_correlated_series_is_within_its_error() {
        // xᵢ = 0.9·xᵢ₋₁ + noise: a variance of 1/(1 − 0.81), and some 19 samples for each independent one.
        let noise = Streams::new(8).noise("series");
        let mut x = 0.0;
        let series: Vec<f64> = (0..40_000)
            .map(|i| {
                let random: f64 = StandardNormal.sample(&mut noise.at(i, 0));
                x = 0.9 * x + random;
                x
            })
            .collect();
        let found = variance(&series);
        let exact = 1.0 / (1.0 - 0.81);
        assert!((found.mean - exact).abs() < 4.0 * found.standard_error, "{found:?}");
        // √(2/n) for n ≈ 40000·(1 − 0.81)/(1 + 0.81) squares.
        assert!((0.01..0.06).contains(&(found.standard_error / exact)), "{found:?}");
        // The bias of a short series is taken out: without it the mean would be 1 − 19/200 of the truth.
        let parts: Vec<f64> = series.chunks(200).map(|part| variance(part).mean).collect();
        let mean = statistics::mean(&parts);
        assert!((mean / exact - 1.0).abs() < 0.05, "{mean}");
    }
}
