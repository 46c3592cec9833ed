//! What a register of lanes must do for the pair loop.

use glam::DVec3;
use lennard_neighbor::{ENTRY, SHARERS, amid};

use super::FixedRow;
use crate::real::Real;

/// What names a row in a list.
pub trait Entry: Copy + Send + Sync {
    /// The row that it names.
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
pub struct Scaled(pub u16);

impl Entry for Scaled {
    #[inline(always)]
    unsafe fn row<Row>(self, rows: *const Row) -> *const Row {
        const { assert!(size_of::<Row>() == 8 * ENTRY as usize) };
        // SAFETY: the contract is passed on.
        unsafe { rows.cast::<u64>().add(usize::from(self.0)).cast() }
    }
}

/// Several pairs side by side.
pub trait Lanes: Real {
    /// Number of lanes.
    const WIDTH: usize;
    /// One row of packed coordinates.
    type Row: Copy;
    /// One row, in every lane.
    type Own: Copy;
    /// Which lanes count.
    type Mask: Copy;

    /// Spreads one row over all lanes.
    ///
    /// # Safety
    /// The processor has the instruction set of the implementation.
    unsafe fn spread(row: &Self::Row) -> Self::Own;

    /// The lanes whose value is at most `limit`.
    fn at_most(self, limit: Self) -> Self::Mask;
    /// Number of lanes in a mask.
    fn count(mask: Self::Mask) -> u32;
    /// The value where the mask holds, zero elsewhere.
    fn keep(self, mask: Self::Mask) -> Self;
    /// The sum over all lanes, in double precision and a fixed order.
    fn sum(self) -> f64;
}

/// Registers that read rows in σ.
pub trait RowLanes: Lanes {
    /// r_own − r_row in σ for the rows that `WIDTH` entries name, along x, y and z.
    ///
    /// # Safety
    /// Each of the `WIDTH` readable entries at `entries` names a readable row, and the processor has the instruction set
    /// of the implementation.
    unsafe fn differences<E: Entry>(
        own: Self::Own,
        rows: *const Self::Row,
        entries: *const E,
    ) -> [Self; 3];

    /// The lanes of `mask` among the first `count`.
    fn first(mask: Self::Mask, count: usize) -> Self::Mask;

    /// The sums over all lanes of three values at once, which costs less than three sums, times `unit`.
    #[inline(always)]
    fn sum3(x: Self, y: Self, z: Self, unit: f64) -> DVec3 {
        unit * DVec3::new(x.sum(), y.sum(), z.sum())
    }
}

/// Registers of singles that read rows in fixed point.
pub trait FixedLanes: Lanes<Row = FixedRow> {
    /// Whether loops of their own are worth compiling for what is frequent: sharers that are together, totals of all.
    const SPECIAL_LOOPS: bool;

    /// The rows that `WIDTH` entries name, along x, y and z.
    ///
    /// # Safety
    /// Each of the `WIDTH` readable entries at `entries` names a readable row, and the processor has the instruction set
    /// of the implementation.
    unsafe fn gather(rows: *const FixedRow, entries: *const Scaled) -> Self::Own;

    /// a − b along each axis, in units of the rows.
    ///
    /// # Safety
    /// The processor has the instruction set of the implementation.
    unsafe fn apart(a: Self::Own, b: Self::Own) -> [Self; 3];

    /// The lanes set in the lowest bits of `bits` whose value is at most `limit`.
    fn at_most_among(self, limit: Self, bits: u32) -> Self::Mask;

    /// The point [`amid`] the sharers, and the sharers as seen from there in σ, where units are `scale` σ long along
    /// each axis.
    ///
    /// # Safety
    /// As [`FixedLanes::apart`].
    #[inline(always)]
    unsafe fn from_amid(
        rows: [&FixedRow; SHARERS],
        scale: [f64; 3],
    ) -> (Self::Own, [[Self; 3]; SHARERS]) {
        let amid = FixedRow(amid(rows[1].0, rows[2].0));
        let seen = |row: &FixedRow, axis: usize| {
            let apart = row.0[axis].wrapping_sub(amid.0[axis]) as f32;
            Self::splat(f64::from(apart * scale[axis] as f32))
        };
        let each = |row: &FixedRow| [seen(row, 0), seen(row, 1), seen(row, 2)];
        let own = [each(rows[0]), each(rows[1]), each(rows[2]), each(rows[3])];
        // SAFETY: the contract is passed on.
        (unsafe { Self::spread(&amid) }, own)
    }

    /// The sums over all lanes of four vectors at once, which may cost less than twelve sums, times `unit`.
    #[inline(always)]
    fn sum_four([a, b, c, d]: [[Self; 3]; SHARERS], unit: f64) -> [DVec3; SHARERS] {
        [
            unit * DVec3::new(a[0].sum(), a[1].sum(), a[2].sum()),
            unit * DVec3::new(b[0].sum(), b[1].sum(), b[2].sum()),
            unit * DVec3::new(c[0].sum(), c[1].sum(), c[2].sum()),
            unit * DVec3::new(d[0].sum(), d[1].sum(), d[2].sum()),
        ]
    }
}

const _: () = assert!(SHARERS == 4, "the loop names each of the sharers");
