//! Terms cut into slices whose sums are exact doubles.

use super::wide::power_of_two;
use crate::lanes::{Simd, WithSimd, in_lanes};

/// Terms that are cut and summed side by side.
const LANES: usize = 8;

/// Terms that share one sum of slices.
pub const MOST_TERMS: u32 = 1024;
/// Bits of a slice: so many that the sum of the slices of [`MOST_TERMS`] terms is an exact double.
const SLICE_BITS: i32 = 53 - MOST_TERMS.ilog2() as i32;
/// Room above the largest term, in bits: larger terms seldom come later.
const SPARE_BITS: i32 = 3;

/// The place of the slices.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    /// Slices hold terms below this power of two.
    pub limit: f64,
    /// Numbers that round to multiples of the last bit of each slice, added and taken away.
    rounders: [f64; 2],
}

impl Default for Window {
    /// A window that holds zeros alone.
    fn default() -> Self {
        Self { limit: f64::from_bits(1), rounders: [0.0; 2] }
    }
}

impl Window {
    /// The window for terms up to a largest one; `None` where it would lie too near to an end of the exponents.
    pub fn above(largest: f64) -> Option<Self> {
        // largest < 2^exponent
        let exponent = (largest.to_bits() >> 52) as i32 - 1022 + SPARE_BITS;
        (-900..=900).contains(&exponent).then(|| Self {
            limit: power_of_two(exponent),
            // 1.5·2^(52+k) rounds to multiples of 2^k.
            rounders: [1, 2].map(|slice| 1.5 * power_of_two(52 + exponent - slice * SLICE_BITS)),
        })
    }

    /// The slices of a term below the limit, and the rest.
    #[inline(always)]
    pub fn cut(&self, term: f64) -> [f64; 3] {
        let high = (term + self.rounders[0]) - self.rounders[0];
        let below = term - high;
        let low = (below + self.rounders[1]) - self.rounders[1];
        [high, low, below - low]
    }

    /// The sums of the slices of a block; `None` where a term is not below the limit or has a rest.
    pub fn sums(&self, block: &[f64]) -> Option<[f64; 2]> {
        in_lanes(Sums(*self, block))
    }
}

/// The sums of the slices of a block in a window.
struct Sums<'a>(Window, &'a [f64]);

impl WithSimd for Sums<'_> {
    type Output = Option<[f64; 2]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> Self::Output {
        let Self(window, block) = self;
        let (whole, last) = block.as_chunks();
        let mut padded = [0.0; LANES];
        padded[..last.len()].copy_from_slice(last);
        // Two loops, so that registers hold all that each loop sums.
        let mut largest = [0.0; LANES];
        for terms in whole.iter().chain([&padded]) {
            for k in 0..LANES {
                largest[k] = larger(terms[k].abs(), largest[k]);
            }
        }
        let (mut high, mut low, mut rest) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for terms in whole.iter().chain([&padded]) {
            for k in 0..LANES {
                let slices = window.cut(terms[k]);
                high[k] += slices[0];
                low[k] += slices[1];
                rest[k] += slices[2].abs();
            }
        }
        // A term that is no number leaves a rest that is no number, which equals nothing.
        let holds = rest.iter().sum::<f64>() == 0.0;
        let is_below = largest.into_iter().fold(0.0, larger) < window.limit;
        let sums = [high, low].map(|slices| slices.iter().sum());
        (holds && is_below).then_some(sums)
    }
}

/// The larger of two numbers; the second where one is no number.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
