//! What moves the particles of a chunk, once their forces are known.
//!
//! ```text
//!   Drift   v += kick, v += kick                       x += h·v
//!   Noise   v += kick, v += kick    x += ½h·v    friction and noise    x += ½h·v
//!   Kick    K of v + kick           forces are kept: a bath scales all velocities between the kicks
//! ```

use std::ops::Range;

use glam::DVec3;
use lennard_core::exact::{PartSum, SumOfParts};
use lennard_core::parallel::for_each_piece_pair;
use lennard_core::{Aligned, NOISE_LANES, NoiseOfMass, NoiseOfStep};
use lennard_neighbor::ATOMS_PER_CHUNK;

use super::disjoint::Disjoint;
use super::kick_drift::{KickDrift, components, components_mut};
use super::level::Level;

const _: () = assert!(
    ATOMS_PER_CHUNK <= NOISE_LANES && ATOMS_PER_CHUNK <= SumOfParts::MOST_TERMS,
    "a chunk is one part of a sum, and draws its noise at once"
);

/// What moves the particles of a chunk.
pub enum Mover<'a> {
    /// Two half kicks and a drift.
    Drift,
    /// Two half kicks, and friction and noise between two half drifts. The sum is over the kinetic energy that they put in, ε.
    Noise(SlotNoise<'a>, SumOverChunks<'a>),
    /// The kinetic energy after half a kick is summed, ε; velocities stay, and the forces by slot are kept, ε/σ.
    Kick {
        /// The forces.
        forces: Disjoint<'a, DVec3>,
        /// The mass of each particle.
        mass: f64,
        /// The sum of the kinetic energy.
        sum: SumOverChunks<'a>,
    },
}

/// An exact sum over all particles, to which each chunk gives its part.
pub struct SumOverChunks<'a> {
    sum: &'a SumOfParts,
    parts: Disjoint<'a, PartSum>,
}

impl<'a> SumOverChunks<'a> {
    /// A sum over `n` particles, whose parts go to an array. Where there are ranks, the chunks of others give nothing.
    pub fn begin(sum: &'a mut SumOfParts, parts: &'a mut Vec<PartSum>, n: usize) -> Self {
        sum.begin();
        parts.clear();
        parts.resize(n.div_ceil(ATOMS_PER_CHUNK), PartSum::default());
        Self { sum, parts: Disjoint::new(parts) }
    }

