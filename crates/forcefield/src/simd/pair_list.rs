//! The two kinds of lists, each with the rows that its loop reads.

use std::ops::Range;

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_neighbor::{
    Around, Cells, ClusterList, FIXED_UNITS, GridError, NeighborList, PackedDisplacement,
    Positions, Reach,
};

use super::by_level::by_level;
use super::cluster_loop::ClusterJob;
use super::disjoint::Disjoint;
use super::level::Level;
use super::motion::{Motion, MotionSummary, SomeRows};
use super::output::Output;
use super::pack::{By, pack_double, pack_fixed, pack_fixed_part};
use super::row::{DoubleRow, FixedRow};
use super::row_loop::RowJob;
use super::totals::{ChunkTotals, Detail};
use crate::interaction::Interaction;

/// Writes the rows of the slots from one on, and |d|² where given. No other thread may write the rows of these slots.
pub type PackPart<List> = unsafe fn(
    &List,
    Level,
    Motion<'_>,
    usize,
    Option<&mut [f64]>,
    &Disjoint<'_, <List as PairList>::Row>,
);

/// A list with its rows and its loop.
pub trait PairList: Sync {
    /// Coordinates as the loop reads them.
    type Row: Copy + Default + Send + Sync;
    /// The cells of the sort.
    type Cells: Cells;
    /// Whether pairs can be inserted after the build.
    const INSERTS: bool = false;

    /// How a chunk packs its rows of the next step while other chunks read the rows of this step.
    ///
    /// It is none where packing ahead does not pay. It needs a second array of rows.
    const PACK_AHEAD: Option<PackPart<Self>> = None;

    /// Lends the room of rows to a build, or takes it back, where a build can use it.
    fn swap_room(&mut self, _rows: &mut Vec<Self::Row>) {}

    /// The rounding of distances in a box, σ, which the list radius must cover.
    fn rounding(cell: &PeriodicBox, r_cut: f64) -> f64;

    /// The cells of the sort.
    fn cells(&self) -> &Self::Cells;
    /// The particle at each slot; no particle has two slots.
    fn particles(&self) -> &[u32];
    /// The index, in the order that was given to the build, of the position that belongs to each slot.
    fn source(&self) -> &[u32];
    /// Begins a build in a box: gives the particles their slots.
    fn order(
        &mut self,
        cell: &PeriodicBox,
        reach: Reach,
        positions: Positions<'_>,
    ) -> Result<(), GridError>;
    /// Goes on with a build: places the particles at some runs of slots, where `at` has positions by slot, σ.
    fn place(&mut self, cell: &PeriodicBox, runs: &[Range<usize>], at: &[DVec3]);
    /// Marks what the search for the lists which are kept looks into besides the columns around them. Their particles are placed.
    fn mark_near(&self, _level: Level, _cell: &PeriodicBox, _reach: Reach, _around: &mut Around) {}
    /// Ends a build: fills the lists. All particles that they may name are placed.
    fn fill(&mut self, level: Level, cell: &PeriodicBox, reach: Reach);
    /// Whether every entry numbers a row that exists: the loops rely on it.
    fn is_valid(&self) -> bool;
    /// Number of rows, ghosts included.
    fn rows(&self) -> usize;
    /// Number of chunks.
    fn chunks(&self) -> usize;
    /// Bytes of the lists themselves, without the sorted particles.
    fn list_bytes(&self) -> usize;
    /// Keeps the lists of these chunks alone, in this build and in all later ones.
    fn keep(&mut self, chunks: Range<usize>);
    /// Calls `name` with each slot that the lists of a chunk name, as often as they do.
    fn for_each_named(&self, chunk: usize, name: &mut dyn FnMut(u32));
    /// The slot that each ghost repeats.
    fn slots_of_ghosts(&self) -> impl ExactSizeIterator<Item = u32>;
    /// Writes rows of some slots and ghosts, and packed displacements where given; summarizes the motion of the slots.
    ///
    /// A ghost needs the row of its slot.
    fn pack(
        &self,
        level: Level,
        by: By,
        motion: Motion<'_>,
        which: SomeRows<'_>,
        rows: &mut [Self::Row],
        packed: Option<&mut [PackedDisplacement]>,
    ) -> MotionSummary;
    /// Whether the list contains a pair of slots that was beyond the list radius at the build.
    fn contains(&self, _pair: [u32; 2]) -> bool {
        false
    }
    /// Inserts such a pair, where the list [`INSERTS`](PairList::INSERTS) pairs.
    fn insert(&mut self, _pair: [u32; 2]) {}
    /// The loop over the list for an interaction, with a cutoff, σ, in a box.
    fn chunk_loop<'a, I: Interaction + 'a>(
        &'a self,
        interaction: I,
        r_cut: f64,
        cell: &PeriodicBox,
    ) -> Box<dyn ChunkLoop<Self::Row> + 'a>;
}

