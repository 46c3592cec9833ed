//! The cells of a sort, as the search for unlisted pairs reads them.

use std::ops::Range;

use glam::DVec3;

/// Particles sorted into cells, as they were when a list was built; the cells of a column along z follow each other.
pub trait Cells: Sync {
    /// Number of cells along each axis.
    fn count(&self) -> [u32; 3];

    /// Where the particle at a slot lies across the columns along x and y, in columns from the face of the box. The sort had
    /// its position `r` in a box of these sides, σ.
    fn across(&self, slot: usize, r: DVec3, lengths: DVec3) -> [f64; 2];

    /// The slots of the particles in the column at (x, y), between two cells along z, both included.
    fn slots(&self, x: u32, y: u32, z: [u32; 2]) -> Range<u32>;
}
