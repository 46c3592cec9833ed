//! Full lists in fixed point, one per cluster of four particles.

mod block;
mod chunk;
mod excluded;
pub(crate) mod format;
mod found;
mod group;
mod list;
mod pack;
mod scan;
mod search;

pub use block::Block;
pub use chunk::{ClusterBlocks, ClusterChunk, Span};
pub use excluded::{ExcludedEntries, THEMSELVES};
pub use format::{BLOCK, CLUSTER, ENTRY_SCALE, Reach, cluster_center};
pub use found::{ALL_MEMBERS, ClusterNeighbors, FIRST_HALF, SECOND_HALF};
pub use group::{GroupBounds, GroupCandidates};
pub use list::ClusterList;
pub use scan::{ClusterScanner, ScalarClusterScanner};
