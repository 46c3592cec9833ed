//! What a register of lanes must do for the pair loop.

use glam::DVec3;
use lennard_neighbor::ENTRY;

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

    /// The sums over all lanes of three values at once, which costs less than three sums.
    #[inline(always)]
    fn sum3(x: Self, y: Self, z: Self) -> DVec3 {
        DVec3::new(x.sum(), y.sum(), z.sum())
    }
}
