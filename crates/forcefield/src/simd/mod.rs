//! The one module with `unsafe` code: registers of lanes, the pair loop over them, and writes to
//! scattered but distinct places.
//!
//! Everything that callers must guarantee is checked where arrays come in, [`Output::new`] first of all; the
//! physics is in the formulas that are passed in, none of which names an instruction set.
#![allow(unsafe_code)]

/// Calls what the module of a level's instruction set has under a name.
macro_rules! by_level {
    ($level:expr, $function:ident($($argument:expr),*)) => {
        match $level {
            // SAFETY: a level is chosen by `Level::choose`, which gives available ones alone.
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => unsafe { crate::simd::avx512::$function($($argument),*) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => unsafe { crate::simd::avx2::$function($($argument),*) },
            _ => crate::simd::portable::$function($($argument),*),
        }
    };
}

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod course;
mod lanes;
mod next;
mod output;
mod packing;
#[cfg(target_arch = "x86_64")]
mod packing256;
mod pair_list;
mod pair_loop;
mod pair_sums;
mod portable;
mod prefetch;
mod reader;
#[cfg(target_arch = "x86_64")]
mod registers;
#[cfg(target_arch = "x86_64")]
mod scan;
#[cfg(target_arch = "x86_64")]
mod scan256;
#[cfg(target_arch = "x86_64")]
mod scan512;
mod scatter;
mod shared_loop;
mod view;

pub use course::{OnTheWay, advance, bring_back, take};
pub use next::{Next, Strayed};
pub use output::Output;
pub use packing::{Motion, Moved, Pace};
pub use pair_list::PairList;
pub use pair_loop::{ChunkTotals, PairJob, PerParticle, Wanted};
pub use scatter::Scatter;
pub use shared_loop::SharedJob;

use crate::options::{Isa, Precision};
use crate::truncation::PairForm;
use glam::DVec3;
use lennard_core::parallel::map_ranges;
use lennard_neighbor::{
    Around, Candidates, Center, ColumnTable, Found, Gathered, Names, Nearby, RowScanner, RowTable,
    SHARERS, ScalarScanner, ScalarSharedScanner, SharedScanner, Way,
};
use std::ops::Range;

/// A coordinate row in double precision: x, y, z in σ, and padding.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(32))]
pub struct DoubleRow(pub [f64; 4]);

/// A coordinate row in fixed point: x, y, z in units of L/2³² along each axis, and padding.
///
/// Differences of such numbers are exact, and wrap around as the periodic box does.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C, align(16))]
pub struct FixedRow(pub [i32; 4]);

/// The instruction set of a kernel, after every choice has been made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// AVX-512 F, BW, DQ, VL, with FMA.
    Avx512,
    /// AVX2 with FMA.
    Avx2,
    /// None in particular.
    Portable,
}

impl Level {
    /// Whether this processor has it.
    pub fn is_available(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("fma")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2")
                    && is_x86_feature_detected!("popcnt")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx512 | Self::Avx2 => false,
            Self::Portable => true,
        }
    }

    /// The level that an option asks for; `None` where this processor lacks it.
    pub fn choose(isa: Isa) -> Option<Self> {
        let wanted = match isa {
            Isa::Auto => {
                return [Self::Avx512, Self::Avx2, Self::Portable]
                    .into_iter()
                    .find(|l| l.is_available());
            }
            Isa::Avx512 => Self::Avx512,
            Isa::Avx2 => Self::Avx2,
            Isa::Portable => Self::Portable,
        };
        wanted.is_available().then_some(wanted)
    }

    /// The name in run records and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Avx512 => "avx512",
            Self::Avx2 => "avx2",
            Self::Portable => "portable",
        }
    }

    /// Doubles of one register: what entries of rows are padded to.
    pub fn lanes(self) -> usize {
        match self {
            Self::Avx512 => 8,
            Self::Avx2 => 4,
            Self::Portable => 2,
        }
    }

    /// The scanner that builds lists at this level.
    pub fn scanner(self) -> &'static dyn RowScanner {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => &Avx512Scanner,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => &Avx2Scanner,
            _ => &ScalarScanner,
        }
    }

    /// The scanner that builds shared lists at this level.
    pub fn shared_scanner(self) -> &'static dyn SharedScanner {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => &Avx512Scanner,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => &Avx2Scanner,
            _ => &ScalarSharedScanner,
        }
    }
}

macro_rules! scanner {
    ($name:ident, $module:ident) => {
        #[cfg(target_arch = "x86_64")]
        struct $name;

        #[cfg(target_arch = "x86_64")]
        impl RowScanner for $name {
            fn gather(
                &self,
                candidates: &Candidates,
                names: Names<'_>,
                runs: &[Range<u32>],
                nearby: &mut Nearby,
            ) {
                // SAFETY: this scanner is handed out by `Level::scanner` of a level that is available.
                unsafe { $module::gather(candidates, names, runs, nearby) }
            }

            fn near_narrow(
                &self,
                nearby: &Nearby,
                center: Center,
                radius2: f32,
                found: &mut [u16],
            ) -> usize {
                // SAFETY: as above.
                unsafe { $module::near_narrow(nearby, center, radius2, found) }
            }

            fn near_wide(
                &self,
                nearby: &Nearby,
                center: Center,
                radius2: f32,
                found: &mut [u32],
            ) -> usize {
                // SAFETY: as above.
                unsafe { $module::near_wide(nearby, center, radius2, found) }
            }
        }

        #[cfg(target_arch = "x86_64")]
        impl SharedScanner for $name {
            fn gather(
                &self,
                table: &ColumnTable,
                around: &Around,
                runs: &[Range<u32>],
                gathered: &mut Gathered,
            ) {
                // SAFETY: as above.
                unsafe { $module::gather_shared(table, around, runs, gathered) }
            }

            fn near(
                &self,
                gathered: &Gathered,
                around: &Around,
                own: [[f32; 3]; SHARERS],
                first: u32,
                found: &mut Found,
            ) {
                // Two loops, each of which has registers enough for its constants.
                // SAFETY: as above.
                unsafe {
                    match around.folds {
                        None => $module::near_shared::<false>(
                            gathered, around, own, [0.0; 3], first, found,
                        ),
                        Some(sides) => {
                            $module::near_shared::<true>(gathered, around, own, sides, first, found)
                        }
                    }
                }
            }
        }
    };
}