/// The loop over the chunks of a list, for one interaction.
///
/// What calls it is compiled once for all interactions.
pub trait ChunkLoop<Row>: Sync {
    /// Runs one chunk over rows.
    ///
    /// # Safety
    /// No other thread runs the same chunk with the same output at the same time.
    unsafe fn run(
        &self,
        level: Level,
        rows: &[Row],
        chunk: usize,
        detail: Detail,
        output: &Output<'_>,
    ) -> ChunkTotals;
}

impl<I: Interaction> ChunkLoop<DoubleRow> for RowJob<'_, I> {
    unsafe fn run(
        &self,
        level: Level,
        rows: &[DoubleRow],
        chunk: usize,
        detail: Detail,
        output: &Output<'_>,
    ) -> ChunkTotals {
        by_level!(level, run_double(self, rows, chunk, detail, output))
    }
}

impl<I: Interaction> ChunkLoop<FixedRow> for ClusterJob<'_, I> {
    unsafe fn run(
        &self,
        level: Level,
        rows: &[FixedRow],
        chunk: usize,
        detail: Detail,
        output: &Output<'_>,
    ) -> ChunkTotals {
        match level {
            // SAFETY: the level holds a token, which proves the instruction set.
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(isa) => unsafe {
                super::avx512::run_cluster(isa, self, rows, chunk, detail, output)
            },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(isa) => unsafe {
                super::avx2::run_cluster(isa, self, rows, chunk, detail, output)
            },
            _ => unreachable!("portable loops are in double precision"),
        }
    }
}

impl PairList for NeighborList {
    type Row = DoubleRow;
    type Cells = lennard_neighbor::RowTable;

    fn rounding(_cell: &PeriodicBox, _r_cut: f64) -> f64 {
        0.0
    }

    fn cells(&self) -> &Self::Cells {
        self.table()
    }

    fn particles(&self) -> &[u32] {
        &self.table().particle
    }

    fn source(&self) -> &[u32] {
        self.table().source()
    }

    fn order(
        &mut self,
        cell: &PeriodicBox,
        reach: Reach,
        positions: Positions<'_>,
    ) -> Result<(), GridError> {
        self.order(cell, reach.r_list, positions)
    }

    fn place(&mut self, cell: &PeriodicBox, runs: &[Range<usize>], at: &[DVec3]) {
        self.place(cell, runs, |slot| at[slot]);
    }

    fn fill(&mut self, level: Level, cell: &PeriodicBox, reach: Reach) {
        self.fill(cell, reach.r_list, level.row_scanner());
    }

    fn is_valid(&self) -> bool {
        self.is_valid()
    }

    fn rows(&self) -> usize {
        self.table().rows()
    }

    fn chunks(&self) -> usize {
        self.chunks().len()
    }

    fn list_bytes(&self) -> usize {
        self.bytes() - self.table().bytes()
    }

    fn pack(
        &self,
        level: Level,
        by: By,
        motion: Motion<'_>,
        which: SomeRows<'_>,
        rows: &mut [DoubleRow],
        packed: Option<&mut [PackedDisplacement]>,
    ) -> MotionSummary {
        pack_double(level, by, self.table(), (motion, which), rows, packed)
    }

    fn keep(&mut self, chunks: Range<usize>) {
        self.keep(chunks);
    }

