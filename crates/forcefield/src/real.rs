//! The number type that the pair formulas are written over: a scalar, or a register of lanes.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::pair::tabulated::TableRows;

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
    /// The row of a table for r² = `self`, and the distance from the begin of the row.
    ///
    /// Any number has a row: numbers outside the table have its first or last one.
    #[must_use]
    fn look_up(self, rows: &TableRows) -> (Self, [Self; 4]);
}

/// A number type of registers.
pub trait Number: Copy + Send + Sync + 'static {
    /// The number nearest to a double.
    fn of(value: f64) -> Self;
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }
}

impl Number for f32 {
    fn of(value: f64) -> Self {
        value as Self
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
    #[inline(always)]
    fn look_up(self, rows: &TableRows) -> (Self, [Self; 4]) {
        TableRows::look_up(rows, self)
    }
}
