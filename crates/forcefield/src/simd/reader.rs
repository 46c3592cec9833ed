//! The blocks of shared lists, read ahead.

use lennard_neighbor::{BLOCK, Block, SharedChunk};

use super::FixedRow;
use super::lanes::{FixedLanes, Scaled};

/// The blocks of a chunk one after another, gathered a register ahead of those that are computed: what a processor can
/// hold of instructions that wait is less than a block, and so those of the next one are at hand in time.
pub struct Reader<L: FixedLanes> {
    rows: *const FixedRow,
    block: *const Block,
    ahead: L::Own,
}

impl<L: FixedLanes> Reader<L> {
    /// Begins with the first block of a chunk.
    ///
    /// # Safety
    /// The processor has the instruction set of `L`, and entries of blocks name rows.
    #[inline(always)]
    pub unsafe fn new(rows: &[FixedRow], chunk: &SharedChunk) -> Self {
        let (rows, block) = (rows.as_ptr(), chunk.blocks.as_ptr());
        // SAFETY: the contract is passed on; a chunk has at least the block that ends it.
        let ahead = unsafe { Self::gather(rows, block, 0) };
        Self { rows, block, ahead }
    }

    #[inline(always)]
    unsafe fn gather(rows: *const FixedRow, block: *const Block, part: usize) -> L::Own {
        // SAFETY: the contract is passed on; base plus entry names a row.
        unsafe {
            let entries = (*block).entries.as_ptr().cast::<Scaled>();
            let rows = rows.add((*block).base as usize);
            L::gather(rows, entries.add(part * L::WIDTH))
        }
    }

    /// Which entries of the present block count.
    ///
    /// # Safety
    /// As [`Reader::new`].
    #[inline(always)]
    pub unsafe fn valid(&self) -> u16 {
        // SAFETY: the contract is passed on.
        unsafe { (*self.block).valid }
    }

    /// The register with a part of the present block; after the last part, the next block is the present one.
    ///
    /// # Safety
    /// As [`Reader::new`]; parts are asked for in their order, and of the blocks of lists alone.
    #[inline(always)]
    pub unsafe fn next(&mut self, part: usize) -> L::Own {
        let present = self.ahead;
        // SAFETY: the contract is passed on; behind the last block of a list there is another one.
        unsafe {
            let mut following = part + 1;
            if following == BLOCK / L::WIDTH {
                self.block = self.block.add(1);
                following = 0;
            }
            self.ahead = Self::gather(self.rows, self.block, following);
        }
        present
    }
}