scanner!(Avx512Scanner, scan512);
scanner!(Avx2Scanner, scan256);

/// The arithmetic of pairs with everything in registers; see [`pair_loop::arithmetic`].
pub fn limit<F: PairForm>(
    level: Level,
    precision: Precision,
    form: &F,
    r_cut: f64,
    rounds: u64,
) -> (u64, f64) {
    by_level!(level, limit(form, r_cut, rounds, precision))
}

/// Who packs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// The calling thread.
    OneThread,
    /// All threads of the pool.
    All,
}

/// Writes all rows in double precision, ghosts included, and ways where they are wanted. Gives the displacements since the
/// build.
pub fn pack_double(
    level: Level,
    by: By,
    table: &RowTable,
    motion: Motion<'_>,
    rows: &mut [DoubleRow],
    ways: Option<&mut [Way]>,
) -> Moved {
    let rows = Scatter::new(rows);
    // SAFETY: tasks have disjoint places, places have distinct rows, and ghosts are written afterwards; a level is
    // chosen by `Level::choose`, which gives available ones alone.
    let pack = |motion: Motion<'_>, first, squares: &mut [f64]| unsafe {
        match level {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 | Level::Avx2 => {
                packing256::pack_double(table, motion, first, squares, &rows);
            }
            _ => packing::pack_double(table, motion, first, squares, &rows),
        }
    };
    let moved = pack_places(level, by, motion, ways, pack);
    // SAFETY: tasks have disjoint ghosts, and all other rows are at rest; the level is available.
    in_tasks(by, table.ghosts.len(), |ghosts| unsafe {
        match level {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 | Level::Avx2 => {
                packing256::pack_ghosts(table, motion.lengths, ghosts, &rows);
            }
            _ => packing::pack_ghosts(table, motion.lengths, ghosts, &rows),
        }
        Moved::NOTHING
    });
    moved
}

/// Writes the rows of all places in fixed point; as [`pack_double`].
pub fn pack_columns(
    level: Level,
    by: By,
    table: &ColumnTable,
    motion: Motion<'_>,
    rows: &mut [FixedRow],
    ways: Option<&mut [Way]>,
) -> Moved {
    let rows = Scatter::new(rows);
    // SAFETY: tasks have disjoint places.
    pack_places(level, by, motion, ways, |motion, first, squares| unsafe {
        pack_columns_part(level, table, motion, first, Some(squares), &rows);
    })
}

/// Writes the rows of some places; see [`packing::pack_columns`].
///
/// # Safety
/// As there.
unsafe fn pack_columns_part(
    level: Level,
    table: &ColumnTable,
    motion: Motion<'_>,
    first: usize,
    squares: Option<&mut [f64]>,
    rows: &Scatter<'_, FixedRow>,
) {
    // SAFETY: the contract is passed on; the level is available.
    unsafe {
        match level {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 | Level::Avx2 => {
                packing256::pack_columns(table, motion, first, squares, rows);
            }
            _ => packing::pack_columns(table, motion, first, squares, rows),
        }
    }
}

/// Packs all places in batches, and writes ways where they are wanted; see [`packing::in_batches`].
fn pack_places(
    level: Level,
    by: By,
    motion: Motion<'_>,
    ways: Option<&mut [Way]>,
    pack: impl Fn(Motion<'_>, usize, &mut [f64]) + Sync,
) -> Moved {
    let ways = ways.map(Scatter::new);
    in_tasks(by, motion.order.len(), |places| {
        // SAFETY: tasks have disjoint places.
        unsafe { packing::in_batches(level, motion, places, ways.as_ref(), &pack) }
    })
}

/// Writes ways; see [`packing::write_ways`].
fn write_ways(level: Level, motion: Motion<'_>, squares: &[f64], ways: &mut [Way]) {
    match level {
        // SAFETY: a level is chosen by `Level::choose`, which gives available ones alone.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 | Level::Avx2 => unsafe { packing256::write_ways(motion, squares, ways) },
        _ => packing::write_ways(motion, squares, ways),
    }
}

/// Two half kicks and a drift of some particles, which gives a bound for their steps; see [`packing::go_on`].
fn go_on(
    level: Level,
    positions: &mut [DVec3],
    velocities: &mut [DVec3],
    forces: &[DVec3],
    pace: Pace,
) -> f64 {
    match level {
        // SAFETY: a level is chosen by `Level::choose`, which gives available ones alone.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 | Level::Avx2 => unsafe {
            packing256::go_on(positions, velocities, forces, pace)
        },
        _ => packing::go_on(positions, velocities, forces, pace, DVec3::ZERO),
    }
}

fn in_tasks(by: By, n: usize, task: impl Fn(Range<usize>) -> Moved + Sync) -> Moved {
    if by == By::OneThread {
        return task(0..n);
    }
    map_ranges(n, task)
        .into_iter()
        .fold(Moved::NOTHING, Moved::and)
}
