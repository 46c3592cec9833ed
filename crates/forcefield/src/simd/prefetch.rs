//! Asking for memory ahead of its use. Nothing but speed depends on it.

/// Bytes of a cache line.
const LINE: usize = 64;

/// Lines that are asked for.
const AHEAD: usize = 8;

/// Asks for the first lines of an array that will soon be read. What goes on in order a processor
/// finds by itself, but not where it begins.
#[inline(always)]
pub fn prefetch<T>(array: &[T]) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..AHEAD.min(size_of_val(array).div_ceil(LINE)) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: every processor of this architecture has the instruction, and it reads nothing.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(array.as_ptr().cast::<i8>().wrapping_add(line * LINE));
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = array;
}

/// Asks for a short array that will soon be read and written.
#[inline(always)]
pub fn prefetch_write_all<T>(array: &[T]) {
    let start: *const u8 = array.as_ptr().cast();
    for line in 0..size_of_val(array).div_ceil(LINE) {
        prefetch_write(start.wrapping_add(line * LINE));
    }
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
