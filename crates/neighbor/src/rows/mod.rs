//! Full Verlet lists with one row of neighbors per particle.

mod chunk;
mod fill;
mod list;
mod scan;

pub use chunk::{ATOMS_PER_CHUNK, Entries, Images, ListChunk};
pub use list::NeighborList;
pub use scan::{Candidates, Center, Numbering};
