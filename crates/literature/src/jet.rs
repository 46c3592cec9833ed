//! Numbers that carry their own derivatives, so that an equation of state is written once.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A value with its first and second derivatives with respect to two variables x and y
/// (a truncated Taylor series).
///
/// Arithmetic follows the chain rule exactly; there is no step size and no truncation error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    /// f.
    pub value: f64,
    /// ∂f/∂x.
    pub x: f64,
    /// ∂f/∂y.
    pub y: f64,
    /// ∂²f/∂x².
    pub xx: f64,
    /// ∂²f/∂x∂y.
    pub xy: f64,
    /// ∂²f/∂y².
    pub yy: f64,
}

impl Jet {
    /// A constant: all derivatives vanish.
    #[must_use]
    pub const fn constant(value: f64) -> Self {
        Self { value, x: 0.0, y: 0.0, xx: 0.0, xy: 0.0, yy: 0.0 }
    }

    /// The variable x itself.
    #[must_use]
    pub const fn first(value: f64) -> Self {
        Self { x: 1.0, ..Self::constant(value) }
    }

    /// The variable y itself.
    #[must_use]
    pub const fn second(value: f64) -> Self {
        Self { y: 1.0, ..Self::constant(value) }
    }

    /// Applies a function g of one variable, given g, g′ and g″ at `self.value`.
    #[must_use]
    pub fn map(self, g: f64, g1: f64, g2: f64) -> Self {
        Self {
            value: g,
            x: g1 * self.x,
            y: g1 * self.y,
            xx: g2 * self.x * self.x + g1 * self.xx,
            xy: g2 * self.x * self.y + g1 * self.xy,
            yy: g2 * self.y * self.y + g1 * self.yy,
        }
    }

    /// eˣ.
    #[must_use]
    pub fn exp(self) -> Self {
        let e = self.value.exp();
        self.map(e, e, e)
    }

    /// ln x, for positive x.
    #[must_use]
    pub fn ln(self) -> Self {
        let inverse = 1.0 / self.value;
        self.map(self.value.ln(), inverse, -inverse * inverse)
    }

    /// √x, for positive x.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.map(root, 0.5 / root, -0.25 / (root * self.value))
    }

    /// xⁿ for an integer n; finite at x = 0 for n ≥ 0, derivatives included.
    #[must_use]
    pub fn powi(self, n: i32) -> Self {
        // A factor 0 stands before the powers that would diverge at x = 0.
        let power = |factor: i32, exponent: i32| {
            if factor == 0 { 0.0 } else { f64::from(factor) * self.value.powi(exponent) }
        };
        self.map(self.value.powi(n), power(n, n - 1), power(n * (n - 1), n - 2))
    }

    /// xᵃ for a real a and positive x.
    #[must_use]
    pub fn powf(self, a: f64) -> Self {
        let p = self.value.powf(a);
        let first = a * p / self.value;
        self.map(p, first, (a - 1.0) * first / self.value)
    }
}

impl From<f64> for Jet {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            value: self.value + o.value,
            x: self.x + o.x,
            y: self.y + o.y,
            xx: self.xx + o.xx,
            xy: self.xy + o.xy,
            yy: self.yy + o.yy,
        }
    }
}

impl AddAssign for Jet {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self {
            value: self.value * o.value,
            x: self.x * o.value + self.value * o.x,
            y: self.y * o.value + self.value * o.y,
            xx: self.xx * o.value + 2.0 * self.x * o.x + self.value * o.xx,
            xy: self.xy * o.value + self.x * o.y + self.y * o.x + self.value * o.xy,
            yy: self.yy * o.value + 2.0 * self.y * o.y + self.value * o.yy,
        }
    }
}

impl Div for Jet {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        self * o.powi(-1)
    }
}

impl Add<f64> for Jet {
    type Output = Self;
    fn add(self, o: f64) -> Self {
        Self { value: self.value + o, ..self }
    }
}

impl Sub<f64> for Jet {
    type Output = Self;
    fn sub(self, o: f64) -> Self {
        self + -o
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    fn mul(self, o: f64) -> Self {
        Self {
            value: self.value * o,
            x: self.x * o,
            y: self.y * o,
            xx: self.xx * o,
            xy: self.xy * o,
            yy: self.yy * o,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation at once, on a function whose derivatives were taken by hand:
    /// f = x²·√y, and the same f written the long way round.
    #[test]
    fn derivatives_of_a_product_of_powers_are_the_ones_of_the_textbook() {
        let (a, b) = (1.3_f64, 0.7_f64);
        let (x, y) = (Jet::first(a), Jet::second(b));
        let direct = x.powi(2) * y.sqrt();
        let long_way = (x.ln() * 2.0 + y.powf(0.5).ln()).exp() / (x / x) + (y - y) - 0.0;
        let root = b.sqrt();
        let expected = [
            a * a * root,
            2.0 * a * root,
            0.5 * a * a / root,
            2.0 * root,
            a / root,
            -0.25 * a * a / (b * root),
        ];
        for jet in [direct, long_way] {
            let found = [jet.value, jet.x, jet.y, jet.xx, jet.xy, jet.yy];
            for (f, e) in found.iter().zip(&expected) {
                // A few dozen roundings of numbers of order one.
                assert!((f - e).abs() < 1e-14, "{found:?} against {expected:?}");
            }
        }
    }

    #[test]
    fn integer_powers_are_finite_at_zero() {
        let zero = Jet::first(0.0);
        assert_eq!(zero.powi(0).value, 1.0);
        assert_eq!(zero.powi(0).x, 0.0);
        assert_eq!(zero.powi(1).x, 1.0);
        assert_eq!(zero.powi(2).xx, 2.0);
    }
}
