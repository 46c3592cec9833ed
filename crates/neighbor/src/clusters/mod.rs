//! Full lists in fixed point, one per cluster of four particles.

mod block;
mod chunk;
pub(crate) mod format;
mod found;
mod list;
mod search;

pub use block::Block;
pub use chunk::{ClusterBlocks, ClusterChunk, Span};
pub use format::{BLOCK, CLUSTER, ENTRY_SCALE, Reach, cluster_center};
pub use found::{
    ALL_MEMBERS, ClusterNeighbors, ExcludedEntries, FIRST_HALF, GroupBounds, GroupCandidates,
    SECOND_HALF, THEMSELVES,
};
pub use list::ClusterList;
