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
#[derive(Debug, Clone, Copy, Default)]
pub struct Window {
    /// Slices hold terms below this power of two. Zero: there are no slices yet.
    pub limit: f64,
    /// Numbers that round to multiples of the last bit of each slice, added and taken away.
    rounders: [f64; 2],
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
        let rest = lanes.rest.iter().fold(0, |all, bits| all | bits);
        // The comparison is false for NaN, which leaves a rest too. A rest of zero may be negative.
        let whole = rest << 1 == 0 && lanes.largest.iter().all(|x| *x < self.limit);
        whole.then(|| [lanes.high, lanes.low].map(|sums| sums.iter().sum()))
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
    #[inline(always)]
    fn add(&mut self, window: &Window, terms: &[f64; LANES]) {
        let [first, second] = window.rounders;
        let high: [f64; LANES] = std::array::from_fn(|k| (terms[k] + first) - first);
        let below: [f64; LANES] = std::array::from_fn(|k| terms[k] - high[k]);
        let low: [f64; LANES] = std::array::from_fn(|k| (below[k] + second) - second);
        for (sum, high) in self.high.iter_mut().zip(high) {
            *sum += high;
        }
        for (sum, low) in self.low.iter_mut().zip(low) {
            *sum += low;
        }
        for (rest, (below, low)) in self.rest.iter_mut().zip(below.iter().zip(low)) {
            *rest |= (below - low).to_bits();
        }
        for (largest, x) in self.largest.iter_mut().zip(terms) {
            *largest = if x.abs() > *largest {
                x.abs()
            } else {
                *largest
            };
        }
    }
}
