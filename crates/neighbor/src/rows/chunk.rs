//! The part of a neighbor list that one task reads.
//!
//! ```text
//!   counts    3               2           ...       neighbors of each slot of the chunk
//!   entries   a  b  c  .   d  e  .  .     ...       offsets from `base`; `.` is padding to whole registers
//!             \________/   \________/
//!              slot s       slot s + 1              (here with registers of 4 lanes)
//!
//!   row (or slot) of an entry = base + entry;   padding names the slot itself
//! ```

use std::ops::Range;

/// Particles per chunk of a list: a constant, so that sums over chunks have one order.
///
/// The number is small, so that 864 particles keep several threads busy.
pub const ATOMS_PER_CHUNK: usize = 48;

/// What the entries of a list number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Images {
    /// Entries number rows: each periodic image is a ghost row of its own.
    Ghosts,
    /// Entries number slots: the force loop finds the nearest image by arithmetic.
    Folded,
}

/// List entries, relative to the base of the chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Entries {
    /// 16-bit offsets, where they reach far enough.
    Narrow(Vec<u16>),
    /// 32-bit offsets.
    Wide(Vec<u32>),
}

impl Entries {
    /// Number of entries, with padding and with unused entries at the end.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Narrow(v) => v.len(),
            Self::Wide(v) => v.len(),
        }
    }

    /// Whether there is no entry.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The entries of a range, without the base.
    pub fn offsets(&self, range: Range<usize>) -> Vec<u32> {
        match self {
            Self::Narrow(v) => v[range].iter().map(|e| u32::from(*e)).collect(),
            Self::Wide(v) => v[range].to_vec(),
        }
    }

    /// Number of bytes held.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Narrow(v) => 2 * v.capacity(),
            Self::Wide(v) => 4 * v.capacity(),
        }
    }
}

/// The neighbors of up to [`ATOMS_PER_CHUNK`] consecutive slots.
#[derive(Debug, Clone)]
pub struct ListChunk {
    /// The first slot.
    pub first_slot: u32,
    /// The number that is added to each entry.
    pub base: u32,
    /// Number of neighbors of each slot.
    pub counts: Vec<u32>,
    /// Neighbors of one slot after another, each padded with the slot itself to whole registers.
    ///
    /// Entries behind the last slot have no meaning.
    pub entries: Entries,
}

impl Default for ListChunk {
    fn default() -> Self {
        Self { first_slot: 0, base: 0, counts: Vec::new(), entries: Entries::Narrow(Vec::new()) }
    }
}
