//! The number type that the pair formulas are written over: a scalar, or a register of lanes.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::pair::{NarrowRow, PairRows, RowsOf, WideRow};

/// A real number, or several side by side.
///
/// A formula gives the same value per lane with any type, up to the rounding of the type and of fused multiply-adds.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The constant `value` in every lane of a number like this one.
    ///
    /// A register exists only where the processor has its instruction set. So a constant is made from a number at hand.
    #[must_use]
    fn splat(self, value: f64) -> Self;
    /// `self·a + b`, fused where the instruction set fuses.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// 1/self by a division.
    ///
    /// The divider works beside the ports of products. An estimate with a Newton step would take more of these ports.
    #[inline(always)]
    fn recip(self) -> Self {
        self.splat(1.0) / self
    }
    /// √self.
    fn sqrt(self) -> Self;
    /// The smaller of the two.
    fn min(self, other: Self) -> Self;
    /// The larger of the two.
    fn max(self, other: Self) -> Self;
}

/// A number type of registers.
pub trait Number: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// A row of a pair law.
    type Row: Copy + std::fmt::Debug + Send + Sync;
    /// Bits of the mantissa.
    const MANTISSA: u32;
    /// The number whose last bit counts 1, and whose other bits do not change by counting.
    const COUNTS_FROM: f64;
    /// The number nearest to a double.
    fn of(value: f64) -> Self;
    /// The bits of a value without the last ones.
    fn number(value: f64, shift: u32) -> u64;
    /// Number of bits.
    const BITS: u32;
    /// The last bits of a number that hold the leading bits of another one in a row.
    const FOLDED: u32;
    /// The number with these bits.
    fn from_bits(bits: u64) -> Self;
    /// The bits of the number.
    fn bits(self) -> u64;
    /// The number as a double.
    fn value(self) -> f64;
    /// A row of four numbers.
    fn row(numbers: [Self; 4]) -> Self::Row;
    /// The rows for registers of this type.
    fn rows(rows: &PairRows) -> &RowsOf<Self>;
}

impl Number for f64 {
    type Row = WideRow;
    const BITS: u32 = 64;
    const FOLDED: u32 = 32;
    const MANTISSA: u32 = 52;
    const COUNTS_FROM: f64 = 4_503_599_627_370_496.0;

    fn of(value: f64) -> Self {
        value
    }
    fn number(value: f64, shift: u32) -> u64 {
        value.to_bits() >> shift
    }
    fn from_bits(bits: u64) -> Self {
        Self::from_bits(bits)
    }
    fn bits(self) -> u64 {
        self.to_bits()
    }
    fn value(self) -> f64 {
        self
    }
    fn row(numbers: [Self; 4]) -> WideRow {
        WideRow(numbers)
    }
    fn rows(rows: &PairRows) -> &RowsOf<Self> {
        &rows.wide
    }
}

impl Number for f32 {
    type Row = NarrowRow;
    const BITS: u32 = 32;
    const FOLDED: u32 = 12;
    const MANTISSA: u32 = 23;
    const COUNTS_FROM: f64 = 8_388_608.0;

    fn of(value: f64) -> Self {
        value as Self
    }
    fn number(value: f64, shift: u32) -> u64 {
        u64::from((value as Self).to_bits() >> shift)
    }
    fn from_bits(bits: u64) -> Self {
        Self::from_bits(bits as u32)
    }
    fn bits(self) -> u64 {
        u64::from(self.to_bits())
    }
    fn value(self) -> f64 {
        f64::from(self)
    }
    fn row(numbers: [Self; 4]) -> NarrowRow {
        NarrowRow(numbers)
    }
    fn rows(rows: &PairRows) -> &RowsOf<Self> {
        &rows.narrow
    }
}

impl Real for f64 {
    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        // Without the instruction, a fused multiply-add is a library call.
        self * a + b
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        f64::min(self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        f64::max(self, other)
    }
}
