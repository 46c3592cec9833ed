//! The innermost loop of list building: which rows lie near a point.

use std::ops::Range;

/// Coordinates of all rows in single precision, for the search alone; the search radius carries a
/// margin for their rounding.
#[derive(Debug, Default, Clone)]
pub struct Candidates {
    /// x of each row, σ.
    pub x: Vec<f32>,
    /// y of each row, σ.
    pub y: Vec<f32>,
    /// z of each row, σ.
    pub z: Vec<f32>,
}

impl Candidates {
    /// Rows that may be read beyond the last one: scanners load whole registers.
    pub const PADDING: usize = 16;

    /// Makes room for `rows` rows and the padding.
    pub fn resize(&mut self, rows: usize) {
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.resize(rows + Self::PADDING, 0.0);
        }
    }

    /// Number of rows, without the padding.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.x.len().saturating_sub(Self::PADDING)
    }
}

/// The columns of cells around one particle.
#[derive(Debug, Default, Clone)]
pub struct Columns {
    /// The rows of each column, those of one x after another; ascending and disjoint.
    pub runs: Vec<Range<u32>>,
    /// Squared distance along x from the particle to the columns of each x, σ².
    pub gaps_x: Vec<f32>,
    /// Squared distance along y from the particle to the columns of each y, σ².
    pub gaps_y: Vec<f32>,
    /// Rows in all columns together.
    pub rows: usize,
}

impl Columns {
    /// Calls `visit` for each run whose column comes within the root of `radius2` of
    /// the particle, in ascending order.
    #[inline(always)]
    pub fn each_within(&self, radius2: f32, mut visit: impl FnMut(&Range<u32>)) {
        let width = self.gaps_y.len().max(1);
        for (gx, runs) in self.gaps_x.iter().zip(self.runs.chunks_exact(width)) {
            let left = radius2 - gx;
            for (gy, run) in self.gaps_y.iter().zip(runs) {
                if *gy <= left {
                    visit(run);
                }
            }
        }
    }
}

/// Finds rows near a point. One call handles one particle, so that implementations for an
/// instruction set cost one call and not one for each run of cells.
pub trait RowScanner: Sync {
    /// Writes to `found` the rows of `columns` whose distance to row `own` is at most the root of
    /// `radius2` σ², without `own` itself, and returns how many they are.
    ///
    /// `found` is at least as long as all runs together plus [`Candidates::PADDING`].
    fn scan(
        &self,
        candidates: &Candidates,
        own: u32,
        columns: &Columns,
        radius2: f32,
        found: &mut [u32],
    ) -> usize;
}

/// The scanner that needs no particular instruction set.
#[derive(Debug, Clone, Copy, Default)]
pub struct ScalarScanner;

impl RowScanner for ScalarScanner {
    fn scan(
        &self,
        candidates: &Candidates,
        own: u32,
        columns: &Columns,
        radius2: f32,
        found: &mut [u32],
    ) -> usize {
        let i = own as usize;
        let (x, y, z) = (candidates.x[i], candidates.y[i], candidates.z[i]);
        let mut count = 0;
        columns.each_within(radius2, |run| {
            let range = run.start as usize..run.end as usize;
            let rows = candidates.x[range.clone()]
                .iter()
                .zip(&candidates.y[range.clone()])
                .zip(&candidates.z[range]);
            for (row, ((xj, yj), zj)) in (run.start..).zip(rows) {
                let (dx, dy, dz) = (x - xj, y - yj, z - zj);
                // Written always, counted only if near: no branch to mispredict.
                found[count] = row;
                count += usize::from((dx * dx + dy * dy + dz * dz <= radius2) & (row != own));
            }
        });
        count
    }
}
