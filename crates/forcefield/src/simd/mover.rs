//! What moves the particles of a chunk, once their forces are known.
//!
//! ```text
//!   Drift   v += kick, v += kick                       x += h·v
//!   Noise   v += kick, v += kick    x += ½h·v    friction and noise    x += ½h·v
//!   Kick    v += kick               forces are kept: a bath scales all velocities before the next kick
//! ```

use std::ops::Range;

use glam::DVec3;
use lennard_core::NoiseOfStep;
use lennard_core::parallel::for_each_piece_pair;

use super::disjoint::Disjoint;
use super::kick_drift::{KickDrift, components, components_mut};
use super::level::Level;

/// What moves the particles of a chunk.
pub enum Mover<'a> {
    /// Two half kicks and a drift.
    Drift,
    /// Two half kicks, and friction and noise between two half drifts.
    ///
    /// The kinetic energy that the particle at each slot gains is written to the array, ε.
    Noise(SlotNoise<'a>, Disjoint<'a, f64>),
    /// One half kick; the forces by slot are kept here, ε/σ.
    Kick(Disjoint<'a, DVec3>),
}

/// Friction and noise on particles by slot.
#[derive(Clone, Copy)]
pub struct SlotNoise<'a> {
    /// Friction and noise of the step.
    pub of_step: NoiseOfStep,
    /// The mass of each particle.
    pub mass: f64,
    /// The particle at each slot.
    pub particles: &'a [u32],
}

impl SlotNoise<'_> {
    /// Friction and noise on the particles at some slots.
    pub fn part(self, slots: Range<usize>) -> Self {
        Self {
            particles: &self.particles[slots],
            ..self
        }
    }
}

/// Particles of a chunk that move, with the forces on them.
pub struct Moving<'a> {
    /// Positions, σ.
    pub positions: &'a mut [DVec3],
    /// Velocities, σ/τ.
    pub velocities: &'a mut [DVec3],
    /// Forces, ε/σ.
    pub forces: &'a [DVec3],
    /// The kinetic energy that each particle gains by friction and noise, ε.
    pub gained: &'a mut [f64],
}

