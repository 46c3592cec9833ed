//! The choice of a loop by the level.

/// Calls the function of this name in the module of a level's instruction set, with the token as its first argument.
macro_rules! by_level {
    ($level:expr, $function:ident($($argument:expr),*)) => {
        match $level {
            // SAFETY: the level holds a token, which proves the instruction set. Callers keep every other contract.
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(isa) => unsafe { crate::simd::avx512::$function(isa, $($argument),*) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(isa) => unsafe { crate::simd::avx2::$function(isa, $($argument),*) },
            _ => crate::simd::portable::$function($($argument),*),
        }
    };
}
pub(crate) use by_level;
