//! Full Verlet lists with one row of neighbors per particle.

mod chunk;
mod list;

pub use chunk::{Candidates, Center, Entries, Images, ListChunk, Numbering};
pub use list::NeighborList;
