//! Asking for memory ahead of its use. Nothing but speed depends on it.

use std::ops::Range;

use super::Scatter;

/// Bytes of a cache line.
const LINE: usize = 64;

/// Lines that are asked for where an array begins.
const BEGINNING: usize = 8;

/// Asks for the first lines of an array that will soon be read. What goes on in order a processor
/// finds by itself, but not where it begins.
#[inline(always)]
pub fn prefetch<T>(array: &[T]) {
    let beginning = Parts {
        start: array.as_ptr().cast(),
        lines: lines(array).min(BEGINNING),
    };
    beginning.ask(0);
}

/// An array that will be read after much else, asked for in parts.
#[derive(Debug, Clone, Copy)]
pub struct Parts {
    start: *const u8,
    /// Lines of each part.
    lines: usize,
}

impl Parts {
    /// As many parts of an array, of whole lines each.
    pub fn of<T>(array: &[T], parts: usize) -> Self {
        Self {
            start: array.as_ptr().cast(),
            lines: lines(array).div_ceil(parts.max(1)),
        }
    }

    /// Asks for a part; of the last ones there may be nothing left.
    #[inline(always)]
    pub fn ask(&self, part: usize) {
        for line in part * self.lines..(part + 1) * self.lines {
            prefetch_read(self.start.wrapping_add(line * LINE));
        }
    }
}

/// An array of which some is asked for with each list that a loop takes up.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// Its address: nothing is read there.
    start: usize,
    /// Bytes of an element.
    size: usize,
}

impl Asked {
    /// An array.
    pub fn of<T>(array: &[T]) -> Self {
        Self {
            start: array.as_ptr().addr(),
            size: size_of::<T>(),
        }
    }

    /// One that several threads write.
    pub fn scattered<T: Copy>(array: &Scatter<'_, T>) -> Self {
        Self {
            start: array.address(),
            size: size_of::<T>(),
        }
    }

    /// The beginning of this one over and over, which costs less than a branch.
    pub fn none_of(self) -> Self {
        Self { size: 0, ..self }
    }

    /// The addresses of the first and the last of some elements. Lines that begin in the last one come with those after it.
    #[inline(always)]
    fn ends(self, elements: &Range<usize>) -> [*const u8; 2] {
        [elements.start, elements.end - 1]
            .map(|k| std::ptr::without_provenance(self.start + k * self.size))
    }
}

/// What a loop asks for ahead of the chunk that comes next.
#[derive(Debug, Clone, Copy)]
pub struct Later {
    /// Arrays that it will write.
    pub to_write: [Asked; 3],
    /// An array that it will read.
    pub to_read: Asked,
}

impl Later {
    /// Asks for some elements of all.
    #[inline(always)]
    pub fn ask(&self, elements: Range<usize>) {
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

/// Lines that an array fills.
#[inline(always)]
fn lines<T>(array: &[T]) -> usize {
    size_of_val(array).div_ceil(LINE)
}

/// Asks for the line of something that will be read.
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

/// Asks for the line of something that will soon be written, and for leave to write it.
#[inline(always)]
pub fn prefetch_write<T>(what: *const T) {
    #[cfg(target_arch = "x86_64")]
    // By name: the intrinsic function asks for leave to read alone where a compiler is not told of the instruction.
    // SAFETY: processors without it take it for one that does nothing, and it reads nothing.
    unsafe {
        std::arch::asm!("prefetchw [{}]", in(reg) what, options(nostack, preserves_flags, readonly));
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = what;
}