    /// Gives the terms of the particles of a chunk.
    ///
    /// # Safety
    /// No other thread gives the terms of this chunk.
    pub unsafe fn give(&self, chunk: usize, terms: &[f64]) {
        // SAFETY: the contract is passed on.
        unsafe { self.parts.write(chunk, self.sum.part(terms)) };
    }
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
        Self { particles: &self.particles[slots], ..self }
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
    /// Writes the kinetic energies ½m·|v + (h/2m)·F|² after half a kick, which scaling gives later, ε.
    pub fn kinetic_after_kick(
        self,
        level: Level,
        mass: f64,
        velocities: &[DVec3],
        forces: &[DVec3],
        kinetic: &mut [f64],
    ) {
        match level {
            // SAFETY: the level holds a token, which proves the instruction set.
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(_) => unsafe { self.kinetic_avx512(mass, velocities, forces, kinetic) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(_) => unsafe { self.kinetic_avx2(mass, velocities, forces, kinetic) },
            _ => self.kinetic_plain(mass, velocities, forces, kinetic),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2")]
    fn kinetic_avx512(
        self,
        mass: f64,
        velocities: &[DVec3],
        forces: &[DVec3],
        kinetic: &mut [f64],
    ) {
        self.kinetic_plain(mass, velocities, forces, kinetic);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn kinetic_avx2(self, mass: f64, velocities: &[DVec3], forces: &[DVec3], kinetic: &mut [f64]) {
        self.kinetic_plain(mass, velocities, forces, kinetic);
    }

    #[inline(always)]
    fn kinetic_plain(self, mass: f64, velocities: &[DVec3], forces: &[DVec3], kinetic: &mut [f64]) {
        let Aligned(squares) = &mut Aligned([0.0; 3 * ATOMS_PER_CHUNK]);
        let (velocities, forces) = (components(velocities), components(forces));
        for ((square, v), f) in squares.iter_mut().zip(velocities).zip(forces) {
            let v = *v + self.half_kick * *f;
            *square = v * v;
        }
        for (kinetic, [x, y, z]) in kinetic.iter_mut().zip(squares.as_chunks::<3>().0) {
            *kinetic = 0.5 * mass * (x + y + z);
        }
    }

    /// Kicks by half, scales, and goes on: v ← factor·(v + (h/2m)·F) + (h/2m)·F, then x ← x + h·v.
    pub fn kick_scale_and_go_on(
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
            let kick = self.half_kick * *f;
            *v += kick;
            *v *= factor;
            *v += kick;
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
        let Moving { positions, velocities, forces, gained } = moving;
        let of_mass = noise.of_step.on(noise.mass);
        let Aligned(normals) = &noise.of_step.normals(noise.particles);
        let Aligned(grown) = &mut Aligned([0.0; 3 * NOISE_LANES]);
        let (mut longest, mut longest_of_rest) = ([0.0; GROUP], [0.0; 3]);
        let (x, x_rest) = components_mut(positions).as_chunks_mut::<GROUP>();
        let (v, v_rest) = components_mut(velocities).as_chunks_mut::<GROUP>();
        let (f, f_rest) = components(forces).as_chunks::<GROUP>();
        let (normals, grown_by) = (normals.as_chunks().0, grown.as_chunks_mut().0);
        let groups = x.iter_mut().zip(v).zip(f).zip(normals).zip(&mut *grown_by);
        let whole = groups.len();
        for ((((x, v), f), normals), grown) in groups {
            self.kick_drift_and_noise(of_mass, (x, v, f), normals, grown, &mut longest);
        }
        let (x, v) = (x_rest.as_chunks_mut::<3>().0, v_rest.as_chunks_mut().0);
        let normals = normals[whole..].as_flattened().as_chunks().0;
        let grown_by = grown_by[whole..].as_flattened_mut().as_chunks_mut().0;
        let rest = x.iter_mut().zip(v).zip(f_rest.as_chunks().0);
        for ((((x, v), f), normals), grown) in rest.zip(normals).zip(grown_by) {
            self.kick_drift_and_noise(of_mass, (x, v, f), normals, grown, &mut longest_of_rest);
        }
        for (gained, grown) in gained.iter_mut().zip(grown.as_chunks().0) {
            *gained = of_mass.gained(*grown);
        }
        // The factor covers the rounding of the bound.
        let of_rest = DVec3::from_array(longest_of_rest);
        longest_along_axes(longest).max(of_rest).length() * (1.0 + 1e-12)
    }

    /// Moves some components. What the squares of v gain by friction and noise is written to `grown`, and the longest step of
    /// each component is kept.
    #[inline(always)]
    fn kick_drift_and_noise<const N: usize>(
        self,
        noise: NoiseOfMass,
        (x, v, f): (&mut [f64; N], &mut [f64; N], &[f64; N]),
        normals: &[f32; N],
        grown: &mut [f64; N],
        longest: &mut [f64; N],
    ) {
        let half = 0.5 * self.dt;
        for k in 0..N {
            let kick = self.half_kick * f[k];
            let before = v[k] + kick + kick;
            let at_noise = x[k] + half * before;
            let next = noise.next(before, normals[k]);
            let after = at_noise + half * next;
            longest[k] = larger((after - x[k]).abs(), longest[k]);
            grown[k] = next * next - before * before;
            x[k] = after;
            v[k] = next;
        }
    }
}

/// Components of eight vectors, which fill whole registers.
const GROUP: usize = 24;

/// The longest steps along x, y and z.
// The loops have lengths that a compiler knows, so that the steps stay in registers before them.
#[inline(always)]
fn longest_along_axes(mut longest: [f64; GROUP]) -> DVec3 {
    for half in [GROUP / 2, GROUP / 4, GROUP / 8] {
        for k in 0..half {
            longest[k] = larger(longest[k + half], longest[k]);
        }
    }
    DVec3::new(longest[0], longest[1], longest[2])
}

/// The larger of two numbers; the second where one is no number.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
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
        let kick_drift = KickDrift { half_kick: 0.002, dt: 0.004 };
        let wave = |k: usize| (k as f64 * 12.9898).sin();
        let vectors = |from: usize, n: usize| -> Vec<DVec3> {
            let at = |k: usize| DVec3::new(wave(k), wave(k + 700), wave(k + 1400));
            (from..from + n).map(at).collect()
        };
        for n in [0, 1, 15, 16, 17, ATOMS_PER_CHUNK] {
            let particles: Vec<u32> = (0..n as u32).map(|k| 7919 * k % 1000).collect();
            let of_chunk =
                SlotNoise { of_step: noise.in_step(12, 0.004), mass: 1.5, particles: &particles };
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
