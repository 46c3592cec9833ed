//! What can be summed: quantities made of numbers.

use glam::{DMat3, DVec3};

/// A quantity of N numbers that is summed exactly.
pub trait Summand<const N: usize> {
    /// Its numbers.
    fn numbers(self) -> [f64; N];
    /// The quantity of some numbers.
    fn from_numbers(numbers: [f64; N]) -> Self;
}

impl Summand<1> for f64 {
    #[inline(always)]
    fn numbers(self) -> [f64; 1] {
        [self]
    }
    #[inline(always)]
    fn from_numbers([sum]: [f64; 1]) -> Self {
        sum
    }
}

impl Summand<3> for DVec3 {
    #[inline(always)]
    fn numbers(self) -> [f64; 3] {
        self.to_array()
    }
    #[inline(always)]
    fn from_numbers(numbers: [f64; 3]) -> Self {
        Self::from_array(numbers)
    }
}

impl Summand<9> for DMat3 {
    #[inline(always)]
    fn numbers(self) -> [f64; 9] {
        self.to_cols_array()
    }
    #[inline(always)]
    fn from_numbers(numbers: [f64; 9]) -> Self {
        Self::from_cols_array(&numbers)
    }
}

impl<const N: usize> Summand<N> for [f64; N] {
    #[inline(always)]
    fn numbers(self) -> [f64; N] {
        self
    }
    #[inline(always)]
    fn from_numbers(numbers: [f64; N]) -> Self {
        numbers
    }
}
