//! How slots are cut into chunks.

use std::ops::Range;

/// The most particles per chunk of a list: a constant, so that sums over chunks have one order.
///
/// The number is small, so that 864 particles keep several threads busy.
pub const ATOMS_PER_CHUNK: usize = 48;

/// The smallest number of particles whose order is cut into bundles; below it, one bundle is the whole box.
pub const SMALLEST_CUT: usize = 4000;

/// The slots of each chunk: up to [`ATOMS_PER_CHUNK`] consecutive ones. Chunks begin anew in each bundle.
///
/// So a chunk depends on the particles of its bundle, and not on how many particles come before them.
#[derive(Debug, Clone, Default)]
pub struct ChunkSlots {
    /// The first slot of each chunk, and the end, `[chunks + 1]`.
    ends: Vec<u32>,
}

impl ChunkSlots {
    /// Cuts bundles, given the first slot of each and the end.
    pub(crate) fn cut(&mut self, bundles: impl Iterator<Item = u32>) {
        self.ends.clear();
        self.ends.push(0);
        let mut begin = 0;
        for end in bundles {
            let chunks = (begin..end).step_by(ATOMS_PER_CHUNK).skip(1);
            self.ends.extend(chunks);
            if begin < end {
                self.ends.push(end);
            }
            begin = end;
        }
    }

    /// Number of chunks.
    #[must_use]
    pub fn count(&self) -> usize {
        self.ends.len().saturating_sub(1)
    }

    /// The slots of some consecutive chunks.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, chunks: Range<usize>) -> Range<usize> {
        let slot = |chunk: usize| self.ends.get(chunk).map_or(0, |slot| *slot as usize);
        slot(chunks.start)..slot(chunks.end)
    }

    /// The chunk of a slot.
    #[must_use]
    pub fn chunk_of(&self, slot: u32) -> usize {
        self.ends.partition_point(|first| *first <= slot) - 1
    }

    /// Number of bytes held.
    pub(crate) fn bytes(&self) -> usize {
        4 * self.ends.capacity()
    }
}
