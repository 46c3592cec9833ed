//! Friction and noise on every particle: the Ornstein–Uhlenbeck part of Langevin dynamics.

use crate::exact::{exact_sum_over, total};
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
        let parts = particles.chunks(LANES).zip(velocities.chunks_mut(LANES));
        let parts = parts.zip(gained.chunks_mut(LANES)).enumerate();
        for (block, ((numbers, velocities), gained)) in parts {
            let mut all = [0; LANES];
            all[..numbers.len()].copy_from_slice(numbers);
            let [x, y, z] = self.noise.normals(self.step, all);
            for (k, (v, gained)) in velocities.iter_mut().zip(gained).enumerate() {
                let [width, weight] = scales(block * LANES + k);
                let before = v.length_squared();
                *v = self.keep * *v + width * DVec3::new(x[k], y[k], z[k]);
                *gained = weight * (v.length_squared() - before);
            }
        }
    }

    /// Acts on all particles, `[N]`; returns the kinetic energy that they gain, ε.
    pub fn act_on_all(&self, masses: &Masses, velocities: &mut [DVec3]) -> f64 {
        let mut gained = vec![0.0; velocities.len()];
        for_each_piece_pair(velocities, &mut gained, |first, velocities, gained| {
            let blocks = velocities.chunks_mut(LANES).zip(gained.chunks_mut(LANES));
            for (block, (velocities, gained)) in blocks.enumerate() {
                let first = first + block * LANES;
                let numbers: [u32; LANES] = std::array::from_fn(|k| (first + k) as u32);
                match masses {
                    Masses::Uniform(mass) => {
                        self.act(*mass, &numbers[..velocities.len()], velocities, gained);
                    }
                    Masses::Each(masses) => {
                        let scales = |k: usize| self.scales(masses[first + k]);
                        self.act_by(scales, &numbers[..velocities.len()], velocities, gained);
                    }
                }
            }
        });
        total(&gained)
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
        self.heats
            .push(exact_sum_over(team, gained.len(), |i| gained[i]));
    }

    /// The heats of the steps so far, ε.
    #[must_use]
    pub fn into_heats(self) -> Vec<f64> {
        self.heats
    }
}
