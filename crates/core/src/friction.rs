//! Friction and noise on every particle: the Ornstein–Uhlenbeck part of Langevin dynamics.

use crate::exact::{exact_sum_of, total};
use crate::lanes::{Simd, WithSimd, in_lanes};
use crate::normals::LANES;
use crate::parallel::for_each_piece_pair;
use crate::random::NoiseStream;
use crate::{DVec3, Masses, Ramp, Team};

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

impl NoiseOfStep {
    /// Acts on some particles of one mass, whose numbers are `particles`; writes the kinetic energy that each gains, ε.
    ///
    /// # Panics
    /// Where lengths differ: that is a bug of the caller.
    #[inline(always)]
    pub fn act(&self, mass: f64, particles: &[u32], velocities: &mut [DVec3], gained: &mut [f64]) {
        let scales = self.scales(mass);
        self.act_by(|_| scales, particles, velocities, gained);
    }

    /// The width of the noise of a particle and half its mass. A held particle has an infinite mass and stays at rest.
    fn scales(&self, mass: f64) -> [f64; 2] {
        let weight = if mass.is_finite() { 0.5 * mass } else { 0.0 };
        [(self.variance / mass).sqrt(), weight]
    }

    /// As [`NoiseOfStep::act`], with the scales of the `k`th particle.
    #[inline(always)]
    fn act_by(
        &self,
        scales: impl Fn(usize) -> [f64; 2],
        particles: &[u32],
        velocities: &mut [DVec3],
        gained: &mut [f64],
    ) {
        assert!(
            particles.len() == velocities.len() && particles.len() == gained.len(),
            "one number for each particle"
        );
        let (blocks, last) = particles.as_chunks();
        let (all_velocities, last_velocities) = velocities.as_chunks_mut();
        let (all_gained, last_gained) = gained.as_chunks_mut();
        let parts = all_velocities.iter_mut().zip(all_gained);
        for (block, (numbers, (velocities, gained))) in blocks.iter().zip(parts).enumerate() {
            let scales = |k: usize| scales(block * LANES + k);
            self.act_on_block(scales, numbers, velocities, gained);
        }
        if last.is_empty() {
            return;
        }
        let n = last.len();
        let mut numbers = [0; LANES];
        numbers[..n].copy_from_slice(last);
        let [x, y, z] = self.noise.normals(self.step, numbers);
        for (k, (v, gained)) in last_velocities.iter_mut().zip(last_gained).enumerate() {
            let noise = DVec3::new(x[k], y[k], z[k]);
            (*v, *gained) = self.act_on_one(scales(particles.len() - n + k), *v, noise);
        }
    }

    /// Acts on a whole block, with loops of one length that a compiler puts into lanes.
    #[inline(always)]
    fn act_on_block(
        &self,
        scales: impl Fn(usize) -> [f64; 2],
        numbers: &[u32; LANES],
        velocities: &mut [DVec3; LANES],
        gained: &mut [f64; LANES],
    ) {
        let [x, y, z] = self.noise.normals(self.step, *numbers);
        for k in 0..LANES {
            let noise = DVec3::new(x[k], y[k], z[k]);
            (velocities[k], gained[k]) = self.act_on_one(scales(k), velocities[k], noise);
        }
    }

    /// The velocity of a particle after friction and noise, and the kinetic energy that it gains, ε.
    #[inline(always)]
    fn act_on_one(&self, [width, weight]: [f64; 2], v: DVec3, noise: DVec3) -> (DVec3, f64) {
        let next = self.keep * v + width * noise;
        (next, weight * (next.length_squared() - v.length_squared()))
    }

    /// Acts on all particles, `[N]`; returns the kinetic energy that they gain, ε.
    pub fn act_on_all(&self, masses: &Masses, velocities: &mut [DVec3]) -> f64 {
        let mut gained = vec![0.0; velocities.len()];
        for_each_piece_pair(velocities, &mut gained, |first, velocities, gained| {
            in_lanes(OnPiece {
                noise: self,
                masses,
                first,
                velocities,
                gained,
            });
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

impl WithSimd for OnPiece<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let (noise, masses) = (self.noise, self.masses);
        let blocks = self.velocities.chunks_mut(LANES);
        let blocks = blocks.zip(self.gained.chunks_mut(LANES)).enumerate();
        for (block, (velocities, gained)) in blocks {
            let first = self.first + block * LANES;
            let numbers: [u32; LANES] = std::array::from_fn(|k| (first + k) as u32);
            let numbers = &numbers[..velocities.len()];
            let scales = |k: usize| noise.scales(masses.of(first + k));
            noise.act_by(scales, numbers, velocities, gained);
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
        Self {
            noise,
            dt,
            step,
            heats: Vec::new(),
        }
    }

    /// Friction and noise of the next step.
    #[must_use]
    pub fn next_step(&self) -> NoiseOfStep {
        self.noise.in_step(self.step, self.dt)
    }

    /// Ends a step in which the particles gained so much kinetic energy, `[N]`, ε. With a team, they belong to one rank.
    pub fn pass(&mut self, gained: &[f64], team: Option<&Team>) {
        self.step += 1;
        self.heats.push(exact_sum_of(team, gained, |x| *x));
    }

    /// The heats of the steps so far, ε.
    #[must_use]
    pub fn into_heats(self) -> Vec<f64> {
        self.heats
    }
}
