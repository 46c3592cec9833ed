//! Lanes without any particular instruction set: small arrays, which the compiler puts into the registers it has.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::arithmetic::arithmetic;
use super::lanes::{BySpecies, Lanes};
use super::output::Output;
use super::row::DoubleRow;
use super::row_loop::{self, RowJob};
use super::totals::{ChunkTotals, Detail};
use crate::interaction::Interaction;
use crate::number::{Number, RowsOf};
use crate::options::Precision;
use crate::real::Real;

/// `N` numbers side by side. There are no singles: without instructions for them, pairs in mixed precision take longer than in double.
#[derive(Clone, Copy)]
pub struct Group<const N: usize>([f64; N]);

// As many numbers as one 128-bit register holds. With more, compilers make long code that changes with edits elsewhere.
type Doubles = Group<2>;

impl<const N: usize> Add for Group<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self(from_fn(|k| self.0[k] + o.0[k]))
    }
}
impl<const N: usize> Sub for Group<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self(from_fn(|k| self.0[k] - o.0[k]))
    }
}
impl<const N: usize> Mul for Group<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self(from_fn(|k| self.0[k] * o.0[k]))
    }
}
impl<const N: usize> Div for Group<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        Self(from_fn(|k| self.0[k] / o.0[k]))
    }
}
impl<const N: usize> Neg for Group<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(from_fn(|k| -self.0[k]))
    }
}
impl<const N: usize> Real for Group<N> {
    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        // Without the instruction, a fused multiply-add is a library call.
        self * a + b
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(<f64>::sqrt))
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self(from_fn(|k| if self.0[k] < o.0[k] { self.0[k] } else { o.0[k] }))
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(from_fn(|k| if self.0[k] > o.0[k] { self.0[k] } else { o.0[k] }))
    }
}

impl<const N: usize> Lanes for Group<N> {
    const WIDTH: usize = N;
    type Isa = ();
    type Row = DoubleRow;
    type Rows = [DoubleRow; N];
    type Mask = [bool; N];
    type Number = f64;
    type Species = [usize; N];
    type Table = BySpecies<f64>;

    #[inline(always)]
    fn constant(_isa: (), value: f64) -> Self {
        Self([value; N])
    }

    #[inline(always)]
    fn spread(_isa: (), row: &DoubleRow) -> Self::Rows {
        [*row; N]
    }
    #[inline(always)]
    unsafe fn gather<E: Copy + Into<u32>>(
        _isa: (),
        rows: *const DoubleRow,
        entries: *const E,
    ) -> Self::Rows {
        // SAFETY: `N` entries are readable and each numbers a readable row.
        from_fn(|k| unsafe { *rows.add((*entries.add(k)).into() as usize) })
    }
    #[inline(always)]
    fn apart(a: Self::Rows, b: Self::Rows) -> [Self; 3] {
        [0, 1, 2].map(|axis| Self(from_fn(|k| a[k].0[axis] - b[k].0[axis])))
    }

    #[inline(always)]
    fn species_of(row: &DoubleRow) -> usize {
        row.species_by_lowest_bits()
    }

    #[inline(always)]
    fn species(rows: Self::Rows) -> [usize; N] {
        rows.map(|row| row.species_by_lowest_bits())
    }
    #[inline(always)]
    fn table(_isa: (), numbers: &BySpecies<f64>) -> BySpecies<f64> {
        *numbers
    }
    #[inline(always)]
    fn pick(table: BySpecies<f64>, species: [usize; N]) -> Self {
        Self(from_fn(|k| table.0[species[k]]))
    }
    #[inline(always)]
    fn look_up(self, rows: &RowsOf<f64>, first: Self) -> (Self, [Self; 5]) {
        let held = self.max(self.splat(rows.lowest)).min(self.splat(rows.highest));
        let number = held.0.map(|s| s.to_bits() >> rows.shift);
        let begin = Self(number.map(|n| f64::from_bits(n << rows.shift)));
        let counts_from = f64::COUNTS_FROM.to_bits() + rows.first;
        let at: [usize; N] = from_fn(|k| (number[k] + first.0[k].to_bits() - counts_from) as usize);
        let row = at.map(|k| rows.rows()[k].0);
        let [u, g0, g1, g2] = from_fn(|c| Self(from_fn(|k| row[k][c])));
        let g3 = Self(g2.0.map(|g2| f64::from_bits(g2.to_bits() << 32)));
        (self - begin, [u, g0, g1, g2, g3])
    }
    #[inline(always)]
    fn at_most(self, limit: Self) -> Self::Mask {
        from_fn(|k| self.0[k] <= limit.0[k])
    }
    #[inline(always)]
    fn at_most_among(self, limit: Self, bits: u32) -> Self::Mask {
        from_fn(|k| self.0[k] <= limit.0[k] && bits >> k & 1 == 1)
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        (0..N).map(|k| u32::from(mask[k]) << k).sum()
    }
    #[inline(always)]
    fn keep(self, mask: Self::Mask) -> Self {
        Self(from_fn(|k| if mask[k] { self.0[k] } else { 0.0 }))
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        self.0.iter().sum()
    }
}

/// The loop over row lists.
// Code of this length is best compiled by itself, not inlined.
#[inline(never)]
pub fn run_double<I: Interaction>(
    job: &RowJob<'_, I>,
    rows: &[DoubleRow],
    chunk: usize,
    detail: Detail,
    output: &Output<'_>,
) -> ChunkTotals {
    // SAFETY: the caller runs each chunk once.
    unsafe { row_loop::run::<Doubles, I>((), job, rows, chunk, detail, output) }
}

/// The arithmetic of a number of rounds without memory.
pub fn limit(r_cut: f64, rounds: u64, _precision: Precision) -> (u64, f64) {
    // Two registers per group of doubles are fastest in so short a loop.
    arithmetic::<Group<4>>((), r_cut, rounds)
}
