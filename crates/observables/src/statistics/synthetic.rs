//! Series with known statistics, for tests.

use lennard_core::random::Streams;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

use super::{mean, variance};
use crate::Estimate;

/// The root mean square of printed errors, and the spread of the means over it.
pub(crate) fn printed_and_spread(found: &[Estimate]) -> (f64, f64) {
    let values: Vec<f64> = found.iter().map(|e| e.mean).collect();
    let squares: Vec<f64> = found.iter().map(|e| e.standard_error.powi(2)).collect();
    let n = found.len() as f64;
    let printed = mean(&squares).sqrt();
    (printed, (variance(&values) * n / (n - 1.0)).sqrt() / printed)
}

/// Wants estimates whose mean is this number up to four errors and a rest, and whose spread is the printed error up to a tolerance.
#[track_caller]
pub(crate) fn cover(found: &[Estimate], exact: f64, rest: f64, tolerance: f64) {
    let (printed, ratio) = printed_and_spread(found);
    let values: Vec<f64> = found.iter().map(|e| e.mean).collect();
    let off = (mean(&values) - exact).abs();
    assert!(off < 4.0 * printed / (found.len() as f64).sqrt() + rest, "{off} of {exact}");
    assert!((ratio - 1.0).abs() < tolerance, "{ratio}");
    assert!(printed < 0.1 * exact.abs(), "{printed}");
}

/// The autoregressive process x_{i+1} = φ x_i + √(1 − φ²) ξ with unit variance and ρ(t) = φᵗ.
pub(crate) struct Ar1 {
    phi: f64,
    seed: u64,
}

impl Ar1 {
    pub(crate) fn new(phi: f64, seed: u64) -> Self {
        Self { phi, seed }
    }

    pub(crate) fn series(&self, n: usize) -> Vec<f64> {
        let noise = Streams::new(self.seed).noise("ar1");
        let normal = |i: u64| -> f64 { StandardNormal.sample(&mut noise.at(i, 0)) };
        let strength = (1.0 - self.phi * self.phi).sqrt();
        let mut x = normal(u64::MAX);
        (0..n as u64)
            .map(|i| {
                x = self.phi * x + strength * normal(i);
                x
            })
            .collect()
    }
}

/// The first component of z_{i+1} = r e^{iω} z_i + noise: unit variance, ρ(t) = rᵗ cos ωt.
pub(crate) fn damped_rotation(r: f64, omega: f64, seed: u64, n: usize) -> Vec<f64> {
    let noise = Streams::new(seed).noise("rotation");
    let strength = (1.0 - r * r).sqrt();
    let pair = |i: u64| -> (f64, f64) {
        (StandardNormal.sample(&mut noise.at(i, 0)), StandardNormal.sample(&mut noise.at(i, 1)))
    };
    let (mut x, mut y) = pair(u64::MAX);
    (0..n as u64)
        .map(|i| {
            let (a, b) = pair(i);
            (x, y) = (
                r * (omega.cos() * x - omega.sin() * y) + strength * a,
                r * (omega.sin() * x + omega.cos() * y) + strength * b,
            );
            x
        })
        .collect()
}

/// The momentum per time that `particles` of unit mass hand to one of two thermal walls at T = 1, in each of `n` times of `interval`
/// τ. They fly `apart` σ from wall to wall without collisions.
pub(crate) fn free_gas_between_thermal_walls(
    seed: u64,
    particles: u64,
    apart: f64,
    interval: f64,
    n: usize,
) -> Vec<f64> {
    let noise = Streams::new(seed).noise("free gas");
    let mut series = vec![0.0; n];
    for particle in 0..particles {
        let mut rng = noise.at(particle, 0);
        let mut uniform = || -> f64 { StandardUniform.sample(&mut rng) };
        // Where and how fast a flight of the equilibrium is met.
        let mut goes_up = uniform() < 0.5;
        let left = apart * uniform();
        let mut speed: f64 = StandardNormal.sample(&mut noise.at(particle, 1));
        let mut time = left / speed.abs();
        while time < interval * n as f64 {
            let arrives = speed.abs();
            // A wall sends particles off with the density v·exp(−v²/2) of their speeds.
            speed = (-2.0 * (1.0 - uniform()).ln()).sqrt();
            if goes_up {
                series[(time / interval) as usize] += (arrives + speed) / interval;
            }
            goes_up = !goes_up;
            time += apart / speed;
        }
    }
    series
}
