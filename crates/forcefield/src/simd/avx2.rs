//! Lanes of AVX2 with FMA: four doubles or eight singles.

mod doubles;
mod singles;

pub use doubles::F64x4;
pub use singles::F32x8;

use super::arithmetic::arithmetic;
use super::by_level::run_loops;
use super::cluster_loop::{self, ClusterJob};
use super::level::Avx2;
use super::output::Output;
use super::row::{DoubleRow, FixedRow};
use super::row_loop::{self, RowJob};
use crate::interaction::Interaction;
use crate::options::Precision;
use crate::sums::{Detail, Totals};

run_loops!(Avx2, "avx2,fma,bmi1,bmi2,popcnt", F64x4, F32x8);
