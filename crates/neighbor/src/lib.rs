//! Neighbor lists: particles sorted in space, full Verlet lists, the criterion of their validity, and a brute-force search.
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
//! A list owns no box. The caller gives the box of each build.

mod brute;
mod clusters;
mod kept;
mod pair_list;
mod room;
mod rows;
pub mod skin;
mod sort;
mod unlisted;
mod validity;

pub use brute::{brute_force_pairs, for_each_pair};
pub use clusters::{
    ALL_MEMBERS, BLOCK, Block, CLUSTER, ClusterBlocks, ClusterChunk, ClusterList, ClusterNeighbors,
    ClusterScanner, ENTRY_SCALE, ExcludedEntries, FIRST_HALF, GroupBounds, GroupCandidates, Reach,
    SECOND_HALF, ScalarClusterScanner, Span, THEMSELVES, cluster_center,
};
pub use kept::slots_of;
pub use pair_list::PairList;
pub use rows::{
    ATOMS_PER_CHUNK, Candidates, Center, Entries, Images, ListChunk, NeighborList, Numbering,
    RowScanner, ScalarScanner,
};
pub use sort::{
    Around, Cells, ColumnTable, FIXED_ROUNDING, FIXED_UNITS, FixedRow, Ghost, GridError, PADDING,
    Positions, Ranks, RowCoordinates, RowTable, to_fixed,
};
pub use unlisted::{
    DisplacementScale, Displacements, NowAndThen, PackedDisplacement, Partners, unlisted_pairs,
};
pub use validity::{Criterion, LARGE_SYSTEM, Validity};
