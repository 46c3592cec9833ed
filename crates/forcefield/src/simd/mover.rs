//! What moves the particles of a chunk once their forces are known: lists of moves, in the instructions of a level.
//!
//! ```text
//!   Drift   kick, kick, drift
//!   Noise   kick, kick, drift, noise, drift                 with half drifts
//!   Bath    kick, K | scale, kick, drift                    the bath has the factor between the two passes
//! ```

use std::ops::Range;

use glam::DVec3;
use lennard_core::exact::{PartSum, SumOfParts};
use lennard_core::moves::{BLOCK, Bound, Component, Energies, GROUP, Noise, Report};
use lennard_core::{Moving, NoiseOfMass, NoiseOfStep};
use lennard_neighbor::ATOMS_PER_CHUNK;

use super::disjoint::Disjoint;
use super::level::Level;

const _: () = assert!(
    ATOMS_PER_CHUNK <= BLOCK && ATOMS_PER_CHUNK <= SumOfParts::MOST_TERMS,
    "a chunk is one part of a sum, and moves at once"
);

/// Kicks and drift of particles of one mass.
#[derive(Debug, Clone, Copy)]
pub struct KickDrift {
    /// Half a time step over the mass, τ.
    pub half_kick: f64,
    /// The time step, τ.
    pub dt: f64,
}

impl KickDrift {
    /// Two half kicks and a drift.
    #[inline(always)]
    pub fn step(self, c: Component) -> Component {
        c.kick(self.half_kick).kick(self.half_kick).drift(self.dt)
    }

    /// Two half kicks, and friction and noise between two half drifts.
    #[inline(always)]
    pub fn step_with_noise(self, noise: NoiseOfMass, c: Component) -> Component {
        let half = 0.5 * self.dt;
        c.kick(self.half_kick).kick(self.half_kick).drift(half).noise(noise).drift(half)
    }

    /// Half a kick, with the square of the velocity, which the bath asks for.
    #[inline(always)]
    pub fn up_to_bath(self, c: Component) -> Component {
        c.kick(self.half_kick).square()
    }

    /// The factor of the bath, the other half kick, and the drift.
    #[inline(always)]
    pub fn on_from_bath(self, factor: f64, c: Component) -> Component {
        c.scale(factor).kick(self.half_kick).drift(self.dt)
    }
}

/// What moves the particles of a chunk.
pub enum Mover<'a> {
    /// Two half kicks and a drift.
    Drift,
    /// The same with noise. The sum is over the kinetic energy that friction and noise put in, ε.
    Noise(SlotNoise<'a>, SumOverChunks<'a>),
    /// Half a kick. The kinetic energy is summed, ε, positions stay, and the forces by slot are kept, ε/σ.
    Bath {
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
    /// A sum over the particles of so many chunks, whose parts go to an array. Where there are ranks, the chunks of others give nothing.
    pub fn begin(sum: &'a mut SumOfParts, parts: &'a mut Vec<PartSum>, chunks: usize) -> Self {
        sum.begin();
        parts.clear();
        parts.resize(chunks, PartSum::default());
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

/// Moves the particles of a chunk, whose forces are known; returns an upper bound of their steps |x − x_before|, σ.
///
/// # Safety
/// No other thread runs this chunk, whose slots are given.
pub unsafe fn move_chunk(
    level: Level,
    kick_drift: KickDrift,
    mover: &Mover<'_>,
    (chunk, slots): (usize, Range<usize>),
    moving: Moving<'_>,
) -> f64 {
    let room = || [0.0; ATOMS_PER_CHUNK];
    match mover {
        Mover::Drift => run(level, moving, &mut Bound, move |c| kick_drift.step(c)),
        Mover::Noise(noise, sum) => {
            let energies = &mut room()[..slots.len()];
            let of_mass = noise.of_step.on(noise.mass);
            let energies_of = Energies(|_| of_mass.half_mass(), &mut *energies);
            let mut report = Noise(noise.of_step, &noise.particles[slots], energies_of);
            let list = move |c| kick_drift.step_with_noise(of_mass, c);
            let longest = run(level, moving, &mut report, list);
            // SAFETY: the contract is passed on.
            unsafe { sum.give(chunk, energies) };
            longest
        }
        Mover::Bath { mass, sum, .. } => {
            let energies = &mut room()[..slots.len()];
            let half_mass = 0.5 * mass;
            let mut report = Energies(|_| half_mass, &mut *energies);
            run(level, moving, &mut report, move |c| kick_drift.up_to_bath(c));
            // SAFETY: as above.
            unsafe { sum.give(chunk, energies) };
            0.0
        }
    }
}

/// Runs a list of moves in the instructions of a level.
fn run(
    level: Level,
    moving: Moving<'_>,
    report: &mut impl Report,
    list: impl Fn(Component) -> Component + Copy,
) -> f64 {
    // Each arm has a closure of its own, which has one call and is inlined.
    match level {
        Level::Avx512(isa) => isa.run(|| moving.block::<GROUP, _>(report, move |c, _| list(c))),
        Level::Avx2(isa) => isa.run(|| moving.block::<GROUP, _>(report, move |c, _| list(c))),
        Level::Portable => moving.block::<GROUP, _>(report, move |c, _| list(c)),
    }
}

#[cfg(test)]
mod tests {
    use lennard_core::FrictionAndNoise;
    use lennard_core::random::Streams;

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
        for n in [1, 15, 16, 17, ATOMS_PER_CHUNK] {
            let particles: Vec<u32> = (0..n as u32).map(|k| 7919 * k % 1000).collect();
            let of_slots =
                SlotNoise { of_step: noise.in_step(12, 0.004), mass: 1.5, particles: &particles };
            for kind in ["drift", "noise", "bath"] {
                let moved = |level: Level| {
                    let (mut x, mut v, forces) = (vectors(0, n), vectors(99, n), vectors(333, n));
                    let (mut sum, mut parts) = (SumOfParts::default(), Vec::new());
                    let over_chunks = SumOverChunks::begin(&mut sum, &mut parts, 1);
                    let mut kept = vec![DVec3::ZERO; n];
                    let mover = match kind {
                        "drift" => Mover::Drift,
                        "noise" => Mover::Noise(of_slots, over_chunks),
                        _ => Mover::Bath {
                            forces: Disjoint::new(&mut kept),
                            mass: 1.5,
                            sum: over_chunks,
                        },
                    };
                    let (positions, velocities) = (&mut x[..], &mut v[..]);
                    let moving = Moving { positions, velocities, forces: &forces };
                    // SAFETY: one thread runs the only chunk.
                    let bound = unsafe { move_chunk(level, kick_drift, &mover, (0, 0..n), moving) };
                    (x, v, sum.value(&parts, None), bound)
                };
                let plain = moved(Level::Portable);
                for level in Level::available() {
                    assert_eq!(moved(level), plain, "{level:?}, {n} particles, {kind}");
                }
                assert!(kind == "drift" || plain.2 != 0.0);
            }
        }
    }
}
