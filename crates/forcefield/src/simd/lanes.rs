//! The operations of a register of lanes that the pair loops need.

use glam::DVec3;
use lennard_neighbor::{CLUSTER, ENTRY_SCALE, cluster_center};

use super::row::{DoubleRow, FixedRow};
use crate::number::{Number, RowsOf};
use crate::real::Real;
use lennard_core::MOST_SPECIES;

/// A list entry, which numbers a row.
pub trait Entry: Copy + Send + Sync {
    /// The address of the row that the entry numbers.
    ///
    /// # Safety
    /// There is such a row.
    unsafe fn row<Row>(self, rows: *const Row) -> *const Row;
}

impl Entry for u16 {
    #[inline(always)]
    unsafe fn row<Row>(self, rows: *const Row) -> *const Row {
        // SAFETY: the contract is passed on.
        unsafe { rows.add(usize::from(self)) }
    }
}

impl Entry for u32 {
    #[inline(always)]
    unsafe fn row<Row>(self, rows: *const Row) -> *const Row {
        // SAFETY: the contract is passed on.
        unsafe { rows.add(self as usize) }
    }
}

/// An entry of a [`lennard_neighbor::Block`].
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct BlockEntry(pub u16);

impl Entry for BlockEntry {
    #[inline(always)]
    unsafe fn row<Row>(self, rows: *const Row) -> *const Row {
        const { assert!(size_of::<Row>() == 8 * ENTRY_SCALE as usize) };
        // SAFETY: the contract is passed on.
        unsafe { rows.cast::<u64>().add(usize::from(self.0)).cast() }
    }
}

/// A number for each species, as registers load them.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct BySpecies<T>(pub [T; MOST_SPECIES]);

/// Several pairs side by side, one per lane.
///
/// A value proves that this processor has the instruction set: the first values are made with a token.
pub trait Lanes: Real {
    /// Number of lanes.
    const WIDTH: usize;
    /// Proof that this processor has the instruction set.
    type Isa: Copy + Send + Sync;
    /// One row of packed coordinates.
    type Row: Copy;
    /// Coordinates of rows, one row per lane.
    type Rows: Copy;
    /// The lanes that count.
    type Mask: Copy;
    /// The number type of a lane.
    type Number: Number;
    /// The species of rows, one per lane.
    type Species: Copy;
    /// A number for each species.
    type Table: Copy;
    /// How many lanes counted so far.
    type Count: Copy;

    /// The constant `value` in every lane.
    fn constant(isa: Self::Isa, value: f64) -> Self;

    /// One row in every lane.
    fn spread(isa: Self::Isa, row: &Self::Row) -> Self::Rows;

    /// The species of a row.
    fn species_of(row: &Self::Row) -> usize;
    /// A number for each species.
    fn table(isa: Self::Isa, numbers: &BySpecies<Self::Number>) -> Self::Table;
    /// The number of the species of each lane.
    fn pick(table: Self::Table, species: Self::Species) -> Self;

    /// The row of a pair law for scaled r² = `self`: the distance from its begin, and its u, g₀, g₁, g₂ and g₃.
    ///
    /// `first` is [`RowsOf::first_of`] the law of each lane. Any number has a row: numbers beyond them have the first or the last one.
    fn look_up(self, rows: &RowsOf<Self::Number>, first: Self) -> (Self, [Self; 5]);

    /// The lanes whose value is at most `limit`.
    fn at_most(self, limit: Self) -> Self::Mask;
    /// No lane counted so far.
    fn none(isa: Self::Isa) -> Self::Count;
    /// The count with the lanes of a mask.
    fn count(count: Self::Count, mask: Self::Mask) -> Self::Count;
    /// The number of lanes in a count.
    fn counted(count: Self::Count) -> u32;
    /// The value where the mask holds, zero elsewhere.
    fn keep(self, mask: Self::Mask) -> Self;
    /// The sum over all lanes, in double precision and a fixed order.
    fn sum(self) -> f64;
}

/// Registers that read rows in σ.
pub trait RowLanes: Lanes<Row = DoubleRow, Number = f64> {
    /// r_own − r_row in σ along x, y and z, for the rows of `WIDTH` entries, and the species of the rows.
    ///
    /// # Safety
    /// The `WIDTH` entries at `entries` are readable, and each numbers a readable row.
    unsafe fn differences<E: Entry>(
        own: Self::Rows,
        rows: *const Self::Row,
        entries: *const E,
    ) -> ([Self; 3], Self::Species);

    /// The lanes of `mask` among the first `count`.
    fn first(mask: Self::Mask, count: usize) -> Self::Mask;

    /// The sums over all lanes of three values, times `unit`; one common reduction may cost less than three.
    #[inline(always)]
    fn sum3(x: Self, y: Self, z: Self, unit: f64) -> DVec3 {
        unit * DVec3::new(x.sum(), y.sum(), z.sum())
    }
}

/// Registers of singles that read rows in fixed point.
pub trait FixedLanes: Lanes<Row = FixedRow, Number = f32> {
    /// Whether the sums of four members leave too few registers for a pair: loops then take one member after another.
    const FEW_REGISTERS: bool = false;

    /// The rows of `WIDTH` entries: their coordinates along x, y and z, and their species.
    ///
    /// # Safety
    /// The `WIDTH` entries at `entries` are readable, and each numbers a readable row.
    unsafe fn gather(
        isa: Self::Isa,
        rows: *const FixedRow,
        entries: *const BlockEntry,
    ) -> Self::Rows;

    /// The species of gathered rows.
    fn species(rows: Self::Rows) -> Self::Species;

    /// a − b along each axis, in units of the rows.
    fn apart(a: Self::Rows, b: Self::Rows) -> [Self; 3];

    /// The lanes set in the lowest bits of `bits` whose value is at most `limit`.
    fn at_most_among(self, limit: Self, bits: u32) -> Self::Mask;

    /// The [`cluster_center`], and the members relative to it in σ, where units are `scale` σ long along each axis.
    #[inline(always)]
    fn cluster_frame(
        isa: Self::Isa,
        rows: [&FixedRow; CLUSTER],
        scale: [f64; 3],
    ) -> (Self::Rows, [[Self; 3]; CLUSTER]) {
        let center = cluster_center(*rows[1], *rows[2]);
        let relative = |row: &FixedRow, axis: usize| {
            let apart = row[axis].wrapping_sub(center[axis]) as f32;
            Self::constant(isa, f64::from(apart * scale[axis] as f32))
        };
        let each = |row: &FixedRow| [relative(row, 0), relative(row, 1), relative(row, 2)];
        let own = [each(rows[0]), each(rows[1]), each(rows[2]), each(rows[3])];
        (Self::spread(isa, &center), own)
    }

    /// The sums over all lanes of four vectors, times `unit`; one common reduction may cost less than twelve.
    #[inline(always)]
    fn sum_four([a, b, c, d]: [[Self; 3]; CLUSTER], unit: f64) -> [DVec3; CLUSTER] {
        [
            unit * DVec3::new(a[0].sum(), a[1].sum(), a[2].sum()),
            unit * DVec3::new(b[0].sum(), b[1].sum(), b[2].sum()),
            unit * DVec3::new(c[0].sum(), c[1].sum(), c[2].sum()),
            unit * DVec3::new(d[0].sum(), d[1].sum(), d[2].sum()),
        ]
    }
}

const _: () = assert!(CLUSTER == 4, "the loop has one variable for each member");