    fn for_each_named(&self, chunk: usize, name: &mut dyn FnMut(u32)) {
        self.for_each_named(chunk, name);
    }

    fn chunk_loop<'a, I: Interaction + 'a>(
        &'a self,
        interaction: I,
        r_cut: f64,
        _cell: &PeriodicBox,
    ) -> Box<dyn ChunkLoop<DoubleRow> + 'a> {
        Box::new(RowJob::new(interaction, r_cut, self))
    }

    fn slots_of_ghosts(&self) -> impl ExactSizeIterator<Item = u32> {
        let slots = self.table().slots();
        let ghosts = self.table().ghosts.iter();
        ghosts.map(|ghost| slots[ghost.row as usize])
    }
}

impl PairList for ClusterList {
    const INSERTS: bool = true;
    const PACK_AHEAD: Option<PackPart<Self>> = Some(|list, level, motion, first, squares, rows| {
        // SAFETY: the contract is passed on.
        unsafe { pack_fixed_part(level, list.table(), motion, first, squares, rows) }
    });

    type Row = FixedRow;
    type Cells = lennard_neighbor::ColumnTable;

    /// Distances in fixed point are off by about one unit of the longest side, and singles by their last place.
    fn rounding(cell: &PeriodicBox, r_cut: f64) -> f64 {
        4.0 * cell.lengths().max_element() * f64::from(f32::EPSILON) / 256.0
            + 4.0 * r_cut * f64::from(f32::EPSILON)
    }

    fn swap_room(&mut self, rows: &mut Vec<FixedRow>) {
        self.swap_room(rows);
    }

    fn cells(&self) -> &Self::Cells {
        self.table()
    }

    fn particles(&self) -> &[u32] {
        &self.table().particle
    }

    fn source(&self) -> &[u32] {
        self.table().source()
    }

    fn order(
        &mut self,
        cell: &PeriodicBox,
        _reach: Reach,
        positions: Positions<'_>,
    ) -> Result<(), GridError> {
        self.order(cell, positions)
    }

    fn place(&mut self, cell: &PeriodicBox, runs: &[Range<usize>], at: &[DVec3]) {
        self.place(cell, runs, |slot| at[slot]);
    }

    fn mark_near(&self, level: Level, cell: &PeriodicBox, reach: Reach, around: &mut Around) {
        self.mark_near(cell, reach, level.cluster_scanner(), around);
    }

    fn fill(&mut self, level: Level, cell: &PeriodicBox, reach: Reach) {
        self.fill(cell, reach, level.cluster_scanner());
    }

    fn is_valid(&self) -> bool {
        self.is_valid()
    }

    fn rows(&self) -> usize {
        self.table().particle.len()
    }

    fn chunks(&self) -> usize {
        self.chunks().len()
    }

    fn list_bytes(&self) -> usize {
        self.bytes() - self.table().bytes()
    }

    fn pack(
        &self,
        level: Level,
        by: By,
        motion: Motion<'_>,
        which: SomeRows<'_>,
        rows: &mut [FixedRow],
        packed: Option<&mut [PackedDisplacement]>,
    ) -> MotionSummary {
        pack_fixed(level, by, self.table(), (motion, which), rows, packed)
    }

    fn keep(&mut self, chunks: Range<usize>) {
        self.keep(chunks);
    }

    fn for_each_named(&self, chunk: usize, name: &mut dyn FnMut(u32)) {
        self.for_each_named(chunk, name);
    }

    fn chunk_loop<'a, I: Interaction + 'a>(
        &'a self,
        interaction: I,
        r_cut: f64,
        cell: &PeriodicBox,
    ) -> Box<dyn ChunkLoop<FixedRow> + 'a> {
        let scale = (cell.lengths() / FIXED_UNITS).to_array();
        Box::new(ClusterJob::new(interaction, r_cut, scale, self))
    }

    fn slots_of_ghosts(&self) -> impl ExactSizeIterator<Item = u32> {
        std::iter::empty()
    }

    fn contains(&self, pair: [u32; 2]) -> bool {
        self.contains(pair)
    }

    fn insert(&mut self, pair: [u32; 2]) {
        self.insert(pair);
    }
}
