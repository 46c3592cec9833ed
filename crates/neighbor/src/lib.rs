//! Neighbor lists: particles sorted in space, full Verlet lists, and the criterion of their validity.
//!
//! Lists are *full*: they contain all neighbors of a particle. A force loop writes the force of its own particle only,
//! and the result has the same bits for any number of threads.
//!
//! A [`NeighborList`] has one list per particle. Particles are sorted into *rows*. Periodic images are rows of their
//! own (*ghosts*), so that a force loop needs no minimum image.
//!
//! A [`ClusterList`] has one list per *cluster* of four particles. Coordinates are in fixed point, and their differences
//! find the nearest image.
//!
//! Particles are sorted into *bundles*, a few columns of cells side by side. Clusters and *chunks*, the parts of a list, begin
//! anew in each bundle. A list has its entries in an order relative to its owner. A force is a function of the particles
//! nearby alone: its bits do not depend on how many particles lie elsewhere. Small systems are one bundle.
//!
//! A list owns no box. The caller gives the box of each build.
//!
//! # The forms of a position
//!
//! A position has one value, and a form for each reader of it. All but the first follow from it, and no restart needs them.
//!
//! | Form | Numbers, order | Maker | Reason |
//! |---|---|---|---|
//! | `State::positions` | f64, unwrapped, by particle | methods | The one value that observables and files read. |
//! | [`Positions`] | the same, by particle or by slot | caller of a build | Particles keep nearly the same slot: by slot a sort is faster. |
//! | positions and next positions of fused steps | f64, unwrapped, by slot | `FusedBuffers` (forcefield) | Many steps move particles in the order of the list. Few particles write the next step elsewhere, since other threads still read this one. |
//! | positions of the build | f64, unwrapped, by slot | `ListValidity` (forcefield) | Displacements since the build say whether the list is valid. |
//! | folded positions with images | f64 in the box, i32, by slot | [`RowTable`] | A row is the position without its image, so that rows move continuously. |
//! | [`RowCoordinates`] | f32, by row, ghosts included | [`RowTable`] | The search by rows compares sixteen at once. The radius covers the rounding. |
//! | coordinates of a [`ColumnTable`] | i32 by axis, by slot | [`ColumnTable`] | The search by clusters. Differences find the nearest image. They lie in the room of rows. |
//! | rows | four f64 by row, or [`FixedRow`] by slot | `PackedCopies` (forcefield) | One load per neighbor. Few particles have a copy per thread. |
//! | rows of the next step | [`FixedRow`] | chunks of a fused step | A chunk packs while its particles are in the cache. |
//! | [`PackedDisplacement`] | four bytes, by slot | `PackedCopies` (forcefield) | The search for unlisted pairs reads far less memory. |
//! | registers | lanes of f64 or f32 | pair loops | The arithmetic of pairs. |

mod chunk_slots;
mod clusters;
mod pair_list;
mod room;
mod rows;
mod scanner;
pub mod skin;
mod sort;
mod unlisted;
mod validity;

pub use chunk_slots::{ATOMS_PER_CHUNK, ChunkSlots, SMALLEST_CUT};
pub use clusters::{
    ALL_MEMBERS, BLOCK, Block, CLUSTER, ClusterBlocks, ClusterChunk, ClusterList, ClusterNeighbors,
    ENTRY_SCALE, ExcludedEntries, FIRST_HALF, GroupBounds, GroupCandidates, Reach, SECOND_HALF,
    Span, THEMSELVES, cluster_center,
};
pub use pair_list::PairList;
pub use rows::{Candidates, Center, Entries, Images, ListChunk, NeighborList, Numbering};
pub use scanner::{Found, ScalarScanner, Scanner};
pub use sort::{
    Belongs, Beyond, Cells, ColumnTable, Columns, FIXED_ROUNDING, FIXED_UNITS, FixedRow, Ghost,
    GridError, PADDING, Positions, RowCoordinates, RowTable, is_usable, to_fixed, with_rounding,
};
pub use unlisted::{
    DisplacementScale, Displacements, NowAndThen, PackedDisplacement, Partners, unlisted_pairs,
};
pub use validity::{Criterion, LARGE_SYSTEM, Validity, farthest_apart};
