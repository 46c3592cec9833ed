//! Lanes without any particular instruction set: small arrays, which the compiler puts into the registers it has.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::arithmetic::arithmetic;
use super::cluster_loop::{self, ClusterJob};
use super::lanes::{BlockEntry, BySpecies, Entry, FixedLanes, Lanes, RowLanes};
use super::output::Output;
use super::row::{DoubleRow, FixedRow, species_of_fixed};
use super::row_loop::{self, RowJob};
use super::totals::{ChunkTotals, Detail};
use crate::interaction::Interaction;
use crate::options::Precision;
use crate::pair::PairForm;
use crate::pair::tabulated::TableRows;
use crate::real::Real;
use lennard_core::MOST_SPECIES;

/// `N` numbers side by side.
#[derive(Clone, Copy)]
pub struct Group<T, const N: usize>([T; N]);

// As many numbers as one 128-bit register holds. With more, compilers make long code that changes with edits elsewhere.
type Doubles = Group<f64, 2>;
// Compilers find no registers for the gathered groups of clusters. Groups of four take 9 % longer, and three times the code.
type Singles = Group<f32, 1>;

macro_rules! group {
    ($float:ty, $rows:ident, $shift:tt) => {
        impl<const N: usize> Add for Group<$float, N> {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                Self(from_fn(|k| self.0[k] + o.0[k]))
            }
        }
        impl<const N: usize> Sub for Group<$float, N> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                Self(from_fn(|k| self.0[k] - o.0[k]))
            }
        }
        impl<const N: usize> Mul for Group<$float, N> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                Self(from_fn(|k| self.0[k] * o.0[k]))
            }
        }
        impl<const N: usize> Div for Group<$float, N> {
            type Output = Self;
            #[inline(always)]
            fn div(self, o: Self) -> Self {
                Self(from_fn(|k| self.0[k] / o.0[k]))
            }
        }
        impl<const N: usize> Neg for Group<$float, N> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(from_fn(|k| -self.0[k]))
            }
        }
        impl<const N: usize> Real for Group<$float, N> {
            #[inline(always)]
            fn splat(self, value: f64) -> Self {
                Self([value as $float; N])
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                // Without the instruction, a fused multiply-add is a library call.
                self * a + b
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.map(<$float>::sqrt))
            }
            #[inline(always)]
            fn min(self, o: Self) -> Self {
                Self(from_fn(|k| if self.0[k] < o.0[k] { self.0[k] } else { o.0[k] }))
            }
            #[inline(always)]
            fn max(self, o: Self) -> Self {
                Self(from_fn(|k| if self.0[k] > o.0[k] { self.0[k] } else { o.0[k] }))
            }
            #[inline(always)]
            fn look_up(self, rows: &TableRows) -> (Self, [Self; 4]) {
                let (rows, numbering) = rows.$rows();
                let shift = TableRows::SHIFTS.$shift;
                let held = self.max(self.splat(numbering.lowest));
                let held = held.min(self.splat(numbering.highest));
                let number = held.0.map(|s| s.to_bits() >> shift);
                let begin = Self(number.map(|n| <$float>::from_bits(n << shift)));
                let row: [_; N] = from_fn(|k| rows[(number[k] - numbering.first) as usize].0);
                (self - begin, from_fn(|c| Self(from_fn(|k| row[k][c]))))
            }
        }
    };
}

group!(f64, wide, 0);
group!(f32, narrow, 1);

macro_rules! tables_and_masks {
    ($float:ty) => {
        #[inline(always)]
        fn table(_isa: (), numbers: &BySpecies<$float>) -> BySpecies<$float> {
            *numbers
        }
        #[inline(always)]
        fn pick(table: BySpecies<$float>, species: [usize; N]) -> Self {
            Self(from_fn(|k| table.0[species[k]]))
        }
        #[inline(always)]
        fn at_most(self, limit: Self) -> Self::Mask {
            from_fn(|k| self.0[k] <= limit.0[k])
        }
        #[inline(always)]
        fn none(_isa: ()) -> u32 {
            0
        }
        #[inline(always)]
        fn count(count: u32, mask: Self::Mask) -> u32 {
            count + mask.iter().map(|m| u32::from(*m)).sum::<u32>()
        }
        #[inline(always)]
        fn counted(count: u32) -> u32 {
            count
        }
        #[inline(always)]
        fn keep(self, mask: Self::Mask) -> Self {
            Self(from_fn(|k| if mask[k] { self.0[k] } else { 0.0 }))
        }
        #[inline(always)]
        fn sum(self) -> f64 {
            self.0.iter().map(|v| f64::from(*v)).sum()
        }
    };
}

