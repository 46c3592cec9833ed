//! Friction and noise on every particle at a temperature that may change: the Ornstein–Uhlenbeck part of Langevin dynamics.

use std::f32::consts::LN_2;

use crate::lanes::Aligned;
use crate::random::{NoiseStream, philox_lanes};

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

// Normal numbers of many particles at once, as a pure function of key, step and particle.
//
// ```text
//   one block of Philox     word 0              word 1      word 2      word 3      32 bits each
//                           radius 1 and sign   angle 1     radius 2    angle 2
//   normal numbers          x = r1·cos, y = r1·sin           z = r2·sin
// ```
//
// An angle lies within a quarter of a turn to either side. The sign of the radius makes a whole turn of the half. The sine of
// such an angle has the distribution of the sine of any angle.
//
// The numbers have the 24 bits of a single: noise needs no more, and a register holds twice as many of them. Every operation is
// exact or rounded once, as IEEE 754 has it, in a fixed order. A compiler may put the particles into lanes of any width, and the
// bits stay. Source: Box and Muller, "A note on the generation of random normal deviates", Ann. Math. Stat. 29, 610 (1958).
// Polynomials are near the best of their degree: the largest error is least.

/// Particles that are worked on side by side.
pub const LANES: usize = 48;

/// The mantissa of a single.
const MANTISSA: u32 = (1 << 23) - 1;
/// The bits of √½.
const ROOT_HALF: u32 = 0x3f35_04f3;

/// c₀ + c₁·x + c₂·x² + …
#[inline(always)]
fn polynomial<const N: usize>(c: [f32; N], x: f32) -> f32 {
    let mut sum = c[N - 1];
    for k in (0..N - 1).rev() {
        sum = sum * x + c[k];
    }
    sum
}

/// −2·ln u for the number u = (k + ½)/2³¹ in the middle of the `k`th of 2³¹ intervals of (0, 1).
///
/// k + ½ = 2ᵉ·m with √½ ≤ m < √2 and f = m − 1, so that −2·ln u = (31 − e)·2·ln 2 + f·(−2 + f·P(f)).
#[inline(always)]
fn minus_two_ln(k: u32) -> f32 {
    const P: [f32; 8] = [
        0.999_999_8,
        -0.666_679,
        0.500_035_1,
        -0.399_241_45,
        0.331_410_2,
        -0.298_359_57,
        0.286_150_16,
        -0.174_696_22,
    ];
    // Processors convert signed numbers, and k has 31 bits.
    let shifted = (k as i32 as f32 + 0.5).to_bits().wrapping_sub(ROOT_HALF);
    let exponent = (shifted as i32 >> 23) - 31;
    let m = f32::from_bits((shifted & MANTISSA).wrapping_add(ROOT_HALF));
    let f = m - 1.0;
    exponent as f32 * (-2.0 * LN_2) + f * (-2.0 + f * polynomial(P, f))
}

/// √(−2·ln u), with u from the upper 31 bits, and with a sign from the lowest.
#[inline(always)]
fn radius(bits: u32) -> f32 {
    let radius = minus_two_ln(bits >> 1).sqrt();
    f32::from_bits(radius.to_bits() ^ bits << 31)
}

/// Cosine and sine of the angle of `bits`/2³² half turns, where the bits are a signed number: a quarter of a turn at most.
#[inline(always)]
fn cosine_and_sine(bits: u32) -> [f32; 2] {
    const COSINE: [f32; 5] = [0.999_999_94, -4.934_793, 4.058_412, -1.331_880_2, 0.219_696_8];
    const SINE: [f32; 5] = [3.141_592_5, -5.167_707, 2.550_031_4, -0.598_045_2, 0.077_220_13];
    let half_turns = bits as i32 as f32 * (1.0 / 4_294_967_296.0);
    let square = half_turns * half_turns;
    [polynomial(COSINE, square), half_turns * polynomial(SINE, square)]
}

impl NoiseStream {
    /// Three normal numbers for each of some particles at a step: x, y and z of one after another.
    #[inline(always)]
    #[must_use]
    pub fn normals(&self, step: u64, particles: &[u32; LANES]) -> Aligned<[f32; 3 * LANES]> {
        let Aligned(bits) = philox_lanes(self.key(), step, particles);
        let mut axes = Aligned([[0.0; LANES]; 3]);
        let [x, y, z] = &mut axes.0;
        for k in 0..LANES {
            let first = radius(bits[0][k]);
            let [cosine, sine] = cosine_and_sine(bits[1][k]);
            x[k] = first * cosine;
            y[k] = first * sine;
            let [_, sine] = cosine_and_sine(bits[3][k]);
            z[k] = radius(bits[2][k]) * sine;
        }
        let mut normals = Aligned([0.0; 3 * LANES]);
        for k in 0..LANES {
            normals.0[3 * k] = x[k];
            normals.0[3 * k + 1] = y[k];
            normals.0[3 * k + 2] = z[k];
        }
        normals
    }
}

// A quantity that stays as it is or changes linearly with the steps of a stage.

/// What a bath holds at each step: a constant, or a straight line from one value to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    from: f64,
    to: f64,
    first: u64,
    steps: u64,
}

