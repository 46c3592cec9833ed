//! Full Verlet lists in chunks of constant size.

use lennard_core::PeriodicBox;
use lennard_core::parallel::part;
use lennard_core::tasks::for_each_item;
use std::ops::Range;

use crate::blocks::give_back;
use crate::counting::Given;
use crate::grid::{GridError, RowTable};
use crate::scan::{Center, Names, Nearby, PADDING, RowScanner};

/// Particles a chunk of the list: a constant, so that sums over chunks have one order. Small, so that
/// 864 particles still keep several threads busy.
pub const ATOMS_PER_CHUNK: usize = 48;

/// What list entries name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Images {
    /// Rows, so that a periodic image is its own ghost row.
    Ghosts,
    /// Places: the force loop's own arithmetic finds the image.
    Folded,
}

/// List entries, relative to the chunk's base.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Entries {
    /// 16-bit offsets, where they reach.
    Narrow(Vec<u16>),
    /// 32-bit offsets.
    Wide(Vec<u32>),
}

impl Entries {
    /// Number of entries, padding and what means nothing included.
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

    fn bytes(&self) -> usize {
        match self {
            Self::Narrow(v) => 2 * v.capacity(),
            Self::Wide(v) => 4 * v.capacity(),
        }
    }
}

/// The neighbors of up to [`ATOMS_PER_CHUNK`] consecutive places.
#[derive(Debug, Clone)]
pub struct ListChunk {
    /// The first place.
    pub first_place: u32,
    /// What is added to each entry.
    pub base: u32,
    /// Number of neighbors of each place.
    pub counts: Vec<u32>,
    /// Neighbors of one place after another, each padded with the place itself to whole registers; what
    /// comes after those of the last place means nothing.
    pub entries: Entries,
}

impl Default for ListChunk {
    fn default() -> Self {
        Self {
            first_place: 0,
            base: 0,
            counts: Vec::new(),
            entries: Entries::Narrow(Vec::new()),
        }
    }
}

/// A full Verlet list: for each particle, everything within the list radius. The search is wider than that by a margin for
/// its roundings, and what lies in the margin may be listed for one of the two alone.
#[derive(Debug, Clone)]
pub struct NeighborList {
    cell: PeriodicBox,
    radius: f64,
    images: Images,
    lanes: usize,
    table: RowTable,
    chunks: Vec<ListChunk>,
}

impl NeighborList {
    /// An empty list for a box and a list radius r_list in σ, with entries padded to multiples of `lanes`.
    #[must_use]
    pub fn new(cell: PeriodicBox, radius: f64, images: Images, lanes: usize) -> Self {
        Self {
            cell,
            radius,
            images,
            lanes: lanes.max(1),
            table: RowTable::default(),
            chunks: Vec::new(),
        }
    }

    /// The sorted rows.
    #[must_use]
    pub fn table(&self) -> &RowTable {
        &self.table
    }

    /// The neighbors, chunk by chunk.
    #[must_use]
    pub fn chunks(&self) -> &[ListChunk] {
        &self.chunks
    }

    /// The list radius r_list, σ.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Entries are padded to multiples of this many.
    #[must_use]
    pub fn lanes(&self) -> usize {
        self.lanes
    }

    /// The largest number that an entry plus its base may have, plus one.
    #[must_use]
    pub fn targets(&self) -> usize {
        match self.images {
            Images::Ghosts => self.table.rows(),
            Images::Folded => self.table.particle.len(),
        }
    }

    /// The number that entries use for the particle at `place`.
    #[must_use]
    pub fn target_of(&self, place: usize) -> u32 {
        match self.images {
            Images::Ghosts => self.table.row[place],
            Images::Folded => place as u32,
        }
    }

    /// Builds the list for positions.
    ///
    /// The result is a pure function of the positions and of what was given to [`NeighborList::new`].
    ///
    /// # Errors
    /// [`GridError`] where a position cannot be placed.
    pub fn build(&mut self, given: Given<'_>, scanner: &dyn RowScanner) -> Result<(), GridError> {
        self.table.sort(&self.cell, given, self.radius)?;
        let margin = self.table.search_margin();
        let radius2 = (self.radius + margin).powi(2) as f32 * (1.0 + 4.0 * f32::EPSILON);
        let n = self.table.particle.len();
        self.chunks
            .resize_with(n.div_ceil(ATOMS_PER_CHUNK), ListChunk::default);
        let table = &self.table;
        let filler = Filler {
            table,
            radius2,
            images: self.images,
            lanes: self.lanes,
            scanner,
        };
        let chunks = self.chunks.iter_mut();
        for_each_item(chunks, |scratch: &mut Scratch, c, chunk| {
            let places = part(c, ATOMS_PER_CHUNK, n);
            filler.fill(places, scratch, chunk);
        });
        Ok(())
    }

    /// Number of pairs in the list, each counted once.
    #[must_use]
    pub fn pairs(&self) -> u64 {
        let entries: u64 = self
            .chunks
            .iter()
            .flat_map(|c| &c.counts)
            .map(|n| u64::from(*n))
            .sum();
        entries / 2
    }

