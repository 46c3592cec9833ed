//! The two kinds of lists, each with the rows that its loop reads.

use lennard_core::PeriodicBox;
use lennard_neighbor::{ClusterList, FIXED_UNITS, NeighborList, PackedDisplacement, PairList};

use super::by_level::by_level;
use super::cluster_loop::ClusterJob;
use super::disjoint::Disjoint;
use super::level::Level;
use super::motion::{Motion, MotionSummary, SomeRows};
use super::output::Output;
use super::pack::{Threads, pack_double, pack_fixed, pack_fixed_part};
use super::portable;
use super::row::{DoubleRow, FixedRow, Row};
use super::row_loop::RowJob;
use crate::interaction::Interaction;
use crate::sums::{Detail, Totals};

/// Writes the rows of the slots from one on, and |d|² where given. No other thread may write the rows of these slots.
pub type PackPart<List> = unsafe fn(
    &List,
    Level,
    Motion<'_>,
    usize,
    Option<&mut [f64]>,
    &Disjoint<'_, <List as PackedList>::Row>,
);

/// A list whose positions are packed into rows, with the loop over them.
pub trait PackedList: PairList + Send {
    /// Coordinates as the loop reads them.
    type Row: Row;

    /// How a chunk packs its rows of the next step while other chunks read the rows of this step.
    ///
    /// It is none where packing ahead does not pay. It needs a second array of rows.
    const PACK_AHEAD: Option<PackPart<Self>> = None;

    /// The row of a slot.
    fn row_of(&self, slot: usize) -> usize;
    /// Lends the room of rows to a build, or takes it back, where a build can use it.
    fn swap_room(&mut self, _rows: &mut Vec<Self::Row>) {}
    /// Writes rows of some slots and ghosts, and packed displacements where given; summarizes the motion of the slots.
    ///
    /// A ghost needs the row of its slot.
    fn pack(
        &self,
        level: Level,
        by: Threads,
        motion: Motion<'_>,
        which: SomeRows<'_>,
        rows: &mut [Self::Row],
        packed: Option<&mut [PackedDisplacement]>,
    ) -> MotionSummary;
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
    ) -> Totals;
}

impl<I: Interaction> ChunkLoop<DoubleRow> for RowJob<'_, I> {
    unsafe fn run(
        &self,
        level: Level,
        rows: &[DoubleRow],
        chunk: usize,
        detail: Detail,
        output: &Output<'_>,
    ) -> Totals {
        by_level!(
            level,
            run_double(self, rows, chunk, detail, output),
            portable::run_double(self, rows, chunk, detail, output)
        )
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
    ) -> Totals {
        by_level!(
            level,
            run_cluster(self, rows, chunk, detail, output),
            unreachable!("portable loops are in double precision")
        )
    }
}

impl PackedList for NeighborList {
    type Row = DoubleRow;

    fn row_of(&self, slot: usize) -> usize {
        self.table().row[slot] as usize
    }

    fn pack(
        &self,
        level: Level,
        by: Threads,
        motion: Motion<'_>,
        which: SomeRows<'_>,
        rows: &mut [DoubleRow],
        packed: Option<&mut [PackedDisplacement]>,
    ) -> MotionSummary {
        pack_double(level, by, self.table(), (motion, which), rows, packed)
    }

    fn chunk_loop<'a, I: Interaction + 'a>(
        &'a self,
        interaction: I,
        r_cut: f64,
        _cell: &PeriodicBox,
    ) -> Box<dyn ChunkLoop<DoubleRow> + 'a> {
        Box::new(RowJob::new(interaction, r_cut, self))
    }
}

impl PackedList for ClusterList {
    type Row = FixedRow;

    const PACK_AHEAD: Option<PackPart<Self>> = Some(|list, level, motion, first, squares, rows| {
        // SAFETY: the contract is passed on.
        unsafe { pack_fixed_part(level, list.table(), motion, first, squares, rows) }
    });

    fn row_of(&self, slot: usize) -> usize {
        slot
    }

    fn swap_room(&mut self, rows: &mut Vec<FixedRow>) {
        self.swap_room(rows);
    }

    fn pack(
        &self,
        level: Level,
        by: Threads,
        motion: Motion<'_>,
        which: SomeRows<'_>,
        rows: &mut [FixedRow],
        packed: Option<&mut [PackedDisplacement]>,
    ) -> MotionSummary {
        pack_fixed(level, by, self.table(), (motion, which), rows, packed)
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
}
