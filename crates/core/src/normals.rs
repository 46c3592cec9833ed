//! Normal numbers of many particles at once, as a pure function of key, step and particle.
//!
//! ```text
//!   one block of Philox        u0          u1          u2          u3       32 bits each
//!   Box and Muller             radius 1    angle 1     radius 2    angle 2
//!   normal numbers             r1·cos, r1·sin           r2·cos
//! ```
//!
//! Every operation is exact or rounded once, as IEEE 754 has it: additions, products, quotients and square roots, in a fixed
//! order. A compiler may put the particles into lanes of any width, and the bits stay. Source: Box and Muller, "A note on the
//! generation of random normal deviates", Ann. Math. Stat. 29, 610 (1958).

use crate::random::{NoiseStream, philox_lanes};

/// Particles that are worked on side by side.
pub const LANES: usize = 16;

/// The mantissa of a double.
const MANTISSA: u64 = (1 << 52) - 1;
/// The bits of 1 and of √½.
const ONE: u64 = 0x3ff0_0000_0000_0000;
const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
/// The bits of 2⁵², whose last places count ones.
const COUNTER: u64 = 0x4330_0000_0000_0000;
/// 2⁵², and the same with the bias of exponents.
const TWO_52: f64 = 4_503_599_627_370_496.0;
const COUNTER_AND_BIAS: f64 = TWO_52 + 1023.0;

/// c₀ + c₁·x + c₂·x² + …
#[inline(always)]
fn polynomial<const N: usize>(c: [f64; N], x: f64) -> f64 {
    let mut sum = c[N - 1];
    for k in (0..N - 1).rev() {
        sum = sum * x + c[k];
    }
    sum
}

/// ln u for 2⁻³³ ≤ u < 1, within 1e-13 of it.
///
/// u = 2ᵉ·m with √½ ≤ m < √2, and ln m = 2·artanh s with s = (m − 1)/(m + 1), |s| < 0.172.
#[inline(always)]
fn ln(u: f64) -> f64 {
    let shifted = u.to_bits().wrapping_add(ONE - ROOT_HALF);
    let exponent = f64::from_bits(shifted >> 52 | COUNTER) - COUNTER_AND_BIAS;
    let m = f64::from_bits((shifted & MANTISSA).wrapping_add(ROOT_HALF));
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    let s4 = s2 * s2;
    // Two short chains of products take less time than a long one, here and below.
    let even = polynomial([2.0, 2.0 / 5.0, 2.0 / 9.0, 2.0 / 13.0, 2.0 / 17.0], s4);
    let odd = polynomial([2.0 / 3.0, 2.0 / 7.0, 2.0 / 11.0, 2.0 / 15.0], s4);
    exponent * std::f64::consts::LN_2 + s * (even + s2 * odd)
}

/// √(−2·ln u) for the number u in the middle of the `bits`th of 2³² intervals of (0, 1).
#[inline(always)]
fn radius(bits: u64) -> f64 {
    let u = (f64::from_bits(bits | COUNTER) - (TWO_52 - 0.5)) * (1.0 / 4_294_967_296.0);
    (-2.0 * ln(u)).sqrt()
}

