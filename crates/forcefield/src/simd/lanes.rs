//! The operations of a register of lanes that the pair loops need.

use glam::DVec3;
use lennard_neighbor::{CLUSTER, FixedRow};

use crate::number::{Number, RowsOf};
use crate::real::Real;
use lennard_core::MOST_SPECIES;

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
    /// The lanes that count.
    type Mask: Copy;
    /// The number type of a lane.
    type Number: Number;
    /// The species of rows, one per lane.
    type Species: Copy;
    /// A number for each species.
    type Table: Copy;

    /// The constant `value` in every lane.
    fn constant(isa: Self::Isa, value: f64) -> Self;

    /// The coordinates of one row in every lane. Lanes may hold whole numbers as bits.
    fn spread(isa: Self::Isa, row: &Self::Row) -> [Self; 3];

    /// The coordinates and the species of the rows of `WIDTH` entries.
    ///
    /// # Safety
    /// The `WIDTH` entries at `entries` are readable, and each numbers a readable row.
    unsafe fn gather<E: Copy + Into<u32>>(
        isa: Self::Isa,
        rows: *const Self::Row,
        entries: *const E,
    ) -> ([Self; 3], Self::Species);

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
    /// The lanes set in the lowest bits of `bits` whose value is at most `limit`.
    fn at_most_among(self, limit: Self, bits: u32) -> Self::Mask;
    /// The lanes of a mask as bits, the first one lowest.
    fn bits(mask: Self::Mask) -> u32;
    /// The value where the mask holds, zero elsewhere.
    fn keep(self, mask: Self::Mask) -> Self;
    /// The sum over all lanes, in double precision and a fixed order.
    fn sum(self) -> f64;
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

    /// The sums over all lanes of the vectors of four members, times `unit`.
    fn sum_four(of_members: [[Self; 3]; CLUSTER], unit: f64) -> [DVec3; CLUSTER];

    /// Lanes from memory. The search keeps whole numbers of 32 bits in lanes, too.
    ///
    /// # Safety
    /// `WIDTH` numbers are readable.
    unsafe fn load(isa: Self::Isa, from: *const f32) -> Self;
    /// Lanes to memory.
    ///
    /// # Safety
    /// `WIDTH` numbers are writable.
    unsafe fn store(self, to: *mut f32);
    /// The lanes set in `bits`, packed together to memory.
    ///
    /// # Safety
    /// As [`FixedLanes::store`].
    unsafe fn pack(self, bits: u32, to: *mut f32);
    /// The same for whole numbers, which fit into 16 bits.
    ///
    /// # Safety
    /// `WIDTH` numbers are writable.
    unsafe fn pack_narrow(self, bits: u32, to: *mut u16);
    /// A whole number in every lane.
    fn whole(isa: Self::Isa, number: u32) -> Self;
    /// The whole numbers from `first` on.
    fn numbers_from(isa: Self::Isa, first: u32) -> Self;
    /// self − other of whole numbers, which wraps around, as a single.
    fn less(self, other: Self) -> Self;
    /// |self|.
    fn abs(self) -> Self;
    /// The nearest integer.
    fn round(self) -> Self;
    /// The lanes whose value is at most `limit`, and whose whole number is another one than `own`.
    fn near_others(self, limit: Self, number: Self, own: Self) -> u32;
    /// The lanes whose whole number is none of [`CLUSTER`] from `first` on. Bits beyond the lanes may be set.
    fn others(self, first: Self) -> u32;
}

const _: () = assert!(CLUSTER == 4, "the loop has one variable for each member");
