//! The number type that the pair formulas are written over: a scalar, or a register of lanes.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, or several side by side.
///
/// Formulas written over it give the same value per lane whichever type they run on, up to the
/// rounding of the type and of fused multiply-adds.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The constant `value` in every lane.
    fn splat(value: f64) -> Self;
    /// `self·a + b`, fused where the instruction set fuses.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// 1/self, divided out: a divider works beside the ports of products, of which an estimate made as good by
    /// Newton's method would take more.
    #[inline(always)]
    fn recip(self) -> Self {
        Self::splat(1.0) / self
    }
    /// √self.
    fn sqrt(self) -> Self;
    /// The smaller of the two.
    fn min(self, other: Self) -> Self;
    /// The larger of the two.
    fn max(self, other: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
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
