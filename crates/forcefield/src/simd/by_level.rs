//! The choice of a loop by the level.

/// Calls the function of this name in the module of a level's instruction set, with the token as its first argument. Without one, it
/// evaluates the last expression.
macro_rules! by_level {
    ($level:expr, $function:ident($($argument:expr),*), $portable:expr) => {
        match $level {
            // SAFETY: the level holds a token, which proves the instruction set. Callers keep every other contract.
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(isa) => unsafe { crate::simd::avx512::$function(isa, $($argument),*) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(isa) => unsafe { crate::simd::avx2::$function(isa, $($argument),*) },
            _ => $portable,
        }
    };
}
pub(crate) use by_level;

/// Defines what [`by_level`] calls: the loops on the registers of a token, compiled for its instruction set.
#[cfg(target_arch = "x86_64")]
macro_rules! run_loops {
    ($token:ident, $features:literal, $doubles:ty, $singles:ty) => {
        /// The loop over row lists.
        #[target_feature(enable = $features)]
        pub fn run_double<I: Interaction>(
            isa: $token,
            job: &RowJob<'_, I>,
            rows: &[DoubleRow],
            chunk: usize,
            detail: Detail,
            output: &Output<'_>,
        ) -> Totals {
            // SAFETY: the caller runs each chunk once.
            unsafe { row_loop::run::<$doubles, I>(isa, job, rows, chunk, detail, output) }
        }

        /// The loop over cluster lists.
        #[target_feature(enable = $features)]
        pub fn run_cluster<I: Interaction>(
            isa: $token,
            job: &ClusterJob<'_, I>,
            rows: &[FixedRow],
            chunk: usize,
            detail: Detail,
            output: &Output<'_>,
        ) -> Totals {
            // SAFETY: as above.
            unsafe { cluster_loop::run::<$singles, I>(isa, job, rows, chunk, detail, output) }
        }

        /// The arithmetic of a number of rounds without memory, in a precision.
        #[target_feature(enable = $features)]
        pub fn limit(isa: $token, r_cut: f64, rounds: u64, precision: Precision) -> (u64, f64) {
            match precision {
                Precision::Double => arithmetic::<$doubles>(isa, r_cut, rounds),
                Precision::Mixed => arithmetic::<$singles>(isa, r_cut, rounds),
            }
        }
    };
}
#[cfg(target_arch = "x86_64")]
pub(crate) use run_loops;
