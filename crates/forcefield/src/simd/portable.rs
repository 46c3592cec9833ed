//! Lanes without any particular instruction set: two doubles, as many as one 128-bit register holds.
//!
//! There are no singles: without instructions for them, pairs in mixed precision take longer than in double.

use std::array::from_fn;

use glam::{BVec2, DVec2};

use super::lanes::{BySpecies, Lanes};
use super::output::Output;
use super::row::DoubleRow;
use super::row_loop::{self, RowJob};
use crate::interaction::Interaction;
use crate::number::{Number, RowsOf};
use crate::real::Real;
use crate::sums::{Detail, Totals};

impl Real for DVec2 {
    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        Self::splat(value)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        // Without the instruction, a fused multiply-add is a library call.
        self * a + b
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::new(self.x.sqrt(), self.y.sqrt())
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self::min(self, o)
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self::max(self, o)
    }
}

impl Lanes for DVec2 {
    const WIDTH: usize = 2;
    type Isa = ();
    type Row = DoubleRow;
    type Mask = BVec2;
    type Number = f64;
    type Species = [usize; 2];
    type Table = BySpecies<f64>;

    #[inline(always)]
    fn constant(_isa: (), value: f64) -> Self {
        Self::splat(value)
    }

    #[inline(always)]
    fn spread(_isa: (), row: &DoubleRow) -> [Self; 3] {
        from_fn(|axis| Self::splat(row.0[axis]))
    }
    #[inline(always)]
    unsafe fn gather<E: Copy + Into<u32>>(
        _isa: (),
        rows: *const DoubleRow,
        entries: *const E,
    ) -> ([Self; 3], [usize; 2]) {
        // SAFETY: two entries are readable and each numbers a readable row.
        let at: [&DoubleRow; 2] =
            from_fn(|k| unsafe { &*rows.add((*entries.add(k)).into() as usize) });
        let coordinates = from_fn(|axis| Self::new(at[0].0[axis], at[1].0[axis]));
        (coordinates, at.map(DoubleRow::species_by_lowest_bits))
    }

    #[inline(always)]
    fn species_of(row: &DoubleRow) -> usize {
        row.species_by_lowest_bits()
    }
    #[inline(always)]
    fn table(_isa: (), numbers: &BySpecies<f64>) -> BySpecies<f64> {
        *numbers
    }
    #[inline(always)]
    fn pick(table: BySpecies<f64>, species: [usize; 2]) -> Self {
        species.map(|species| table.0[species]).into()
    }
    #[inline(always)]
    fn look_up(self, rows: &RowsOf<f64>, first: Self) -> (Self, [Self; 5]) {
        let held = self.max(Self::splat(rows.lowest)).min(Self::splat(rows.highest));
        let number = held.to_array().map(|s| s.to_bits() >> rows.shift);
        let begin: Self = number.map(|n| f64::from_bits(n << rows.shift)).into();
        let counts_from = f64::COUNTS_FROM.to_bits() + rows.first;
        let row: [[f64; 4]; 2] = from_fn(|k| {
            let at = number[k] + first[k].to_bits() - counts_from;
            rows.rows[at as usize].0
        });
        let [u, g0, g1, g2] = from_fn(|c| Self::new(row[0][c], row[1][c]));
        let g3 = g2.to_array().map(|g2| f64::from_bits(g2.to_bits() << 32)).into();
        (self - begin, [u, g0, g1, g2, g3])
    }
    #[inline(always)]
    fn at_most(self, limit: Self) -> BVec2 {
        self.cmple(limit)
    }
    #[inline(always)]
    fn at_most_among(self, limit: Self, bits: u32) -> BVec2 {
        self.cmple(limit) & BVec2::new(bits & 1 == 1, bits & 2 == 2)
    }
    #[inline(always)]
    fn bits(mask: BVec2) -> u32 {
        mask.bitmask()
    }
    #[inline(always)]
    fn keep(self, mask: BVec2) -> Self {
        Self::select(mask, self, Self::ZERO)
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        self.x + self.y
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
) -> Totals {
    // SAFETY: the caller runs each chunk once.
    unsafe { row_loop::run::<DVec2, I>((), job, rows, chunk, detail, output) }
}
