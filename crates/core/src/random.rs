//! Named random streams of one seed.
//!
//! Set-up (velocities, random positions) draws from sequential generators, one for each name. Noise
//! during a run is counter-based. The noise of a particle at a step is a pure function of (seed,
//! name, step, particle), so restarts and threads cannot change it.

use std::convert::Infallible;

use rand::{SeedableRng, TryRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lanes::Aligned;

/// One round of Philox: two 32×32-bit products, crossed.
#[inline(always)]
fn philox_round(c: [u32; 4], k: [u32; 2]) -> [u32; 4] {
    let p0 = u64::from(c[0]) * 0xD251_1F53;
    let p1 = u64::from(c[2]) * 0xCD9E_8D57;
    [(p1 >> 32) as u32 ^ c[1] ^ k[0], p1 as u32, (p0 >> 32) as u32 ^ c[3] ^ k[1], p0 as u32]
}

/// Philox 4×32 with ten rounds: 128 random bits as a pure function of counter and key. Source:
/// Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11 (2011).
#[must_use]
pub fn philox4x32(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for round in 0..10 {
        if round > 0 {
            key = [key[0].wrapping_add(0x9E37_79B9), key[1].wrapping_add(0xBB67_AE85)];
        }
        counter = philox_round(counter, key);
    }
    counter
}

/// [`philox_round`] of one lane, with each word in the low half.
#[inline(always)]
fn lane_round(c: [u64; 4], key: [u64; 2]) -> [u64; 4] {
    const LOW: u64 = 0xffff_ffff;
    let p0 = (c[0] & LOW) * 0xD251_1F53;
    let p1 = (c[2] & LOW) * 0xCD9E_8D57;
    [(p1 >> 32) ^ c[1] ^ key[0], p1 & LOW, (p0 >> 32) ^ c[3] ^ key[1], p0 & LOW]
}

/// Particles whose rounds of Philox take turns: each round waits for the one before, and other particles fill the time.
const IN_TURN: usize = 3;

/// Philox for the first block of some particles at a step: the words of [`philox4x32`].
///
/// The rounds stand one after another, since a loop over rounds would keep a compiler from putting particles into lanes.
// Loops of numbers keep the words in registers.
#[allow(clippy::needless_range_loop)]
#[inline(always)]
pub(crate) fn philox_lanes<const N: usize>(
    key: [u32; 2],
    step: u64,
    particles: &[u32; N],
) -> Aligned<[[u32; N]; 4]> {
    const { assert!(N.is_multiple_of(IN_TURN)) };
    let mut words = Aligned([[0; N]; 4]);
    let key_of = |round: u32| {
        let first = key[0].wrapping_add(round.wrapping_mul(0x9E37_79B9));
        let second = key[1].wrapping_add(round.wrapping_mul(0xBB67_AE85));
        [u64::from(first), u64::from(second)]
    };
    let part = N / IN_TURN;
    for k in 0..part {
        let start = |k: usize| [0, u64::from(particles[k]), step & 0xffff_ffff, step >> 32];
        let mut c = [start(k), start(k + part), start(k + 2 * part)];
        macro_rules! rounds {
            ($($round:literal)*) => {$(
                let key = key_of($round);
                c = [lane_round(c[0], key), lane_round(c[1], key), lane_round(c[2], key)];
            )*};
        }
        rounds!(0 1 2 3 4 5 6 7 8 9);
        for turn in 0..IN_TURN {
            for word in 0..4 {
                words.0[word][k + turn * part] = c[turn][word] as u32;
            }
        }
    }
    words
}

/// FNV-1a of a name: a fixed 64-bit number for each stream (Fowler, Noll, Vo; RFC 9923 draft constants).
fn name_hash(name: &str) -> u64 {
    name.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

/// All streams of one seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Streams {
    seed: u64,
}

impl Streams {
    /// The streams of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    fn key(self, name: &str) -> [u32; 2] {
        let mixed = self.seed ^ name_hash(name).rotate_left(17);
        let block = philox4x32(
            [
                self.seed as u32,
                (self.seed >> 32) as u32,
                name_hash(name) as u32,
                (name_hash(name) >> 32) as u32,
            ],
            [mixed as u32, (mixed >> 32) as u32],
        );
        [block[0], block[1]]
    }

    /// A sequential generator, for set-up.
    #[must_use]
    pub fn sequential(self, name: &str) -> Xoshiro256PlusPlus {
        let [a, b] = self.key(name);
        Xoshiro256PlusPlus::seed_from_u64(u64::from(a) | u64::from(b) << 32)
    }

    /// Counter-based noise, for use during a run.
    #[must_use]
    pub fn noise(self, name: &str) -> NoiseStream {
        NoiseStream { key: self.key(name) }
    }
}

