//! Arithmetic of registers, written once for all instruction sets.

/// Implements [`Real`](crate::real::Real) for a register type, from its number type and its instructions.
///
/// The instructions are, in this order: broadcast, add, subtract, multiply, divide, multiply and add, square root,
/// minimum, maximum. A value of the type proves that this processor has the instruction set.
macro_rules! register {
    ($lanes:ident, $float:ty, $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident,
     $fmadd:ident, $sqrt:ident, $min:ident, $max:ident) => {
        impl std::ops::Add for $lanes {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                // SAFETY: a value of this type proves the instruction set, here and below.
                Self(unsafe { $add(self.0, o.0) })
            }
        }
        impl std::ops::Sub for $lanes {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $sub(self.0, o.0) })
            }
        }
        impl std::ops::Mul for $lanes {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $mul(self.0, o.0) })
            }
        }
        impl std::ops::Div for $lanes {
            type Output = Self;
            #[inline(always)]
            fn div(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $div(self.0, o.0) })
            }
        }
        impl std::ops::Neg for $lanes {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $sub($splat(0.0), self.0) })
            }
        }
        impl crate::real::Real for $lanes {
            #[inline(always)]
            fn splat(self, value: f64) -> Self {
                // SAFETY: as above.
                Self(unsafe { $splat(value as $float) })
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $fmadd(self.0, a.0, b.0) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn min(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $min(self.0, o.0) })
            }
            #[inline(always)]
            fn max(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $max(self.0, o.0) })
            }
        }
    };
}
pub(super) use register;