/// Cosine and sine of the angle in the middle of the `bits`th of 2³² parts of a turn.
#[inline(always)]
fn cosine_and_sine(bits: u64) -> (f64, f64) {
    // A number of quarter turns, and an angle y of an eighth of a turn at most to either side.
    let shifted = (bits + (1 << 29)) & 0xffff_ffff;
    let in_quarter = f64::from_bits(shifted & ((1 << 30) - 1) | COUNTER) - TWO_52;
    let y = (in_quarter - 536_870_911.5) * (std::f64::consts::TAU / 4_294_967_296.0);
    let y2 = y * y;
    let y4 = y2 * y2;
    let even = polynomial(
        [1.0, 1.0 / 120.0, 1.0 / 362_880.0, 1.0 / 6_227_020_800.0],
        y4,
    );
    let odd = [
        -1.0 / 6.0,
        -1.0 / 5040.0,
        -1.0 / 39_916_800.0,
        -1.0 / 1_307_674_368_000.0,
    ];
    let sine = y * (even + y2 * polynomial(odd, y4));
    let even = [
        1.0,
        1.0 / 24.0,
        1.0 / 40_320.0,
        1.0 / 479_001_600.0,
        1.0 / 20_922_789_888_000.0,
    ];
    let odd = [
        -0.5,
        -1.0 / 720.0,
        -1.0 / 3_628_800.0,
        -1.0 / 87_178_291_200.0,
    ];
    let cosine = polynomial(even, y4) + y2 * polynomial(odd, y4);
    // The signs of the quarters are + − − + for the cosine and + + − − for the sine.
    let quarter = shifted >> 30;
    let (x, y) = if quarter & 1 != 0 {
        (sine, cosine)
    } else {
        (cosine, sine)
    };
    let negative_x = (quarter ^ quarter >> 1) << 63;
    let negative_y = quarter >> 1 << 63;
    (
        f64::from_bits(x.to_bits() ^ negative_x),
        f64::from_bits(y.to_bits() ^ negative_y),
    )
}

impl NoiseStream {
    /// Three normal numbers for each of some particles at a step: x, y and z of each.
    #[inline(always)]
    #[must_use]
    pub fn normals(&self, step: u64, particles: [u32; LANES]) -> [[f64; LANES]; 3] {
        let bits = philox_lanes(self.key(), step, particles);
        let mut normals = [[0.0; LANES]; 3];
        for k in 0..LANES {
            let first = radius(bits[0][k]);
            let (cosine, sine) = cosine_and_sine(bits[1][k]);
            normals[0][k] = first * cosine;
            normals[1][k] = first * sine;
        }
        for k in 0..LANES {
            let second = radius(bits[2][k]);
            let (cosine, _) = cosine_and_sine(bits[3][k]);
            normals[2][k] = second * cosine;
        }
        normals
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Streams, philox4x32};

    #[test]
    fn logarithm_cosine_and_sine_are_those_of_the_library() {
        let mut bits = 1_u32;
        for _ in 0..200_000 {
            bits = bits.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            for bits in [bits, bits >> 20, !(bits >> 20), bits << 22] {
                let bits = u64::from(bits);
                let u = (bits as f64 + 0.5) / 2_f64.powi(32);
                assert!((ln(u) / u.ln() - 1.0).abs() < 1e-13, "{u}");
                let angle = u * std::f64::consts::TAU;
                let (cosine, sine) = cosine_and_sine(bits);
                assert!((cosine - angle.cos()).abs() < 1e-15, "{u}");
                assert!((sine - angle.sin()).abs() < 1e-15, "{u}");
            }
        }
    }

    #[test]
    fn numbers_of_a_particle_do_not_depend_on_its_neighbors_and_come_from_its_block() {
        let noise = Streams::new(3).noise("test");
        let mut particles: [u32; LANES] = std::array::from_fn(|k| 3 * k as u32);
        particles[4..7].copy_from_slice(&[1 << 20, u32::MAX, 7]);
        let step = (7 << 40) + 9;
        let together = noise.normals(step, particles);
        for (k, particle) in particles.into_iter().enumerate() {
            let alone = noise.normals(step, [particle; LANES]);
            let block = philox4x32([0, particle, 9, 7 << 8], noise.key());
            let [u0, u1, u2, u3] = block.map(u64::from);
            let (cosine, sine) = cosine_and_sine(u1);
            let block = [
                radius(u0) * cosine,
                radius(u0) * sine,
                radius(u2) * cosine_and_sine(u3).0,
            ];
            for axis in 0..3 {
                assert_eq!(together[axis][k].to_bits(), block[axis].to_bits());
                assert!(alone[axis].iter().all(|x| *x == block[axis]));
            }
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
            let normals = noise.normals(9, std::array::from_fn(|k| first + k as u32));
            let [x, y, z] = normals;
            for ((x, y), z) in x.into_iter().zip(y).zip(z) {
                let r = [x, y, z];
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
}