    /// Number of entries with the padding that a force loop computes too.
    #[must_use]
    pub fn lanes_listed(&self) -> u64 {
        let padded = |count: &u32| u64::from(count.next_multiple_of(self.lanes as u32));
        self.chunks.iter().flat_map(|c| &c.counts).map(padded).sum()
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let chunks: usize = self
            .chunks
            .iter()
            .map(|c| c.entries.bytes() + 4 * c.counts.capacity() + size_of::<ListChunk>())
            .sum();
        chunks + self.table.bytes()
    }

    /// The particles listed for each particle, `[N]`, ascending: for tests and for observers, not for
    /// force loops.
    #[must_use]
    pub fn neighbors(&self) -> Vec<Vec<u32>> {
        let mut all = vec![Vec::new(); self.table.particle.len()];
        for chunk in &self.chunks {
            let mut start = 0;
            for (offset, count) in chunk.counts.iter().enumerate() {
                let count = *count as usize;
                let place = chunk.first_place as usize + offset;
                let neighbors = &mut all[self.table.particle[place] as usize];
                for entry in chunk.entries.offsets(start..start + count) {
                    let target = entry + chunk.base;
                    let place = match self.images {
                        Images::Ghosts => self.table.places()[target as usize],
                        Images::Folded => target,
                    };
                    neighbors.push(self.table.particle[place as usize]);
                }
                neighbors.sort_unstable();
                start += count.next_multiple_of(self.lanes);
            }
        }
        all
    }
}

/// What one thread needs while it fills chunks.
#[derive(Default)]
struct Scratch {
    runs: Vec<Range<u32>>,
    nearby: Nearby,
}

/// An entry of either width.
trait Offset: Copy + Default {
    fn of(name: u32) -> Self;
    fn near(
        scanner: &dyn RowScanner,
        nearby: &Nearby,
        center: Center,
        radius2: f32,
        found: &mut [Self],
    ) -> usize;
}

impl Offset for u16 {
    fn of(name: u32) -> Self {
        name as u16
    }
    fn near(
        scanner: &dyn RowScanner,
        nearby: &Nearby,
        center: Center,
        radius2: f32,
        found: &mut [u16],
    ) -> usize {
        scanner.near_narrow(nearby, center, radius2, found)
    }
}

impl Offset for u32 {
    fn of(name: u32) -> Self {
        name
    }
    fn near(
        scanner: &dyn RowScanner,
        nearby: &Nearby,
        center: Center,
        radius2: f32,
        found: &mut [u32],
    ) -> usize {
        scanner.near_wide(nearby, center, radius2, found)
    }
}

/// What all chunks have in common.
struct Filler<'a> {
    table: &'a RowTable,
    radius2: f32,
    images: Images,
    lanes: usize,
    scanner: &'a dyn RowScanner,
}

impl Filler<'_> {
    fn fill(&self, places: Range<usize>, scratch: &mut Scratch, chunk: &mut ListChunk) {
        chunk.first_place = places.start as u32;
        chunk.counts.clear();
        let targets = match self.images {
            Images::Ghosts => self.table.rows_near(&places),
            Images::Folded => 0..self.table.particle.len() as u32,
        };
        chunk.base = targets.start;
        let narrow = targets.end - targets.start <= u32::from(u16::MAX) + 1;
        let counts = &mut chunk.counts;
        let old = std::mem::replace(&mut chunk.entries, Entries::Wide(Vec::new()));
        chunk.entries = match (old, narrow) {
            (Entries::Narrow(entries), true) => {
                Entries::Narrow(self.write(places, chunk.base, scratch, counts, entries))
            }
            (Entries::Wide(entries), false) => {
                Entries::Wide(self.write(places, chunk.base, scratch, counts, entries))
            }
            (_, true) => {
                Entries::Narrow(self.write(places, chunk.base, scratch, counts, Vec::new()))
            }
            (_, false) => {
                Entries::Wide(self.write(places, chunk.base, scratch, counts, Vec::new()))
            }
        };
    }

    /// Writes the entries of `places` over those of an earlier build. What is left of that build stays
    /// behind them: clearing it would cost as much as a search.
    fn write<E: Offset>(
        &self,
        places: Range<usize>,
        base: u32,
        scratch: &mut Scratch,
        counts: &mut Vec<u32>,
        mut entries: Vec<E>,
    ) -> Vec<E> {
        let table = self.table;
        let names = match self.images {
            Images::Ghosts => Names::Rows { base },
            Images::Folded => Names::Places(table.padded_places()),
        };
        let Scratch { runs, nearby } = scratch;
        let mut written = 0;
        let mut first = places.start;
        while first < places.end {
            let end = table.group_end(first, places.end);
            table.runs_near(first, end - 1, runs);
            self.scanner.gather(&table.candidates, names, runs, nearby);
            for place in first..end {
                let row = table.row[place];
                let center = Center {
                    at: table.candidates.at(row as usize),
                    name: names.of(row),
                };
                let room = written + nearby.len + 2 * PADDING;
                if entries.len() < room {
                    entries.resize(room, E::default());
                }
                let found = &mut entries[written..];
                let count = E::near(self.scanner, nearby, center, self.radius2, found);
                let padded = count.next_multiple_of(self.lanes);
                found[count..padded].fill(E::of(center.name));
                counts.push(count as u32);
                written += padded;
            }
            first = end;
        }
        give_back(&mut entries);
        entries
    }
}
