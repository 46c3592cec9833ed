//! What a register of lanes must do for the pair loop.

use glam::DVec3;

use crate::real::Real;

/// The width of a list entry.
pub trait Entry: Copy + Send + Sync {
    /// The entry as an index.
    fn index(self) -> usize;
}

impl Entry for u16 {
    #[inline(always)]
    fn index(self) -> usize {
        usize::from(self)
    }
}

impl Entry for u32 {
    #[inline(always)]
    fn index(self) -> usize {
        self as usize
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

    /// r_own − r_row in σ for the rows that `WIDTH` entries name, along x, y and z; `scale` is the
    /// length in σ of one unit of each axis of the rows.
    ///
    /// # Safety
    /// `rows.add(e)` is a readable row for each of the `WIDTH` readable entries `e` at `entries`, and
    /// the processor has the instruction set of the implementation.
    unsafe fn differences<E: Entry>(
        own: Self::Own,
        scale: [Self; 3],
        rows: *const Self::Row,
        entries: *const E,
    ) -> [Self; 3];

    /// The lanes whose value is at most `limit`.
    fn at_most(self, limit: Self) -> Self::Mask;
    /// The lanes of `mask` among the first `count`.
    fn first(mask: Self::Mask, count: usize) -> Self::Mask;
    /// Number of lanes in a mask.
    fn count(mask: Self::Mask) -> u32;
    /// The value where the mask holds, zero elsewhere.
    fn keep(self, mask: Self::Mask) -> Self;
    /// The sum over all lanes, in double precision and a fixed order.
    fn sum(self) -> f64;
    /// The sums over all lanes of three values at once, which costs less than three sums.
    #[inline(always)]
    fn sum3(x: Self, y: Self, z: Self) -> DVec3 {
        DVec3::new(x.sum(), y.sum(), z.sum())
    }
}
