//! Lanes of AVX-512: eight doubles or sixteen singles.

mod doubles;
mod singles;

pub use doubles::F64x8;
pub use singles::F32x16;

use super::arithmetic::arithmetic;
use super::by_level::run_loops;
use super::cluster_loop::{self, ClusterJob};
use super::level::Avx512;
use super::output::Output;
use super::row::{DoubleRow, FixedRow};
use super::row_loop::{self, RowJob};
use crate::interaction::Interaction;
use crate::options::Precision;
use crate::sums::{Detail, Totals};

run_loops!(Avx512, "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt", F64x8, F32x16);
