//! What every neighbor list does, whether it has one list per particle or one per cluster.

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::chunk_slots::ChunkSlots;
use crate::clusters::Reach;
use crate::scanner::Scanner;
use crate::sort::{Belongs, Cells, Columns, GridError, Positions};

/// A full neighbor list over sorted particles.
///
/// A build has three parts: [`order`](PairList::order) gives particles their slots, [`place`](PairList::place) takes their
/// coordinates, and [`fill`](PairList::fill) searches.
///
/// A list of a *part* has the lists of the particles in some columns of the box. These particles have the first slots, in
/// the order of the whole, and the particles around them (the *halo*) have slots behind. They have the lists that the whole has.
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
    /// Goes on with a build: places the particles, where `at` has positions by slot, σ.
    fn place(&mut self, cell: &PeriodicBox, at: &[DVec3]);
    /// Begins a build of a part of `whole` particles in a box; returns the columns of the box.
    fn begin_part(&mut self, cell: &PeriodicBox, reach: Reach, whole: usize) -> Columns;
    /// The column of a position in the box of [`begin_part`](PairList::begin_part).
    fn column_at(&self, cell: &PeriodicBox, r: DVec3) -> [u32; 2];
    /// Takes the columns of the part, and the number of each particle that [`order`](PairList::order) gets next, by slot.
    fn take_part(&mut self, belongs: &dyn Fn([u32; 2]) -> Belongs, numbers: &[u32]);
    /// Number of particles of the whole system.
    fn whole(&self) -> usize;
    /// Number of particles that have lists; their slots are the first ones.
    fn own(&self) -> usize {
        let chunks = self.chunk_slots();
        chunks.of(0..chunks.count()).end
    }
    /// Ends a build: fills the lists. All particles that they may name are placed.
    fn fill(&mut self, scanner: &dyn Scanner, cell: &PeriodicBox, reach: Reach);
    /// Whether every entry numbers a row or a slot that exists, and the chunks cover all slots that have lists.
    ///
    /// The force loops rely on it: they read rows through entries without a test of their own.
    fn is_valid(&self) -> bool;

    /// The cell of a slot in the box, and the number of its particle: slots of the whole have the order of these.
    /// Lists that insert no pairs have none.
    fn key(&self, _slot: u32) -> [u32; 2] {
        [0; 2]
    }
    /// Whether the list contains a pair of slots that was beyond the list radius at the build.
    fn contains(&self, _pair: [u32; 2]) -> bool {
        false
    }
    /// Inserts such a pair at each end that does not list it yet, where the list [`INSERTS`](PairList::INSERTS) pairs.
    ///
    /// The forces equal the forces of a list that had the pair from its build on, except for the order of the sums.
    fn insert(&mut self, _pair: [u32; 2]) {}

    /// Number of pairs in the list, each counted once; of a part, half the number of the pairs in its lists.
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