impl<const N: usize> Lanes for Group<f64, N> {
    const WIDTH: usize = N;
    const SPECIAL_LOOPS: bool = false;
    type Isa = ();
    type Row = DoubleRow;
    type Rows = [f64; 3];
    type Mask = [bool; N];
    type Number = f64;
    type Species = [usize; N];
    type Table = BySpecies<f64>;
    type Count = u32;

    #[inline(always)]
    fn constant(_isa: (), value: f64) -> Self {
        Self([value; N])
    }

    #[inline(always)]
    fn spread(_isa: (), row: &DoubleRow) -> Self::Rows {
        let [x, y, z, _] = row.0;
        [x, y, z]
    }

    #[inline(always)]
    fn species_of(row: &DoubleRow) -> usize {
        row.species_by_lowest_bits()
    }

    tables_and_masks!(f64);
}

impl<const N: usize> RowLanes for Group<f64, N> {
    #[inline(always)]
    unsafe fn differences<E: Entry>(
        own: Self::Rows,
        rows: *const DoubleRow,
        entries: *const E,
    ) -> ([Self; 3], [usize; N]) {
        // SAFETY: `N` entries are readable and each numbers a readable row.
        let at: [&DoubleRow; N] = from_fn(|k| unsafe { &*(*entries.add(k)).row(rows) });
        let apart = [0, 1, 2].map(|axis| Self(from_fn(|k| own[axis] - at[k].0[axis])));
        (apart, from_fn(|k| at[k].species_by_lowest_bits()))
    }

    #[inline(always)]
    fn first(mask: Self::Mask, count: usize) -> Self::Mask {
        from_fn(|k| mask[k] && k < count)
    }
}

impl<const N: usize> Lanes for Group<f32, N> {
    const WIDTH: usize = N;
    const SPECIAL_LOOPS: bool = false;
    type Isa = ();
    type Row = FixedRow;
    type Rows = [[i32; N]; 4];
    type Mask = [bool; N];
    type Number = f32;
    type Species = [usize; N];
    type Table = BySpecies<f32>;
    type Count = u32;

    #[inline(always)]
    fn constant(_isa: (), value: f64) -> Self {
        Self([value as f32; N])
    }

    #[inline(always)]
    fn spread(_isa: (), row: &FixedRow) -> Self::Rows {
        let [x, y, z, species] = *row;
        [[x; N], [y; N], [z; N], [species; N]]
    }

    #[inline(always)]
    fn species_of(row: &FixedRow) -> usize {
        species_of_fixed(row)
    }

    tables_and_masks!(f32);
}

impl<const N: usize> FixedLanes for Group<f32, N> {
    #[inline(always)]
    unsafe fn gather(_isa: (), rows: *const FixedRow, entries: *const BlockEntry) -> Self::Rows {
        // SAFETY: `N` entries are readable and each numbers a readable row.
        let at: [&FixedRow; N] = from_fn(|k| unsafe { &*(*entries.add(k)).row(rows) });
        from_fn(|axis| from_fn(|k| at[k][axis]))
    }

    #[inline(always)]
    fn species(rows: Self::Rows) -> [usize; N] {
        from_fn(|k| rows[3][k] as usize % MOST_SPECIES)
    }

    #[inline(always)]
    fn apart(a: Self::Rows, b: Self::Rows) -> [Self; 3] {
        from_fn(|axis| Self(from_fn(|k| a[axis][k].wrapping_sub(b[axis][k]) as f32)))
    }

    #[inline(always)]
    fn at_most_among(self, limit: Self, bits: u32) -> Self::Mask {
        // There is no branch per lane.
        from_fn(|k| (self.0[k] <= limit.0[k]) & (bits & 1 << k != 0))
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

/// The loop over cluster lists.
// As above.
#[inline(never)]
pub fn run_cluster<I: Interaction>(
    job: &ClusterJob<'_, I>,
    rows: &[FixedRow],
    chunk: usize,
    detail: Detail,
    output: &Output<'_>,
) -> ChunkTotals {
    // SAFETY: as above.
    unsafe { cluster_loop::run::<Singles, I>((), job, rows, chunk, detail, output) }
}

/// The arithmetic of a number of rounds without memory, in a precision.
pub fn limit<F: PairForm>(form: &F, r_cut: f64, rounds: u64, precision: Precision) -> (u64, f64) {
    // Two registers per group of doubles are fastest in so short a loop.
    match precision {
        Precision::Double => arithmetic::<Group<f64, 4>, F>((), form, r_cut, rounds),
        Precision::Mixed => arithmetic::<Singles, F>((), form, r_cut, rounds),
    }
}
