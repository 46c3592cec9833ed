//! Exact totals: sums of floating-point numbers that depend on no order.
//!
//! A total is the exact sum of its terms, rounded once to the nearest double. No order of the terms and no cut into parts
//! can change it: threads and ranks share this one definition. Every double is taken whole, so that no scale and no
//! range has to be chosen. Rounding is the only error, half a unit in the last place of the total.
//!
//! An accumulator is one wide integer in units of 2⁻¹⁰⁷⁴, the smallest double (Kulisch and Miranker 1981; Neal 2015).
//! Nearly all terms get by without it: two slices hold a term whole, and the sums of slices are exact doubles
//! (Demmel and Nguyen 2015). Where the slices lie changes speed and no bit.
//!
//! ```text
//!   term        ±1.0110…0101 · 2^p       53 bits, anywhere below the largest term so far
//!   high slice  |<-- 43 bits -->|        1024 terms fill at most 53 bits
//!   low slice                   |<-- 43 bits -->|
//!   rest                                          zero, or it goes to the wide integer
//! ```
//!
//! A term that is no finite number makes a total that is none either, which the watchdog sees.

mod wide;

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use glam::{DMat3, DVec3};
use wide::WideSum;

use crate::Team;
use crate::exact::wide::power_of_two;
use crate::lanes::{Simd, WithSimd, in_lanes};
use crate::parallel::{CHUNK, part};
use crate::tasks::map_tasks;

/// Terms that are added in one loop without a branch.
const BLOCK: usize = 64;

/// An exact sum in the making.
#[derive(Debug, Clone, Default)]
struct ExactSum {
    /// Where slices lie.
    window: Window,
    /// The sums of the high and of the low slices.
    slices: [f64; 2],
    /// The number of terms in the slices.
    terms: u32,
    /// What the slices do not hold.
    wide: Option<Box<WideSum>>,
}

impl ExactSum {
    /// Adds at most [`MOST_TERMS`] terms.
    fn add_block(&mut self, block: &[f64]) {
        let terms = self.terms + block.len() as u32;
        match self.window.sums(block) {
            Some([high, low]) if terms <= MOST_TERMS => {
                self.slices[0] += high;
                self.slices[1] += low;
                self.terms = terms;
            }
            _ => self.add_with_care(block),
        }
    }

    /// Adds a term for each of some items.
    fn add_terms<T>(&mut self, items: &[T], term: impl Fn(&T) -> f64) {
        let mut block = [0.0; BLOCK];
        for items in items.chunks(BLOCK) {
            let block = &mut block[..items.len()];
            for (to, item) in block.iter_mut().zip(items) {
                *to = term(item);
            }
            self.add_block(block);
        }
    }

    /// Adds terms that the slices have no room for, or may not hold.
    #[cold]
    fn add_with_care(&mut self, block: &[f64]) {
        self.empty_slices();
        self.terms = block.len() as u32;
        let largest = block.iter().fold(0.0, |largest, term| larger(term.abs(), largest));
        if largest >= self.window.limit {
            self.window = Window::above(largest).unwrap_or_default();
        }
        if let Some(sums) = self.window.sums(block) {
            self.slices = sums;
            return;
        }
        for term in block {
            let mut rest = *term;
            if term.abs() < self.window.limit {
                let [high, low, below] = self.window.cut(*term);
                self.slices[0] += high;
                self.slices[1] += low;
                rest = below;
            }
            self.spill(rest);
        }
    }

    /// Moves the slices to the wide integer.
    fn empty_slices(&mut self) {
        for slice in std::mem::take(&mut self.slices) {
            self.spill(slice);
        }
        self.terms = 0;
    }

    /// Adds a number to the wide integer, unless it is zero.
    fn spill(&mut self, x: f64) {
        if x != 0.0 {
            self.wide.get_or_insert_default().add(x);
        }
    }

    /// Adds the terms of another sum.
    fn merge(&mut self, other: &Self) {
        for slice in other.slices {
            self.spill(slice);
        }
        if let Some(wide) = &other.wide {
            self.wide.get_or_insert_default().merge(wide);
        }
    }

    /// The sum, rounded once to the nearest double, ties to even; beyond the largest double it is infinite.
    fn value(&self) -> f64 {
        let [high, low] = self.slices;
        match &self.wide {
            // Both are exact.
            None => high + low,
            Some(_) => self.as_wide().value(),
        }
    }

