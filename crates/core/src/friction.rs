//! Friction and noise on every particle: the Ornstein–Uhlenbeck part of Langevin dynamics.

use crate::aligned::Aligned;
use crate::exact::total;
use crate::lanes::{Simd, WithSimd, in_lanes};
use crate::normals::LANES;
use crate::parallel::for_each_piece_pair;
use crate::random::NoiseStream;
use crate::{DVec3, Masses, Ramp};

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

    /// The kinetic energy that a particle gains, ε, from what the squares of its three components gain.
    #[inline(always)]
    #[must_use]
    pub fn gained(self, [x, y, z]: [f64; 3]) -> f64 {
        self.half_mass * (x + y + z)
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

    /// Acts on all particles, `[N]`; returns the kinetic energy that they gain, ε.
    pub fn act_on_all(&self, masses: &Masses, velocities: &mut [DVec3]) -> f64 {
        let mut gained = vec![0.0; velocities.len()];
        for_each_piece_pair(velocities, &mut gained, |first, velocities, gained| {
            in_lanes(OnPiece { noise: self, masses, first, velocities, gained });
        });
        total(&gained)
    }
}

/// Friction and noise on a piece of all particles, from the number `first` on.
struct OnPiece<'a> {
    noise: &'a NoiseOfStep,
    masses: &'a Masses,
    first: usize,
    velocities: &'a mut [DVec3],
    gained: &'a mut [f64],
}

impl OnPiece<'_> {
    /// Acts, where `of` gives friction and noise on the `i`th particle.
    #[inline(always)]
    fn act(self, of: impl Fn(usize) -> NoiseOfMass) {
        let blocks = self.velocities.chunks_mut(LANES);
        let blocks = blocks.zip(self.gained.chunks_mut(LANES)).enumerate();
        for (block, (velocities, gained)) in blocks {
            let first = self.first + block * LANES;
            let numbers: [u32; LANES] = std::array::from_fn(|k| (first + k) as u32);
            let Aligned(normals) = &self.noise.normals(&numbers);
            let (normals, _) = normals.as_chunks::<3>();
            let particles = velocities.iter_mut().zip(normals).zip(gained).enumerate();
            for (k, ((v, normals), gained)) in particles {
                let of = of(first + k);
                let before = v.to_array();
                let next = [0, 1, 2].map(|axis| of.next(before[axis], normals[axis]));
                *gained = of.gained(
                    [0, 1, 2].map(|axis| next[axis] * next[axis] - before[axis] * before[axis]),
                );
                *v = DVec3::from_array(next);
            }
        }
    }
}

impl WithSimd for OnPiece<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        match self.masses {
            Masses::Uniform(mass) => {
                let of = self.noise.on(*mass);
                self.act(|_| of);
            }
            Masses::Each(masses) => {
                let noise = self.noise;
                self.act(|i| noise.on(masses[i]));
            }
        }
    }
}

/// Friction and noise in fused steps, between two half drifts.
pub struct FusedNoise {
    noise: FrictionAndNoise,
    dt: f64,
    /// The number of steps at which the next step begins.
    step: u64,
    heats: Vec<f64>,
}

impl FusedNoise {
    /// Friction and noise in steps of `dt` τ, of which the first begins at a number of steps.
    #[must_use]
    pub fn new(noise: FrictionAndNoise, dt: f64, step: u64) -> Self {
        Self { noise, dt, step, heats: Vec::new() }
    }

    /// Friction and noise of the next step.
    #[must_use]
    pub fn next_step(&self) -> NoiseOfStep {
        self.noise.in_step(self.step, self.dt)
    }

    /// Ends a step in which the particles gained so much kinetic energy, ε: an exact total.
    pub fn pass(&mut self, gained: f64) {
        self.step += 1;
        self.heats.push(gained);
    }

    /// The heats of the steps so far, ε.
    #[must_use]
    pub fn into_heats(self) -> Vec<f64> {
        self.heats
    }
}
