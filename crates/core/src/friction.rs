//! Friction and noise on every particle: the Ornstein–Uhlenbeck part of Langevin dynamics.

use crate::Ramp;
use crate::aligned::Aligned;
use crate::normals::LANES;
use crate::random::NoiseStream;

/// Friction γ and noise at a temperature, v ← c·v + √((1 − c²)·T/m)·R with c = e^{−γ·dt}: exact over a step.
#[derive(Debug, Clone, Copy)]
pub struct FrictionAndNoise {
    /// γ, τ⁻¹.
    pub friction: f64,
    /// T of the bath, ε/k_B.
    pub temperature: Ramp,
    /// The random numbers, keyed by step and particle.
    pub noise: NoiseStream,
}

/// Friction and noise of one step.
#[derive(Debug, Clone, Copy)]
pub struct NoiseOfStep {
    /// c.
    keep: f64,
    /// (1 − c²)·T, ε.
    variance: f64,
    noise: NoiseStream,
    step: u64,
}

impl FrictionAndNoise {
    /// Friction and noise in the step of `dt` τ that begins at a number of steps.
    #[must_use]
    pub fn in_step(&self, step: u64, dt: f64) -> NoiseOfStep {
        NoiseOfStep {
            keep: (-self.friction * dt).exp(),
            // 1 − c² without cancellation where the friction is small.
            variance: -(-2.0 * self.friction * dt).exp_m1() * self.temperature.at(step),
            noise: self.noise,
            step,
        }
    }
}

/// Friction and noise of one step on particles of one mass.
#[derive(Debug, Clone, Copy)]
pub struct NoiseOfMass {
    /// c.
    keep: f64,
    /// √((1 − c²)·T/m), σ/τ.
    width: f64,
    /// Half the mass.
    half_mass: f64,
}

impl NoiseOfMass {
    /// The next value of one component v of a velocity, with its normal number.
    #[inline(always)]
    #[must_use]
    pub fn next(self, v: f64, normal: f32) -> f64 {
        self.keep * v + self.width * f64::from(normal)
    }

    /// Half the mass; 0 for a held particle, which has no energy.
    #[inline(always)]
    #[must_use]
    pub fn half_mass(self) -> f64 {
        self.half_mass
    }
}

impl NoiseOfStep {
    /// Friction and noise on particles of a mass. A held particle has an infinite mass and stays at rest.
    #[inline(always)]
    #[must_use]
    pub fn on(&self, mass: f64) -> NoiseOfMass {
        NoiseOfMass {
            keep: self.keep,
            width: (self.variance / mass).sqrt(),
            half_mass: if mass.is_finite() { 0.5 * mass } else { 0.0 },
        }
    }

    /// The normal numbers of some particles, whose numbers are `particles`: x, y and z of one after another, then others.
    ///
    /// # Panics
    /// Where there are more than [`LANES`]: that is a bug of the caller.
    #[inline(always)]
    #[must_use]
    pub fn normals(&self, particles: &[u32]) -> Aligned<[f32; 3 * LANES]> {
        let mut numbers = [0; LANES];
        numbers[..particles.len()].copy_from_slice(particles);
        self.noise.normals(self.step, &numbers)
    }
}