    /// The sum as one wide integer.
    fn as_wide(&self) -> WideSum {
        let mut all = self.wide.as_deref().cloned().unwrap_or_default();
        self.slices.into_iter().for_each(|slice| all.add(slice));
        all
    }
}

/// Several exact sums over the same particles, which take their terms in blocks.
pub struct ExactSums<const N: usize> {
    blocks: [[f64; BLOCK]; N],
    len: usize,
    sums: [ExactSum; N],
}

impl<const N: usize> Default for ExactSums<N> {
    fn default() -> Self {
        Self {
            blocks: [[0.0; BLOCK]; N],
            len: 0,
            sums: std::array::from_fn(|_| ExactSum::default()),
        }
    }
}

impl<const N: usize> ExactSums<N> {
    /// Adds one term to each sum.
    #[inline]
    pub fn add(&mut self, terms: [f64; N]) {
        if self.len == BLOCK {
            self.flush();
        }
        for (block, term) in self.blocks.iter_mut().zip(terms) {
            block[self.len] = term;
        }
        self.len += 1;
    }

    /// Adds the term of each of some items to the first sum.
    pub(crate) fn add_of<I>(&mut self, items: &[I], term: impl Fn(&I) -> f64) {
        self.sums[0].add_terms(items, term);
    }

    fn flush(&mut self) {
        for (sum, block) in self.sums.iter_mut().zip(&self.blocks) {
            sum.add_block(&block[..self.len]);
        }
        self.len = 0;
    }

    /// Adds the terms of other sums.
    pub fn merge(&mut self, other: Self) {
        self.merge_accumulators(&other.accumulators());
    }

    fn merge_accumulators(&mut self, others: &[ExactSum; N]) {
        for (mine, theirs) in self.sums.iter_mut().zip(others) {
            mine.merge(theirs);
        }
    }

    /// The accumulators.
    fn accumulators(mut self) -> [ExactSum; N] {
        self.flush();
        self.sums
    }

    /// The sums over all ranks of a team, of which each has some of the terms; without a team these sums.
    #[must_use]
    pub fn over(self, team: Option<&Team>) -> Self {
        let Some(team) = team else { return self };
        let sums = self.accumulators();
        let mut words: Vec<i64> = sums.iter().flat_map(|sum| sum.as_wide().words()).collect();
        team.sum(&mut words);
        let (all, _) = words.as_chunks();
        let mut wides = all.iter().map(WideSum::of_words);
        Self {
            sums: std::array::from_fn(|_| ExactSum {
                wide: wides.next().map(Box::new),
                ..ExactSum::default()
            }),
            ..Self::default()
        }
    }

    /// The sums, each rounded once.
    #[must_use]
    pub fn values(self) -> [f64; N] {
        self.accumulators().map(|sum| sum.value())
    }
}

/// The exact sum of `term(0)`, …, `term(n − 1)`, rounded once: the same bits for any order, any threads and any ranks.
pub fn exact_sum<T: Summand<N>, const N: usize>(n: usize, term: impl Fn(usize) -> T + Sync) -> T {
    exact_sum_over(None, n, term)
}

/// As [`exact_sum`], over the terms of all ranks of a team, where there is one.
pub fn exact_sum_over<T: Summand<N>, const N: usize>(
    team: Option<&Team>,
    n: usize,
    term: impl Fn(usize) -> T + Sync,
) -> T {
    let (sums, _) = exact_sums(n, |range, sums: &mut ExactSums<N>| {
        range.for_each(|i| sums.add(term(i).numbers()));
    });
    T::from_numbers(sums.over(team).values())
}

/// The exact sum of one term for each item: [`exact_sum`] in less time, where terms are simple.
pub fn exact_sum_of<T: Sync>(items: &[T], term: impl Fn(&T) -> f64 + Sync) -> f64 {
    let (sums, _) = exact_sums(items.len(), |range, sums: &mut ExactSums<1>| {
        sums.add_of(&items[range], &term);
    });
    let [sum] = sums.values();
    sum
}

/// The exact sum of numbers, rounded once.
#[must_use]
pub fn total(numbers: &[f64]) -> f64 {
    exact_sum_of(numbers, |x| *x)
}

