//! Writes from several threads to distinct places of one array.

use std::marker::PhantomData;
use std::ops::Range;

use super::prefetch::prefetch_write;

/// An array to which several threads write, each to elements of its own.
pub struct Scatter<'a, T> {
    start: *mut T,
    len: usize,
    array: PhantomData<&'a mut [T]>,
}

// SAFETY: the only access is `write`, whose callers guarantee that no two threads use one index.
unsafe impl<T: Send> Sync for Scatter<'_, T> {}
// SAFETY: it is a unique borrow of a slice of `T: Send`.
unsafe impl<T: Send> Send for Scatter<'_, T> {}

impl<'a, T: Copy> Scatter<'a, T> {
    /// Borrows `array` for scattered writes.
    pub fn new(array: &'a mut [T]) -> Self {
        Self {
            start: array.as_mut_ptr(),
            len: array.len(),
            array: PhantomData,
        }
    }

    /// Says that an element will soon be written.
    #[inline(always)]
    pub fn prefetch(&self, index: usize) {
        prefetch_write(self.start.wrapping_add(index));
    }

    /// Where it begins.
    pub fn address(&self) -> usize {
        self.start.addr()
    }

    /// All elements.
    ///
    /// # Safety
    /// While they are borrowed, nobody writes one of them.
    #[inline(always)]
    pub unsafe fn all(&self) -> &[T] {
        // SAFETY: it is the slice that was given; nobody writes to it by the contract of this function.
        unsafe { std::slice::from_raw_parts(self.start, self.len) }
    }

    /// Some of the elements.
    ///
    /// # Safety
    /// While they are borrowed, nobody else reads or writes one of them.
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