impl Ramp {
    /// The same value at each step.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self::linear(value, value, 0, 0)
    }

    /// From one value at step `first` to another, `steps` steps later; constant before and after.
    #[must_use]
    pub fn linear(from: f64, to: f64, first: u64, steps: u64) -> Self {
        Self { from, to, first, steps }
    }

    /// The value at a step.
    #[must_use]
    pub fn at(&self, step: u64) -> f64 {
        let done = step.saturating_sub(self.first);
        if self.from == self.to || done >= self.steps {
            return self.to;
        }
        self.from + (self.to - self.from) * (done as f64 / self.steps as f64)
    }
}

impl From<f64> for Ramp {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

#[cfg(test)]
mod tests {
    use crate::random::{Streams, philox4x32};

    use super::*;

    #[test]
    fn logarithm_cosine_and_sine_are_those_of_the_library() {
        let mut bits = 1_u32;
        for _ in 0..200_000 {
            bits = bits.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            for bits in [bits, bits >> 20, !(bits >> 20), bits << 22] {
                let u = (f64::from(bits >> 1) + 0.5) / 2_f64.powi(31);
                // A single near to 1 has an error of 2⁻²⁵.
                let (wanted, found) = (-2.0 * u.ln(), f64::from(minus_two_ln(bits >> 1)));
                assert!((found - wanted).abs() < 1.2e-7 * (1.0 + wanted), "{u}");
                assert!(found >= 0.0, "{u}");
                let angle = std::f64::consts::PI * f64::from(bits as i32) / 2_f64.powi(32);
                let [cosine, sine] = cosine_and_sine(bits).map(f64::from);
                assert!((cosine - angle.cos()).abs() < 3e-7, "{angle}");
                assert!((sine - angle.sin()).abs() < 3e-7, "{angle}");
            }
        }
        // The smallest and the largest u: √(2·32·ln 2) is the longest radius.
        assert!((radius(0) - 6.660_437).abs() < 1e-6 && radius(1) == -radius(0));
        assert!(radius(u32::MAX).abs() < 1e-3);
    }

    #[test]
    fn numbers_of_a_particle_do_not_depend_on_its_neighbors_and_come_from_its_block() {
        let noise = Streams::new(3).noise("test");
        let mut particles: [u32; LANES] = std::array::from_fn(|k| 3 * k as u32);
        particles[4..7].copy_from_slice(&[1 << 20, u32::MAX, 7]);
        let step = (7 << 40) + 9;
        let Aligned(together) = noise.normals(step, &particles);
        for (k, particle) in particles.into_iter().enumerate() {
            let Aligned(alone) = noise.normals(step, &[particle; LANES]);
            let [u0, u1, u2, u3] = philox4x32([0, particle, 9, 7 << 8], noise.key());
            let [cosine, sine] = cosine_and_sine(u1);
            let block =
                [radius(u0) * cosine, radius(u0) * sine, radius(u2) * cosine_and_sine(u3)[1]];
            assert_eq!(together[3 * k..3 * k + 3], block);
            assert!(alone.as_chunks::<3>().0.iter().all(|normals| *normals == block));
        }
    }

    #[test]
    fn moments_tails_and_correlations_are_those_of_independent_normal_numbers() {
        let noise = Streams::new(11).noise("test");
        let blocks = 20_000_u32;
        let n = f64::from(blocks * LANES as u32);
        let (mut moments, mut crossed, mut beyond) = ([[0.0; 4]; 3], [0.0; 3], [0_u32; 3]);
        for block in 0..blocks {
            let first = block * LANES as u32;
            let Aligned(normals) = noise.normals(9, &std::array::from_fn(|k| first + k as u32));
            for r in normals.as_chunks::<3>().0 {
                let r = r.map(f64::from);
                for axis in 0..3 {
                    for (power, sum) in (1..).zip(&mut moments[axis]) {
                        *sum += r[axis].powi(power);
                    }
                    crossed[axis] += r[axis] * r[(axis + 1) % 3];
                    beyond[axis] += u32::from(r[axis].abs() > 3.0);
                }
            }
        }
        // Standard deviations of x, x², x³ and x⁴ are 1, √2, √15 and √96; 0.0026998 of all lie beyond 3.
        let exact = [(0.0, 1.0), (1.0, 2.0), (0.0, 15.0), (3.0, 96.0)];
        for axis in 0..3 {
            for (sum, (mean, variance)) in moments[axis].iter().zip(exact) {
                assert!((sum / n - mean).abs() < 4.0 * f64::sqrt(variance / n));
            }
            assert!((crossed[axis] / n).abs() < 4.0 / n.sqrt());
            let expected = 0.002_699_8 * n;
            assert!((f64::from(beyond[axis]) - expected).abs() < 4.0 * expected.sqrt());
        }
    }

    #[test]
    fn a_ramp_is_a_straight_line_between_its_ends() {
        let ramp = Ramp::linear(2.0, 1.0, 100, 50);
        let values = [0, 100, 125, 149, 150, 1000].map(|step| ramp.at(step));
        assert_eq!(values, [2.0, 2.0, 1.5, 2.0 - 49.0 / 50.0, 1.0, 1.0]);
        assert_eq!(Ramp::constant(0.7).at(12), 0.7);
    }
}