/// The exact sums over `0..n` of what `add` gives for each of some ranges, and what it returns for each, in their order.
///
/// The number of ranges depends on the number of threads.
pub fn exact_sums<const N: usize, R: Send>(
    n: usize,
    add: impl Fn(Range<usize>, &mut ExactSums<N>) -> R + Sync,
) -> (ExactSums<N>, Vec<R>) {
    let mut all = ExactSums::default();
    // The order of the two questions matters: asking for threads starts a pool, which a system may refuse.
    if n <= CHUNK || rayon::current_num_threads() == 1 {
        let found = add(0..n, &mut all);
        return (all, vec![found]);
    }
    let tasks = n.div_ceil(CHUNK);
    let size = n.div_ceil(tasks.min(4 * rayon::current_num_threads()));
    let parts = map_tasks(n.div_ceil(size), |(): &mut (), task| {
        let mut mine = ExactSums::default();
        let found = add(part(task, size, n), &mut mine);
        (mine.accumulators(), found)
    });
    let found = parts.into_iter().map(|(sums, found)| {
        all.merge_accumulators(&sums);
        found
    });
    let found = found.collect();
    (all, found)
}

// An exact sum whose parts are computed where their terms are: by any thread, while they are in registers or in a cache.

/// Parts whose slices fill no more than one sum of slices.
const PARTS: usize = MOST_TERMS as usize / BLOCK;

/// The slices of the terms of one part, or zeros where they went elsewhere.
#[derive(Debug, Clone, Copy, Default)]
pub struct PartSum([f64; 2]);

/// An exact sum of parts. Its value has the bits of [`exact_sum`] over all terms.
///
/// All parts share one window, which the sum before has left. Terms that it does not hold go to a sum that parts take in turns.
#[derive(Debug, Default)]
pub struct SumOfParts {
    window: Window,
    others: Mutex<ExactSum>,
}

impl SumOfParts {
    /// The most terms of a part.
    pub const MOST_TERMS: usize = BLOCK;

    /// Forgets parts that no value was asked for.
    pub fn begin(&mut self) {
        *self.others.get_mut().unwrap_or_else(PoisonError::into_inner) = ExactSum::default();
    }

    /// Sums the terms of a part.
    ///
    /// # Panics
    /// Where there are more than [`SumOfParts::MOST_TERMS`]: that is a bug of the caller.
    #[must_use]
    pub fn part(&self, terms: &[f64]) -> PartSum {
        assert!(terms.len() <= BLOCK, "few terms in a part");
        PartSum(self.window.sums(terms).unwrap_or_else(|| {
            self.others.lock().unwrap_or_else(PoisonError::into_inner).add_block(terms);
            [0.0; 2]
        }))
    }

    /// The sum of all parts since the last value, rounded once; with a team over the parts of all ranks.
    #[must_use]
    pub fn value(&mut self, parts: &[PartSum], team: Option<&Team>) -> f64 {
        let others = self.others.get_mut().unwrap_or_else(PoisonError::into_inner);
        let mut sum = std::mem::take(others);
        if sum.window.limit > self.window.limit {
            self.window = sum.window;
        }
        for parts in parts.chunks(PARTS) {
            sum.empty_slices();
            for PartSum([high, low]) in parts {
                sum.slices[0] += high;
                sum.slices[1] += low;
            }
        }
        let sums = ExactSums { sums: [sum], ..ExactSums::default() };
        let [value] = sums.over(team).values();
        value
    }
}

// Terms cut into slices whose sums are exact doubles.

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

// What can be summed: quantities made of numbers.

/// A quantity of N numbers that is summed exactly.
pub trait Summand<const N: usize> {
    /// Its numbers.
    fn numbers(self) -> [f64; N];
    /// The quantity of some numbers.
    fn from_numbers(numbers: [f64; N]) -> Self;
}

impl Summand<1> for f64 {
    #[inline(always)]
    fn numbers(self) -> [f64; 1] {
        [self]
    }
    #[inline(always)]
    fn from_numbers([sum]: [f64; 1]) -> Self {
        sum
    }
}

impl Summand<3> for DVec3 {
    #[inline(always)]
    fn numbers(self) -> [f64; 3] {
        self.to_array()
    }
    #[inline(always)]
    fn from_numbers(numbers: [f64; 3]) -> Self {
        Self::from_array(numbers)
    }
}

impl Summand<9> for DMat3 {
    #[inline(always)]
    fn numbers(self) -> [f64; 9] {
        self.to_cols_array()
    }
    #[inline(always)]
    fn from_numbers(numbers: [f64; 9]) -> Self {
        Self::from_cols_array(&numbers)
    }
}

impl<const N: usize> Summand<N> for [f64; N] {
    #[inline(always)]
    fn numbers(self) -> [f64; N] {
        self
    }
    #[inline(always)]
    fn from_numbers(numbers: [f64; N]) -> Self {
        numbers
    }
}

#[cfg(test)]
mod tests;
