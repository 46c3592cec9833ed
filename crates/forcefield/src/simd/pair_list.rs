//! The two kinds of lists, each with the rows that its loop reads.

use glam::DVec3;
use lennard_neighbor::{Cells, FIXED_UNITS, Given, GridError, NeighborList, SharedList, Way};

use super::packing::{Motion, Moved};
use super::{
    By, ChunkTotals, DoubleRow, FixedRow, Level, Output, PairJob, Scatter, SharedJob, Wanted,
    pack_columns, pack_columns_part, pack_double,
};
use crate::truncation::PairForm;

/// Writes the rows of the places from one on, and |x − x⁰|² where there is room for them. No other thread may write the rows
/// of these places.
pub type PackPart<List> = unsafe fn(
    &List,
    Level,
    Motion<'_>,
    usize,
    Option<&mut [f64]>,
    &Scatter<'_, <List as PairList>::Row>,
);

/// A list with its rows and its loop.
pub trait PairList: Sync {
    /// Coordinates as the loop reads them.
    type Row: Copy + Default + Send + Sync;
    /// Where particles were sorted.
    type Cells: Cells;
    /// One evaluation.
    type Job<'a, F>: Sync
    where
        Self: 'a,
        F: PairForm;

    /// Whether it can name pairs after its build that it lacks.
    const TAKES_IN: bool = false;

    /// What chunks pack the rows of the next step with, if they do, while others still read those of this one: it takes as much
    /// room again.
    const PACK_AHEAD: Option<PackPart<Self>> = None;

    /// The cells of the sort.
    fn cells(&self) -> &Self::Cells;
    /// The particle at each place: each stands at one.
    fn particles(&self) -> &[u32];
    /// Which of the positions that the list was built from stands at each place.
    fn from(&self) -> &[u32];
    /// Builds the list.
    fn build(&mut self, level: Level, given: Given<'_>) -> Result<(), GridError>;
    /// Rows, ghosts included.
    fn rows(&self) -> usize;
    /// Chunks.
    fn chunks(&self) -> usize;
    /// Prepares an evaluation in a box of these sides.
    fn job<F: PairForm>(&self, form: F, r_cut: f64, lengths: DVec3) -> Self::Job<'_, F>;
    /// Writes all rows, and ways where they are wanted.
    fn pack(
        &self,
        level: Level,
        by: By,
        motion: Motion<'_>,
        rows: &mut [Self::Row],
        ways: Option<&mut [Way]>,
    ) -> Moved;
    /// Whether it names the pair of the particles at two places, which is one that counts: it may not, where it was farther
    /// apart than the list radius at the build.
    fn names(&self, _pair: [u32; 2]) -> bool {
        false
    }
    /// Names such a pair from now on, if it takes in any.
    fn name(&mut self, _pair: [u32; 2]) {}
    /// Runs one chunk.
    fn run<F: PairForm>(
        level: Level,
        job: &Self::Job<'_, F>,
        rows: &[Self::Row],
        chunk: usize,
        wanted: Wanted,
        output: &Output<'_>,
    ) -> ChunkTotals;
}

impl PairList for NeighborList {
    type Row = DoubleRow;
    type Cells = lennard_neighbor::RowTable;
    type Job<'a, F>
        = PairJob<'a, F>
    where
        F: PairForm;

    fn cells(&self) -> &Self::Cells {
        self.table()
    }

    fn particles(&self) -> &[u32] {
        &self.table().particle
    }

    fn from(&self) -> &[u32] {
        self.table().from()
    }

    fn build(&mut self, level: Level, given: Given<'_>) -> Result<(), GridError> {
        self.build(given, level.scanner())
    }

    fn rows(&self) -> usize {
        self.table().rows()
    }

    fn chunks(&self) -> usize {
        self.chunks().len()
    }

    fn job<F: PairForm>(&self, form: F, r_cut: f64, _lengths: DVec3) -> PairJob<'_, F> {
        PairJob::new(form, r_cut, self)
    }

    fn pack(
        &self,
        level: Level,
        by: By,
        motion: Motion<'_>,
        rows: &mut [DoubleRow],
        ways: Option<&mut [Way]>,
    ) -> Moved {
        pack_double(level, by, self.table(), motion, rows, ways)
    }

    fn run<F: PairForm>(
        level: Level,
        job: &PairJob<'_, F>,
        rows: &[DoubleRow],
        chunk: usize,
        wanted: Wanted,
        output: &Output<'_>,
    ) -> ChunkTotals {
        by_level!(level, run_double(job, rows, chunk, wanted, output))
    }
}

impl PairList for SharedList {
    const TAKES_IN: bool = true;
    const PACK_AHEAD: Option<PackPart<Self>> = Some(|list, level, motion, first, squares, rows| {
        // SAFETY: the contract is passed on.
        unsafe { pack_columns_part(level, list.table(), motion, first, squares, rows) }
    });

    type Row = FixedRow;
    type Cells = lennard_neighbor::ColumnTable;
    type Job<'a, F>
        = SharedJob<'a, F>
    where
        F: PairForm;

    fn cells(&self) -> &Self::Cells {
        self.table()
    }

    fn particles(&self) -> &[u32] {
        &self.table().particle
    }

    fn from(&self) -> &[u32] {
        self.table().from()
    }

    fn build(&mut self, level: Level, given: Given<'_>) -> Result<(), GridError> {
        self.build(given, level.shared_scanner())
    }

    fn rows(&self) -> usize {
        self.table().particle.len()
    }

    fn chunks(&self) -> usize {
        self.chunks().len()
    }

    fn job<F: PairForm>(&self, form: F, r_cut: f64, lengths: DVec3) -> SharedJob<'_, F> {
        SharedJob::new(form, r_cut, (lengths / FIXED_UNITS).to_array(), self)
    }

    fn pack(
        &self,
        level: Level,
        by: By,
        motion: Motion<'_>,
        rows: &mut [FixedRow],
        ways: Option<&mut [Way]>,
    ) -> Moved {
        pack_columns(level, by, self.table(), motion, rows, ways)
    }

    fn names(&self, pair: [u32; 2]) -> bool {
        self.names(pair)
    }

    fn name(&mut self, pair: [u32; 2]) {
        self.name(pair);
    }

    fn run<F: PairForm>(
        level: Level,
        job: &SharedJob<'_, F>,
        rows: &[FixedRow],
        chunk: usize,
        wanted: Wanted,
        output: &Output<'_>,
    ) -> ChunkTotals {
        by_level!(level, run_shared(job, rows, chunk, wanted, output))
    }
}
