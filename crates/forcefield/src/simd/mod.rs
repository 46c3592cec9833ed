//! The only module with `unsafe` code: registers of lanes, the pair loops over them, and packing.
//!
//! Tokens prove instruction sets ([`level`]), debug builds check every list (`is_valid`), and arrays are checked
//! where they come in ([`output`]). Physics is in the formulas that are passed in. No formula names an instruction set.
//!
//! ```text
//!   level, row                    instruction sets, rows
//!   lanes, registers              operations of a register; avx512, avx2 and portable implement them
//!   frames, cluster_kernel        pairs of one cluster        \
//!   cluster_loop, row_loop        loops over one chunk         > written once for all lanes
//!   arithmetic                    speed limit of the loops    /
//!   motion, packing, pack         from positions to rows
//!   scan, scanners                the search that builds lists
//!   packed_list, packed           lists with their rows; all chunks
//!   list_in_use                   whether a list may be used
//!   evaluation, fused             evaluations, and steps that follow each other
//! ```
#![allow(unsafe_code)]

mod accumulate;
mod arithmetic;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod block_stream;
mod by_level;
mod by_slot;
mod cluster_kernel;
mod cluster_loop;
mod disjoint;
mod evaluation;
mod frames;
mod fused;
mod lanes;
mod level;
mod limit;
mod list_in_use;
mod motion;
mod mover;
mod output;
mod pack;
mod packed;
mod packed_list;
mod packing;
#[cfg(target_arch = "x86_64")]
mod packing256;
mod portable;
mod prefetch;
#[cfg(target_arch = "x86_64")]
mod registers;
mod row;
mod row_loop;
#[cfg(target_arch = "x86_64")]
mod scan;
mod scanners;

pub use by_slot::{by_slot, to_particles};
pub use disjoint::Disjoint;
pub use fused::{SlotState, fused_step};
pub use lanes::{BySpecies, Lanes};
pub use level::{Isa, Level};
pub use limit::limit;
pub use list_in_use::{ListInUse, ListStatus, Ordered};
pub use motion::{MotionSummary, SomeRows};
pub use mover::{KickDrift, Mover, SlotNoise, SumOverChunks};
pub use packed::{PackedCopies, Prepared, Request, are_few};
pub use packed_list::{ChunkLoop, PackedList};
pub use row::{vector_of, words_of};
