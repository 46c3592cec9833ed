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

mod parts;
mod summand;
mod wide;
mod window;

use std::ops::Range;

use crate::Team;
use crate::parallel::{CHUNK, part};
use crate::tasks::map_tasks;

pub use parts::{PartSum, SumOfParts};
pub use summand::Summand;

use wide::WideSum;
use window::{MOST_TERMS, Window, larger};

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

/// The exact sum of one term for each item, over all ranks of a team where there is one.
///
/// It is [`exact_sum_over`] in less time, where terms are simple.
pub fn exact_sum_of<T: Sync>(
    team: Option<&Team>,
    items: &[T],
    term: impl Fn(&T) -> f64 + Sync,
) -> f64 {
    let (sums, _) = exact_sums(items.len(), |range, sums: &mut ExactSums<1>| {
        sums.sums[0].add_terms(&items[range], &term);
    });
    let [sum] = sums.over(team).values();
    sum
}

/// The exact sum of numbers, rounded once.
#[must_use]
pub fn total(numbers: &[f64]) -> f64 {
    exact_sum_of(None, numbers, |x| *x)
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

#[cfg(test)]
mod tests;
