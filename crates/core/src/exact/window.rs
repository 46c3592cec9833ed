//! Terms cut into slices whose sums are exact doubles.

use super::wide::power_of_two;

/// Terms that share one sum of slices.
pub const MOST_TERMS: u32 = 1024;
/// Bits of a slice: so many that the sum of the slices of [`MOST_TERMS`] terms is an exact double.
const SLICE_BITS: i32 = 53 - MOST_TERMS.ilog2() as i32;
/// Room above the largest term, in bits: larger terms seldom come later.
const SPARE_BITS: i32 = 3;
/// Partial sums that the processor adds side by side.
const LANES: usize = 4;

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
        Self {
            limit: f64::from_bits(1),
            rounders: [0.0; 2],
        }
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
    #[inline]
    pub fn sums(&self, block: &[f64]) -> Option<[f64; 2]> {
        let mut lanes = Lanes::default();
        let (fours, last) = block.as_chunks::<LANES>();
        for four in fours {
            lanes.add(self, four);
        }
        if !last.is_empty() {
            let mut four = [0.0; LANES];
            four[..last.len()].copy_from_slice(last);
            lanes.add(self, &four);
        }
        let [a, b, c, d] = lanes.rest;
        let [e, f, g, h] = lanes.largest.map(|x| x < self.limit);
        // The comparison is false for NaN, which leaves a rest too. A rest of zero may be negative.
        if (a | b | c | d) << 1 != 0 || !(e & f & g & h) {
            return None;
        }
        let sum = |[a, b, c, d]: [f64; LANES]| (a + b) + (c + d);
        Some([sum(lanes.high), sum(lanes.low)])
    }
}

/// Sums of slices side by side.
#[derive(Default)]
struct Lanes {
    high: [f64; LANES],
    low: [f64; LANES],
    /// The bits of all rests together.
    rest: [u64; LANES],
    /// The largest |x|.
    largest: [f64; LANES],
}

impl Lanes {
    /// Adds one term to each lane. Each loop is one instruction of the processor for two lanes or more.
    // Iterators over arrays are calls where little is inlined.
    #[allow(clippy::needless_range_loop)]
    #[inline(always)]
    fn add(&mut self, window: &Window, terms: &[f64; LANES]) {
        let [first, second] = window.rounders;
        let (mut high, mut low, mut below) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            high[k] = (terms[k] + first) - first;
        }
        for k in 0..LANES {
            below[k] = terms[k] - high[k];
        }
        for k in 0..LANES {
            low[k] = (below[k] + second) - second;
        }
        for k in 0..LANES {
            self.high[k] += high[k];
        }
        for k in 0..LANES {
            self.low[k] += low[k];
        }
        for k in 0..LANES {
            self.rest[k] |= (below[k] - low[k]).to_bits();
        }
        for k in 0..LANES {
            let x = terms[k].abs();
            self.largest[k] = if x > self.largest[k] {
                x
            } else {
                self.largest[k]
            };
        }
    }
}
