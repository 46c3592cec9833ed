//! Terms cut into slices whose sums are exact doubles.

use super::wide::power_of_two;
use crate::lanes::{MOST_LANES, Simd};

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
    #[inline(always)]
    pub fn sums<S: Simd>(&self, simd: S, block: &[f64]) -> Option<[f64; 2]> {
        let mut lanes = Lanes::new(simd, self);
        let (registers, last) = registers(simd, block);
        for terms in registers {
            lanes.add(*terms);
        }
        lanes.add(last);
        lanes.sums(self.limit)
    }
}

/// The largest |x| of a block; where a term is no number, it may be any of them.
#[inline(always)]
pub fn largest<S: Simd>(simd: S, block: &[f64]) -> f64 {
    let (registers, last) = registers(simd, block);
    let mut largest = simd.abs_f64s(last);
    for terms in registers {
        largest = simd.max_f64s(simd.abs_f64s(*terms), largest);
    }
    simd.reduce_max_f64s(largest)
}

/// The whole registers of a block, and one more with the terms that are left and zeros.
// Loops over them do not take closures, which are calls where little is inlined.
#[inline(always)]
fn registers<S: Simd>(simd: S, block: &[f64]) -> (&[S::f64s], S::f64s) {
    let (registers, last) = S::as_simd_f64s(block);
    if last.is_empty() {
        return (registers, simd.splat_f64s(0.0));
    }
    let mut padded = [0.0; MOST_LANES];
    padded[..last.len()].copy_from_slice(last);
    (registers, S::as_simd_f64s(&padded).0[0])
}

/// Sums of slices side by side.
struct Lanes<S: Simd> {
    simd: S,
    rounders: [S::f64s; 2],
    high: S::f64s,
    low: S::f64s,
    /// The sums of all |rest|: zero where there is no rest, and no number where a term is none.
    rest: S::f64s,
    /// The largest |x|.
    largest: S::f64s,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn new(simd: S, window: &Window) -> Self {
        const { assert!(S::F64_LANES <= MOST_LANES) };
        let [first, second] = window.rounders;
        let zero = simd.splat_f64s(0.0);
        Self {
            simd,
            rounders: [simd.splat_f64s(first), simd.splat_f64s(second)],
            high: zero,
            low: zero,
            rest: zero,
            largest: zero,
        }
    }

    /// Adds one term to each lane.
    #[inline(always)]
    fn add(&mut self, terms: S::f64s) {
        let (simd, [first, second]) = (self.simd, self.rounders);
        let rounded = |x, rounder| simd.sub_f64s(simd.add_f64s(x, rounder), rounder);
        let high = rounded(terms, first);
        let below = simd.sub_f64s(terms, high);
        let low = rounded(below, second);
        let rest = simd.abs_f64s(simd.sub_f64s(below, low));
        self.high = simd.add_f64s(self.high, high);
        self.low = simd.add_f64s(self.low, low);
        self.rest = simd.add_f64s(self.rest, rest);
        self.largest = simd.max_f64s(self.largest, simd.abs_f64s(terms));
    }

    /// The sums of all lanes; `None` where a term is not below the limit or has a rest.
    #[inline(always)]
    fn sums(self, limit: f64) -> Option<[f64; 2]> {
        let simd = self.simd;
        // A term that is no number leaves a rest that is none either, which equals nothing.
        let holds = simd.reduce_sum_f64s(self.rest) == 0.0;
        let is_below = simd.reduce_max_f64s(self.largest) < limit;
        let sums = [self.high, self.low].map(|slice| simd.reduce_sum_f64s(slice));
        (holds && is_below).then_some(sums)
    }
}
