//! Numbers at lines of the cache.

/// Numbers that begin where a line of the cache does: registers of them are written and read without a split.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub struct Aligned<T>(pub T);
