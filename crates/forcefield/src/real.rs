//! The number type that the pair formulas are written over: a scalar, or a register of lanes.

use std::ops::{Add, Div, Mul, Neg, Sub};

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

/// r⁻ⁿ where 1/r² is `inv_r2`, by squaring: the exponent is the same for all lanes.
#[inline(always)]
pub fn inverse_power<R: Real>(inv_r2: R, exponent: u32) -> R {
    let mut product = if exponent % 2 == 1 { inv_r2.sqrt() } else { inv_r2.splat(1.0) };
    let mut bits = exponent / 2;
    let mut power = inv_r2;
    while bits > 0 {
        if bits % 2 == 1 {
            product = product * power;
        }
        power = power * power;
        bits /= 2;
    }
    product
}
