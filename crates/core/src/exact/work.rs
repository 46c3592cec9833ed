//! What is done with the registers of the processor.

use std::ops::Range;

use super::window::{Window, largest};
use super::{BLOCK, ExactSum, ExactSums};
use crate::lanes::{Simd, WithSimd};

/// Moves a window to where it takes the terms of a block, if need be, and sums their slices there.
pub(super) struct InNewWindow<'a>(pub &'a mut Window, pub &'a [f64]);

impl WithSimd for InNewWindow<'_> {
    type Output = Option<[f64; 2]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(window, block) = self;
        let largest = largest(simd, block);
        if largest >= window.limit {
            *window = Window::above(largest).unwrap_or_default();
        }
        window.sums(simd, block)
    }
}

/// Takes in the blocks of some sums.
pub(super) struct Flush<'a, const N: usize>(pub &'a mut ExactSums<N>);

impl<const N: usize> WithSimd for Flush<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.0.flush_by(simd);
    }
}

/// Adds the terms of some particles to some sums.
pub(super) struct AddRange<'a, F, const N: usize> {
    pub sums: &'a mut ExactSums<N>,
    pub range: Range<usize>,
    pub term: F,
}

impl<F: Fn(usize) -> [f64; N], const N: usize> WithSimd for AddRange<'_, F, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.sums.add_range(simd, self.range, self.term);
    }
}

/// Adds a term for each of some items to a sum.
pub(super) struct AddItems<'a, T, F> {
    pub sum: &'a mut ExactSum,
    pub items: &'a [T],
    pub term: F,
}

impl<T, F: Fn(&T) -> f64> WithSimd for AddItems<'_, T, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut block = [0.0; BLOCK];
        for items in self.items.chunks(BLOCK) {
            let block = &mut block[..items.len()];
            for (term, item) in block.iter_mut().zip(items) {
                *term = (self.term)(item);
            }
            self.sum.add_block(simd, block);
        }
    }
}