/// Counter-based noise: no state to save, nothing to forget.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoiseStream {
    key: [u32; 2],
}

impl NoiseStream {
    /// The key of the stream.
    #[inline(always)]
    pub(crate) fn key(&self) -> [u32; 2] {
        self.key
    }

    /// The generator of one particle (or other index) at one step: always the same numbers.
    #[must_use]
    pub fn at(&self, step: u64, particle: u32) -> CounterRng {
        CounterRng {
            key: self.key,
            counter: [0, particle, step as u32, (step >> 32) as u32],
            block: [0; 4],
            used: 4,
        }
    }
}

/// A generator over the Philox blocks of one (step, particle); works with every distribution of `rand_distr`.
#[derive(Debug, Clone)]
pub struct CounterRng {
    key: [u32; 2],
    counter: [u32; 4],
    block: [u32; 4],
    used: usize,
}

impl TryRng for CounterRng {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        if self.used == 4 {
            self.block = philox4x32(self.counter, self.key);
            self.counter[0] = self.counter[0].wrapping_add(1);
            self.used = 0;
        }
        self.used += 1;
        Ok(self.block[self.used - 1])
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let low = u64::from(self.try_next_u32()?);
        Ok(low | u64::from(self.try_next_u32()?) << 32)
    }

    fn try_fill_bytes(&mut self, out: &mut [u8]) -> Result<(), Infallible> {
        for chunk in out.chunks_mut(4) {
            let word = self.try_next_u32()?.to_le_bytes();
            chunk.copy_from_slice(&word[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn philox_gives_the_published_vectors() {
        // Known-answer vectors of the Random123 distribution (file kat_vectors, philox4x32 10).
        assert_eq!(
            philox4x32([0; 4], [0; 2]),
            [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]
        );
        assert_eq!(
            philox4x32([!0; 4], [!0; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox4x32(
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0]
            ),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    #[test]
    fn noise_depends_on_seed_name_step_and_particle_and_on_nothing_else() {
        let draw = |seed, name: &str, step, particle| {
            Streams::new(seed).noise(name).at(step, particle).next_u64()
        };
        let base = draw(1, "langevin", 5, 7);
        assert_eq!(base, draw(1, "langevin", 5, 7));
        for other in [
            draw(2, "langevin", 5, 7),
            draw(1, "bussi", 5, 7),
            draw(1, "langevin", 6, 7),
            draw(1, "langevin", 5, 8),
        ] {
            assert_ne!(base, other);
        }
    }

    #[test]
    fn normal_noise_has_the_right_moments() {
        let noise = Streams::new(3).noise("test");
        let n = 200_000_u32;
        let (mut sum, mut squares) = (0.0, 0.0);
        for i in 0..n {
            let x: f64 = StandardNormal.sample(&mut noise.at(9, i));
            sum += x;
            squares += x * x;
        }
        // Standard errors are 1/√n and √(2/n): four of them.
        let n = f64::from(n);
        assert!((sum / n).abs() < 4.0 / n.sqrt());
        assert!((squares / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt());
    }
}