impl KickDrift {
    /// Half a kick: v ← v + (h/2m)·F.
    pub fn half_kick(self, level: Level, velocities: &mut [DVec3], forces: &[DVec3]) {
        match level.avx2() {
            // SAFETY: the token proves AVX2.
            #[cfg(target_arch = "x86_64")]
            Some(_) => unsafe { self.half_kick_avx2(velocities, forces) },
            _ => self.half_kick_plain(velocities, forces),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn half_kick_avx2(self, velocities: &mut [DVec3], forces: &[DVec3]) {
        self.half_kick_plain(velocities, forces);
    }

    #[inline(always)]
    fn half_kick_plain(self, velocities: &mut [DVec3], forces: &[DVec3]) {
        let velocities = components_mut(velocities);
        for (v, f) in velocities.iter_mut().zip(components(forces)) {
            *v += self.half_kick * *f;
        }
    }

    /// Scales all velocities and goes on from there: v ← factor·v + (h/2m)·F, then x ← x + h·v.
    pub fn scale_and_go_on(
        self,
        level: Level,
        factor: f64,
        positions: &mut [DVec3],
        velocities: &mut [DVec3],
        forces: &[DVec3],
    ) {
        for_each_piece_pair(positions, velocities, |first, xs, vs| {
            let forces = &forces[first..];
            match level.avx2() {
                // SAFETY: the token proves AVX2.
                #[cfg(target_arch = "x86_64")]
                Some(_) => unsafe { self.go_on_avx2(factor, xs, vs, forces) },
                _ => self.go_on_plain(factor, xs, vs, forces),
            }
        });
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn go_on_avx2(self, factor: f64, xs: &mut [DVec3], vs: &mut [DVec3], forces: &[DVec3]) {
        self.go_on_plain(factor, xs, vs, forces);
    }

    #[inline(always)]
    fn go_on_plain(self, factor: f64, xs: &mut [DVec3], vs: &mut [DVec3], forces: &[DVec3]) {
        let (xs, vs) = (components_mut(xs), components_mut(vs));
        for ((x, v), f) in xs.iter_mut().zip(vs).zip(components(forces)) {
            *v *= factor;
            *v += self.half_kick * *f;
            *x += self.dt * *v;
        }
    }

    /// Two half kicks, and friction and noise between two half drifts, for the particles of a chunk.
    ///
    /// Returns an upper bound of their steps |x − x_before|, σ.
    pub fn apply_with_noise(self, level: Level, noise: SlotNoise<'_>, moving: Moving<'_>) -> f64 {
        match level {
            // SAFETY: the level holds a token, which proves the instruction set.
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(_) => unsafe { self.noise_avx512(noise, moving) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(_) => unsafe { self.noise_avx2(noise, moving) },
            _ => self.noise_plain(noise, moving),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2")]
    fn noise_avx512(self, noise: SlotNoise<'_>, moving: Moving<'_>) -> f64 {
        self.noise_plain(noise, moving)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn noise_avx2(self, noise: SlotNoise<'_>, moving: Moving<'_>) -> f64 {
        self.noise_plain(noise, moving)
    }

    /// [`KickDrift::apply_with_noise`] with whatever instructions the caller has: the bits are the same.
    #[inline(always)]
    fn noise_plain(self, noise: SlotNoise<'_>, moving: Moving<'_>) -> f64 {
        let Moving {
            positions,
            velocities,
            forces,
            gained,
        } = moving;
        let half = 0.5 * self.dt;
        let mut longest = [[0.0; TWELVE]; 2];
        let (x, x_rest) = components_mut(positions).as_chunks_mut::<TWELVE>();
        let (v, v_rest) = components_mut(velocities).as_chunks_mut::<TWELVE>();
        let (f, f_rest) = components(forces).as_chunks::<TWELVE>();
        let (x_rest, v_rest) = (x_rest.as_chunks_mut::<3>().0, v_rest.as_chunks_mut::<3>().0);
        for ((x, v), f) in x.iter_mut().zip(v).zip(f) {
            self.kick_twice(v, f);
            drift(half, x, v, &mut longest[0]);
        }
        for ((x, v), f) in x_rest.iter_mut().zip(v_rest).zip(f_rest.as_chunks::<3>().0) {
            self.kick_twice(v, f);
            drift(half, x, v, &mut longest[0]);
        }
        noise
            .of_step
            .act(noise.mass, noise.particles, velocities, gained);
        let (v, v_rest) = components(velocities).as_chunks::<TWELVE>();
        for (x, v) in x.iter_mut().zip(v) {
            drift(half, x, v, &mut longest[1]);
        }
        for (x, v) in x_rest.iter_mut().zip(v_rest.as_chunks::<3>().0) {
            drift(half, x, v, &mut longest[1]);
        }
        let [before_noise, after] = longest.map(longest_along_axes);
        // The factor covers the rounding of the bound.
        (before_noise + after).length() * (1.0 + 1e-12)
    }

    /// v ← v + (h/2m)·F twice, for some components.
    #[inline(always)]
    fn kick_twice<const N: usize>(self, v: &mut [f64; N], f: &[f64; N]) {
        for k in 0..N {
            let kick = self.half_kick * f[k];
            v[k] += kick;
            v[k] += kick;
        }
    }
}

/// Components of four vectors.
const TWELVE: usize = 12;

/// x ← x + h·v for some components. The longest steps are kept for each of twelve components that follow each other.
#[inline(always)]
fn drift<const N: usize>(h: f64, x: &mut [f64; N], v: &[f64; N], longest: &mut [f64; TWELVE]) {
    for k in 0..N {
        let before = x[k];
        x[k] += h * v[k];
        let step = (x[k] - before).abs();
        longest[k] = if step > longest[k] { step } else { longest[k] };
    }
}

/// The longest steps along x, y and z.
fn longest_along_axes(of_components: [f64; TWELVE]) -> DVec3 {
    let (vectors, _) = of_components.as_chunks::<3>();
    let vectors = vectors.iter().map(|v| DVec3::from_array(*v));
    vectors.fold(DVec3::ZERO, DVec3::max)
}

#[cfg(test)]
mod tests {
    use lennard_core::FrictionAndNoise;
    use lennard_core::random::Streams;
    use lennard_neighbor::ATOMS_PER_CHUNK;

    use super::super::level::Level;
    use super::*;

    #[test]
    fn every_instruction_set_gives_the_same_bits_for_chunks_of_any_length() {
        let noise = FrictionAndNoise {
            friction: 0.7,
            temperature: 0.9.into(),
            noise: Streams::new(5).noise("langevin"),
        };
        let kick_drift = KickDrift {
            half_kick: 0.002,
            dt: 0.004,
        };
        let wave = |k: usize| (k as f64 * 12.9898).sin();
        let vectors = |from: usize, n: usize| -> Vec<DVec3> {
            let at = |k: usize| DVec3::new(wave(k), wave(k + 700), wave(k + 1400));
            (from..from + n).map(at).collect()
        };
        for n in [0, 1, 15, 16, 17, ATOMS_PER_CHUNK] {
            let particles: Vec<u32> = (0..n as u32).map(|k| 7919 * k % 1000).collect();
            let of_chunk = SlotNoise {
                of_step: noise.in_step(12, 0.004),
                mass: 1.5,
                particles: &particles,
            };
            let start = vectors(0, n);
            let run = |level: Level| {
                let (mut x, mut v) = (start.clone(), vectors(99, n));
                let mut gained = vec![0.0; n];
                let forces = vectors(333, n);
                let moving = Moving {
                    positions: &mut x,
                    velocities: &mut v,
                    forces: &forces,
                    gained: &mut gained,
                };
                let bound = kick_drift.apply_with_noise(level, of_chunk, moving);
                (x, v, gained, bound)
            };
            let plain = run(Level::Portable);
            let steps = plain.0.iter().zip(&start).map(|(x, x0)| (x - x0).length());
            let longest = steps.fold(0.0, f64::max);
            assert!(n == 0 || (longest..1.8 * longest).contains(&plain.3), "{n}");
            for level in Level::available() {
                assert_eq!(run(level), plain, "{level:?}, {n} particles");
            }
        }
    }
}
