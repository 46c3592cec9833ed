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

use crate::sort::{PADDING, RowCoordinates};

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
    /// Number of entries, with padding.
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

/// The neighbors of up to [`ATOMS_PER_CHUNK`](crate::ATOMS_PER_CHUNK) consecutive slots.
#[derive(Debug, Clone)]
pub struct ListChunk {
    /// The first slot.
    pub first_slot: u32,
    /// The number that is added to each entry.
    pub base: u32,
    /// Number of neighbors of each slot.
    pub counts: Vec<u32>,
    /// Neighbors of one slot after another, each padded with the slot itself to whole registers.
    pub entries: Entries,
}

impl Default for ListChunk {
    fn default() -> Self {
        Self { first_slot: 0, base: 0, counts: Vec::new(), entries: Entries::Narrow(Vec::new()) }
    }
}

// The innermost loops of the search: gather the candidates of a group, then find the near ones of each particle.

/// The numbers that list entries use for rows.
#[derive(Debug, Clone, Copy)]
pub enum Numbering<'a> {
    /// The number of the row minus the base.
    Rows {
        /// The number that is subtracted.
        base: u32,
    },
    /// The slot that the row shows, `[rows]` and padding.
    Slots(&'a [u32]),
}

impl Numbering<'_> {
    /// The number of one row.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, row: u32) -> u32 {
        match self {
            Self::Rows { base } => row.wrapping_sub(*base),
            Self::Slots(slots) => slots[row as usize],
        }
    }
}

/// The candidates around a few particles, side by side in memory.
#[derive(Debug, Default, Clone)]
pub struct Candidates {
    /// x of each candidate, σ.
    pub x: Vec<f32>,
    /// y of each candidate, σ.
    pub y: Vec<f32>,
    /// z of each candidate, σ.
    pub z: Vec<f32>,
    /// Number of each candidate in list entries.
    pub number: Vec<u32>,
    /// Count of candidates. One register of elements behind them is near to nothing.
    pub len: usize,
}

impl Candidates {
    /// Makes room for the rows of `runs` and two registers more, and checks that the runs contain rows only.
    ///
    /// # Panics
    /// Where a run contains something else than rows: that is a bug of the caller.
    pub fn make_room(
        &mut self,
        coordinates: &RowCoordinates,
        numbering: &Numbering<'_>,
        runs: &[Range<u32>],
    ) {
        let rows = coordinates.rows();
        let mut total = 0;
        for run in runs {
            assert!(run.start <= run.end && run.end as usize <= rows);
            total += (run.end - run.start) as usize;
        }
        if let Numbering::Slots(slots) = numbering {
            assert!(slots.len() >= rows + PADDING, "slots have the same padding");
        }
        if self.x.len() < total + 2 * PADDING {
            for axis in [&mut self.x, &mut self.y, &mut self.z] {
                axis.resize(total + 2 * PADDING, 0.0);
            }
            self.number.resize(total + 2 * PADDING, 0);
        }
    }

    /// Checks that `elements` of each array can be read, and that `room` suffices for all near candidates.
    ///
    /// # Panics
    /// Where an array is too short: that is a bug of the caller.
    #[inline(always)]
    pub fn check(&self, elements: usize, room: usize) {
        for axis in [&self.x, &self.y, &self.z] {
            assert!(axis.len() >= elements);
        }
        assert!(self.number.len() >= elements);
        assert!(room >= self.len + PADDING);
    }

    /// Ends the gathering at `len` candidates, with one register of infinitely distant elements behind them.
    pub fn finish(&mut self, len: usize) {
        self.len = len;
        // The squared distance to these elements overflows to infinity, which no radius reaches.
        self.x[len..len + PADDING].fill(f32::MAX);
    }
}

/// The particle whose neighbors are searched.
#[derive(Debug, Clone, Copy)]
pub struct Center {
    /// Coordinates in single precision, σ.
    pub at: [f32; 3],
    /// The number of the particle itself, which the search leaves out.
    pub number: u32,
}
