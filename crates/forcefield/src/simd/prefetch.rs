//! Asking for memory ahead of its use. Nothing but speed depends on it.

use std::ops::Range;

/// Bytes of a cache line.
const LINE: usize = 64;

/// Lines that are asked for where an array begins.
const BEGINNING: usize = 8;

/// Asks for the first lines of an array that will soon be read. What goes on in order a processor
/// finds by itself, but not where it begins.
#[inline(always)]
pub fn prefetch<T>(array: &[T]) {
    for line in lines(array).take(BEGINNING) {
        prefetch_read(line);
    }
}

/// Asks for what an array has of a part, which will be read after much else.
#[inline(always)]
pub fn prefetch_part<T>(array: &[T], part: Range<usize>) {
    let end = part.end.min(array.len());
    if let Some(part) = array.get(part.start..end) {
        lines(part).for_each(prefetch_read);
    }
}

/// An address in each line of an array.
#[inline(always)]
fn lines<T>(array: &[T]) -> impl Iterator<Item = *const u8> {
    let start: *const u8 = array.as_ptr().cast();
    (0..size_of_val(array).div_ceil(LINE)).map(move |line| start.wrapping_add(line * LINE))
}

/// Asks for the line of something that will be read.
#[inline(always)]
fn prefetch_read<T>(what: *const T) {
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
