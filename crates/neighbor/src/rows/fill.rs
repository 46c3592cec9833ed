//! The search that fills the chunks of a neighbor list.

use std::ops::Range;

use lennard_core::Exclusions;

use super::chunk::{Entries, Images, ListChunk};
use super::scan::{Candidates, Center, Numbering};
use crate::room::give_back;
use crate::scanner::{Found, Scanner};
use crate::sort::{PADDING, RowTable};

/// Buffers that one thread reuses while it fills chunks.
#[derive(Default)]
pub struct Scratch {
    runs: Vec<Range<u32>>,
    candidates: Candidates,
}

/// Fills chunks; all chunks of a build share it.
pub struct Filler<'a> {
    pub table: &'a RowTable,
    /// The square of the search radius, σ².
    pub radius2: f32,
    pub images: Images,
    /// Entries of a slot are padded to a multiple of this number.
    pub lanes: usize,
    pub scanner: &'a dyn Scanner,
    /// Pairs that are left out.
    pub exclusions: Exclusions,
}

impl Filler<'_> {
    /// Writes the neighbors of `slots` to a chunk.
    pub fn fill(&self, slots: Range<usize>, scratch: &mut Scratch, chunk: &mut ListChunk) {
        chunk.first_slot = slots.start as u32;
        chunk.counts.clear();
        let targets = match self.images {
            Images::Ghosts => self.table.rows_near(&slots),
            Images::Folded => 0..self.table.particle.len() as u32,
        };
        chunk.base = targets.start;
        let narrow = targets.end - targets.start <= u32::from(u16::MAX) + 1;
        let counts = &mut chunk.counts;
        let old = std::mem::replace(&mut chunk.entries, Entries::Wide(Vec::new()));
        chunk.entries = if narrow {
            let entries = if let Entries::Narrow(entries) = old { entries } else { Vec::new() };
            let to: fn(&mut [_]) -> Found<'_> = |found| Found::Narrow(found);
            let how = (|number| number as u16, to);
            Entries::Narrow(self.write(slots, chunk.base, scratch, counts, entries, how))
        } else {
            let entries = if let Entries::Wide(entries) = old { entries } else { Vec::new() };
            let to: fn(&mut [_]) -> Found<'_> = |found| Found::Wide(found);
            let how = (|number| number, to);
            Entries::Wide(self.write(slots, chunk.base, scratch, counts, entries, how))
        };
    }

    /// Closes up entries over the particles that the particle at `slot` does not interact with; returns the count left.
    fn leave_out<E: Copy + Into<u32>>(&self, slot: usize, base: u32, found: &mut [E]) -> usize {
        let particle = &self.table.particle;
        let own = particle[slot] as usize;
        let mut kept = 0;
        for at in 0..found.len() {
            let entry = found[at];
            let other = match self.images {
                Images::Ghosts => self.table.slots()[(base + entry.into()) as usize],
                Images::Folded => entry.into(),
            };
            if !self.exclusions.exclude(own, particle[other as usize] as usize) {
                found[kept] = entry;
                kept += 1;
            }
        }
        kept
    }

    /// Writes the entries of `slots` over the entries of an earlier build.
    ///
    /// `of` gives the entry of a number, and `to` says how long entries are.
    ///
    /// Old entries stay behind the new ones, since clearing them would cost as much as a search.
    fn write<E: Copy + Default + Into<u32>>(
        &self,
        slots: Range<usize>,
        base: u32,
        scratch: &mut Scratch,
        counts: &mut Vec<u32>,
        mut entries: Vec<E>,
        (of, to): (impl Fn(u32) -> E, for<'a> fn(&'a mut [E]) -> Found<'a>),
    ) -> Vec<E> {
        let table = self.table;
        let numbering = match self.images {
            Images::Ghosts => Numbering::Rows { base },
            Images::Folded => Numbering::Slots(table.padded_slots()),
        };
        let Scratch { runs, candidates } = scratch;
        let mut written = 0;
        let mut first = slots.start;
        while first < slots.end {
            let end = table.group_end(first, slots.end);
            table.runs_near(first, end - 1, runs);
            self.scanner.gather_rows(&table.coordinates, numbering, runs, candidates);
            for slot in first..end {
                let row = table.row[slot];
                let center =
                    Center { at: table.coordinates.at(row as usize), number: numbering.of(row) };
                let room = written + candidates.len + 2 * PADDING;
                if entries.len() < room {
                    entries.resize(room, E::default());
                }
                let found = &mut entries[written..];
                let mut count =
                    self.scanner.near(candidates, center, self.radius2, to(&mut *found));
                if !self.exclusions.are_none() {
                    count = self.leave_out(slot, base, &mut found[..count]);
                }
                let padded = count.next_multiple_of(self.lanes);
                found[count..padded].fill(of(center.number));
                counts.push(count as u32);
                written += padded;
            }
            first = end;
        }
        give_back(&mut entries);
        entries
    }
}
