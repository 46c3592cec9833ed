//! Prefetch instructions. Nothing but speed depends on them.

use std::ops::Range;

/// Bytes of a cache line.
const LINE: usize = 64;

/// Number of lines that are prefetched at the beginning of an array.
const BEGINNING: usize = 8;

/// Prefetches the first lines of an array that will soon be read.
///
/// A processor finds the lines of a sequential read by itself, and it cannot know where the read begins.
#[inline(always)]
pub fn prefetch<T>(array: &[T]) {
    let beginning = Parts { start: array.as_ptr().cast(), lines: lines(array).min(BEGINNING) };
    beginning.prefetch(0);
}

/// An array that will be read later, prefetched in parts.
#[derive(Debug, Clone, Copy)]
pub struct Parts {
    start: *const u8,
    /// Lines per part.
    lines: usize,
}

impl Parts {
    /// An array in `parts` parts of whole lines.
    pub fn of<T>(array: &[T], parts: usize) -> Self {
        Self { start: array.as_ptr().cast(), lines: lines(array).div_ceil(parts.max(1)) }
    }

    /// Prefetches one part; the last parts may be empty.
    #[inline(always)]
    pub fn prefetch(&self, part: usize) {
        for line in part * self.lines..(part + 1) * self.lines {
            prefetch_read(self.start.wrapping_add(line * LINE));
        }
    }
}

/// The address of an array, for prefetches alone: nothing is read through it.
#[derive(Debug, Clone, Copy)]
pub struct Region {
    start: usize,
    /// Bytes of an element.
    size: usize,
}

impl Region {
    /// The region of an array.
    pub fn of<T>(array: &[T]) -> Self {
        Self::at(array.as_ptr())
    }

    /// The region of an array that begins at an address.
    pub fn at<T>(start: *const T) -> Self {
        Self { start: start.addr(), size: size_of::<T>() }
    }

    /// A region of elements without a size: a prefetch of its first line again and again costs less than a branch.
    pub fn first_line(self) -> Self {
        Self { size: 0, ..self }
    }

    /// The addresses of the first and the last of some elements.
    #[inline(always)]
    fn ends(self, elements: &Range<usize>) -> [*const u8; 2] {
        [elements.start, elements.end - 1]
            .map(|k| std::ptr::without_provenance(self.start + k * self.size))
    }
}

/// The arrays that the next chunk of a fused step reads and writes: a loop prefetches them list by list.
#[derive(Debug, Clone, Copy)]
pub struct NextChunk {
    /// Arrays that the next chunk writes.
    pub to_write: [Region; 3],
    /// An array that the next chunk reads.
    pub to_read: Region,
}

impl NextChunk {
    /// Prefetches some elements of all arrays.
    #[inline(always)]
    pub fn prefetch(&self, elements: Range<usize>) {
        for array in self.to_write {
            let [first, last] = array.ends(&elements);
            prefetch_write(first);
            prefetch_write(last);
        }
        let [first, last] = self.to_read.ends(&elements);
        prefetch_read(first);
        prefetch_read(last);
    }
}

/// Number of lines that an array fills.
#[inline(always)]
fn lines<T>(array: &[T]) -> usize {
    size_of_val(array).div_ceil(LINE)
}

/// Prefetches a line that will be read.
#[inline(always)]
pub fn prefetch_read<T>(what: *const T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: every processor of this architecture has the instruction, and it reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(what.cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = what;
}

/// Prefetches a line that will be written, and takes ownership of it from other caches.
#[inline(always)]
pub fn prefetch_write<T>(what: *const T) {
    #[cfg(target_arch = "x86_64")]
    // The instruction is written out: without its target feature, the intrinsic function becomes a prefetch for reading.
    // SAFETY: a processor without the instruction ignores it, and it reads nothing.
    unsafe {
        std::arch::asm!("prefetchw [{}]", in(reg) what, options(nostack, preserves_flags, readonly));
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = what;
}
