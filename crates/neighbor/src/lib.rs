//! Neighbor lists: a cell grid with periodic images, full Verlet lists built from it, the displacement
//! criterion that keeps them valid, and the brute-force twin that judges them.
//!
//! Lists are *full*: they name all neighbors of a particle, so a force loop writes to nobody else and gives the
//! same bits for any number of threads. A [`NeighborList`] has one for each particle, over particles sorted in space
//! into *rows*, in which periodic images are rows of their own (*ghosts*), so that a force loop needs no minimum image.
//! A [`SharedList`] has one for every four particles, over coordinates in fixed point, whose differences find the image.

mod blocks;
mod brute;
mod columns;
mod counting;
mod criterion;
mod grid;
mod list;
mod missing;
mod reach;
mod scan;
mod shared;
mod shared_scan;
pub mod skin;
mod ways;

pub use blocks::{BLOCK, Block, ENTRY, SharedBlocks, SharedChunk, Span, amid};
pub use brute::{brute_force_pairs, for_each_pair};
pub use columns::{ColumnTable, FIXED_ROUNDING, FIXED_UNITS, to_fixed};
pub use counting::Given;
pub use criterion::{Criterion, MANY, Verdict};
pub use grid::{Ghost, GridError, RowTable};
pub use list::{ATOMS_PER_CHUNK, Entries, Images, ListChunk, NeighborList};
pub use missing::{Cells, Moves, missed_pairs};
pub use scan::{Candidates, Center, Names, Nearby, PADDING, RowScanner, ScalarScanner};
pub use shared::SharedList;
pub use shared_scan::{
    Around, FOR_ALL, FOR_FIRST_TWO, FOR_LAST_TWO, Found, Gathered, SHARERS, ScalarSharedScanner,
    SharedScanner,
};
pub use ways::{Way, Ways};
