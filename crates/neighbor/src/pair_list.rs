//! What every neighbor list does, whether it has one list per particle or one per cluster, and the chunks that a rank keeps.

use std::ops::Range;

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::chunk_slots::ChunkSlots;
use crate::clusters::Reach;
use crate::scanner::Scanner;
use crate::sort::{Around, Cells, GridError, Positions};

/// A full neighbor list over sorted particles.
///
/// A build has three parts: [`order`](PairList::order) gives particles their slots, [`place`](PairList::place) takes their
/// coordinates, and [`fill`](PairList::fill) searches. Particles that no list names need no place.
pub trait PairList: Sync {
    /// Whether pairs can be inserted after the build.
    const INSERTS: bool = false;

    /// The rounding of distances in a box, σ, which the list radius must cover.
    fn rounding(_cell: &PeriodicBox, _r_cut: f64) -> f64 {
        0.0
    }
    /// The cells of the sort.
    fn cells(&self) -> Cells<'_>;
    /// The particle at each slot; no particle has two slots.
    fn particles(&self) -> &[u32];
    /// The index, in the order that was given to the build, of the position that belongs to each slot.
    fn source(&self) -> &[u32];
    /// The slot that each ghost repeats.
    fn slots_of_ghosts(&self) -> impl ExactSizeIterator<Item = u32>;
    /// Number of rows, ghosts included.
    fn rows(&self) -> usize {
        self.particles().len() + self.slots_of_ghosts().len()
    }
    /// The slots of each chunk, from the last order on.
    fn chunk_slots(&self) -> &ChunkSlots;

    /// Begins a build in a box: gives the particles their slots.
    ///
    /// # Errors
    /// [`GridError`] where a position is not a usable number.
    fn order(
        &mut self,
        cell: &PeriodicBox,
        reach: Reach,
        positions: Positions<'_>,
    ) -> Result<(), GridError>;
    /// Goes on with a build: places the particles at some runs of slots, where `at` has positions by slot, σ.
    fn place(&mut self, cell: &PeriodicBox, runs: &[Range<usize>], at: &[DVec3]);
    /// Marks the columns that the search of the lists that are kept looks into, but for the columns around their slots.
    ///
    /// The particles of these lists are placed.
    fn mark_near(&self, _: &dyn Scanner, _cell: &PeriodicBox, _reach: Reach, _: &mut Around) {}
    /// Ends a build: fills the lists. All particles that they may name are placed.
    fn fill(&mut self, scanner: &dyn Scanner, cell: &PeriodicBox, reach: Reach);
    /// Whether every entry numbers a row or a slot that exists, and the chunks cover all slots of the lists that are kept.
    ///
    /// The force loops rely on it: they read rows through entries without a test of their own.
    fn is_valid(&self) -> bool;

    /// Keeps the lists of these chunks alone, in this build and in all later ones.
    fn keep(&mut self, chunks: Range<usize>);
    /// Whether the list contains a pair of slots that was beyond the list radius at the build.
    fn contains(&self, _pair: [u32; 2]) -> bool {
        false
    }
    /// Inserts such a pair at each end that does not list it yet, where the list [`INSERTS`](PairList::INSERTS) pairs.
    ///
    /// The forces equal the forces of a list that had the pair from its build on, except for the order of the sums.
    fn insert(&mut self, _pair: [u32; 2]) {}

    /// Number of pairs in the list, each counted once; of the lists of one rank, half the number of their pairs.
    fn pairs(&self) -> u64;
    /// Number of lanes that a loop over all lists computes, padding included.
    fn lanes_computed(&self) -> u64;
    /// Number of bytes held.
    fn bytes(&self) -> usize;
    /// Bytes of the lists themselves, without the sorted particles.
    fn list_bytes(&self) -> usize;
    /// The particles listed for each particle, `[N]`, ascending: for tests and canonical forces, too slow for force loops.
    fn neighbors(&self) -> Vec<Vec<u32>>;
    /// Calls `name` with each slot that the lists of a chunk contain, as often as they do, by ghosts too: for checks.
    fn for_each_slot(&self, chunk: usize, name: &mut dyn FnMut(u32));
}

// The lists that a process keeps: all, or the lists of one rank.

/// The chunks whose lists are kept: all, or the chunks of one rank. All others stay empty.
#[derive(Debug, Clone, Default)]
pub(crate) struct OwnChunks(Option<Range<usize>>);

impl OwnChunks {
    /// The chunks `own` alone; the others are emptied.
    pub(crate) fn alone<C: Default>(own: Range<usize>, chunks: &mut [C]) -> Self {
        let all = chunks.iter_mut().enumerate();
        for (_, chunk) in all.filter(|(c, _)| !own.contains(c)) {
            *chunk = C::default();
        }
        Self(Some(own))
    }

    /// The kept ones of so many chunks.
    pub(crate) fn of(&self, chunks: usize) -> Range<usize> {
        self.0.clone().unwrap_or(0..chunks)
    }
}
