//! One array that several threads write, each thread its own elements.

use std::marker::PhantomData;
use std::ops::Range;

use super::prefetch::{Region, prefetch_write};

/// An array that several threads write at the same time, each to elements of its own.
pub struct Disjoint<'a, T> {
    start: *mut T,
    len: usize,
    array: PhantomData<&'a mut [T]>,
}

// SAFETY: the unsafe methods demand that no two threads use one element at the same time.
unsafe impl<T: Send> Sync for Disjoint<'_, T> {}
// SAFETY: it is a unique borrow of a slice of `T: Send`.
unsafe impl<T: Send> Send for Disjoint<'_, T> {}

impl<'a, T: Copy> Disjoint<'a, T> {
    /// Borrows `array` for writes by several threads.
    pub fn new(array: &'a mut [T]) -> Self {
        Self { start: array.as_mut_ptr(), len: array.len(), array: PhantomData }
    }

    /// Prefetches an element that will soon be written.
    #[inline(always)]
    pub fn prefetch(&self, index: usize) {
        prefetch_write(self.start.wrapping_add(index));
    }

    /// The region of the array, for prefetches.
    pub fn region(&self) -> Region {
        Region::at(self.start.cast_const())
    }

    /// All elements.
    ///
    /// # Safety
    /// While they are borrowed, no thread writes any of them.
    #[inline(always)]
    pub unsafe fn all(&self) -> &[T] {
        // SAFETY: it is the slice that was given; no thread writes to it by the contract of this function.
        unsafe { std::slice::from_raw_parts(self.start, self.len) }
    }

    /// A range of the elements.
    ///
    /// # Safety
    /// While they are borrowed, no other thread reads or writes any of them.
    #[inline(always)]
    #[allow(clippy::mut_from_ref)]
    pub unsafe fn part(&self, range: Range<usize>) -> &mut [T] {
        assert!(range.start <= range.end && range.end <= self.len);
        // SAFETY: in bounds by the assertion; unshared by the contract of this function.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(range.start), range.len()) }
    }

    /// Writes one element.
    ///
    /// # Safety
    /// While this borrow lives, no other thread writes to `index`.
    #[inline(always)]
    pub unsafe fn write(&self, index: usize, value: T) {
        assert!(index < self.len);
        // SAFETY: in bounds by the assertion; unshared by the contract of this function.
        unsafe { *self.start.add(index) = value }
    }

    /// Reads one element.
    ///
    /// # Safety
    /// No other thread writes to `index` meanwhile.
    #[inline(always)]
    pub unsafe fn read(&self, index: usize) -> T {
        assert!(index < self.len);
        // SAFETY: in bounds by the assertion; unshared by the contract of this function.
        unsafe { *self.start.add(index) }
    }
}
