//! The blocks of a chunk as a stream of registers, read ahead.
//!
//! ```text
//!   blocks     | block 0          | block 1          | ... | last block |
//!   registers  | part 0 | part 1  | part 0 | part 1  |         (here: two registers per block)
//!                ^ computed now
//!                         ^ gathered ahead
//! ```

use lennard_neighbor::{BLOCK, Block, ClusterChunk, ENTRY_SCALE};

use super::lanes::{FixedLanes, Lanes};
use super::row::FixedRow;

const _: () = assert!(
    size_of::<FixedRow>() == 8 * ENTRY_SCALE as usize,
    "registers add entries to addresses of u64"
);

/// Coordinates and species of a register of neighbors.
pub type Neighbors<L> = ([L; 3], <L as Lanes>::Species);

/// The neighbors of a chunk, block after block, gathered one register ahead of the computation.
///
/// A processor holds fewer waiting instructions than one block has. Gathering ahead starts the loads in time.
pub struct BlockStream<L: FixedLanes> {
    isa: L::Isa,
    rows: *const FixedRow,
    block: *const Block,
    ahead: Neighbors<L>,
}

impl<L: FixedLanes> BlockStream<L> {
    /// Begins with the first block of a chunk.
    ///
    /// # Safety
    /// Every entry of the blocks numbers a row: the list [is valid](lennard_neighbor::ClusterList::is_valid),
    /// and there is a row per slot.
    #[inline(always)]
    pub unsafe fn new(isa: L::Isa, rows: &[FixedRow], chunk: &ClusterChunk) -> Self {
        let (rows, block) = (rows.as_ptr(), chunk.blocks.as_ptr());
        // SAFETY: the contract is passed on; a chunk has at least the block that ends it.
        let ahead = unsafe { Self::gather(isa, rows, block, 0) };
        Self { isa, rows, block, ahead }
    }

    #[inline(always)]
    unsafe fn gather(
        isa: L::Isa,
        rows: *const FixedRow,
        block: *const Block,
        part: usize,
    ) -> Neighbors<L> {
        // SAFETY: the contract is passed on; base plus entry numbers a row.
        unsafe {
            let entries = (*block).entries.as_ptr();
            let rows = rows.add((*block).base as usize);
            L::gather(isa, rows, entries.add(part * L::WIDTH))
        }
    }

    /// The entries of the present block that count.
    ///
    /// # Safety
    /// The contract of [`BlockStream::new`] still holds, and the present block is not behind the last one.
    #[inline(always)]
    pub unsafe fn valid(&self) -> u16 {
        // SAFETY: the contract is passed on.
        unsafe { (*self.block).valid }
    }

    /// One register of the present block; after the last part, the next block becomes the present one.
    ///
    /// # Safety
    /// The contract of [`BlockStream::new`] still holds. Parts are read in their order, and only of blocks of lists.
    #[inline(always)]
    pub unsafe fn next(&mut self, part: usize) -> Neighbors<L> {
        let present = self.ahead;
        // SAFETY: the contract is passed on; behind the last block of a list there is another one.
        unsafe {
            let mut following = part + 1;
            if following == BLOCK / L::WIDTH {
                self.block = self.block.add(1);
                following = 0;
            }
            self.ahead = Self::gather(self.isa, self.rows, self.block, following);
        }
        present
    }

    /// One register of the `ahead`th block behind the present one, which is not read ahead.
    ///
    /// # Safety
    /// The contract of [`BlockStream::new`] still holds, and there is such a block.
    #[inline(always)]
    pub unsafe fn rows(&self, ahead: usize, part: usize) -> Neighbors<L> {
        // SAFETY: the contract is passed on.
        unsafe { Self::gather(self.isa, self.rows, self.block.add(ahead), part) }
    }

    /// The entries of the `ahead`th block behind the present one that count.
    ///
    /// # Safety
    /// As [`BlockStream::rows`].
    #[inline(always)]
    pub unsafe fn valid_of(&self, ahead: usize) -> u16 {
        // SAFETY: the contract is passed on.
        unsafe { (*self.block.add(ahead)).valid }
    }

    /// Goes on by some blocks.
    ///
    /// # Safety
    /// As [`BlockStream::rows`], for the block that becomes the present one.
    #[inline(always)]
    pub unsafe fn skip(&mut self, blocks: usize) {
        // SAFETY: the contract is passed on.
        unsafe {
            self.block = self.block.add(blocks);
            self.ahead = Self::gather(self.isa, self.rows, self.block, 0);
        }
    }
}
