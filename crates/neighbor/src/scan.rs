//! The innermost loops of list building: what lies around a few particles, and which of it is near each.

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

/// Elements that may be read or written beyond the last one: scanners move whole registers.
pub const PADDING: usize = 16;

impl Candidates {
    /// Makes room for `rows` rows and the padding.
    pub fn resize(&mut self, rows: usize) {
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.resize(rows + PADDING, 0.0);
        }
    }

    /// Coordinates of one row, σ.
    #[must_use]
    pub fn at(&self, row: usize) -> [f32; 3] {
        [self.x[row], self.y[row], self.z[row]]
    }

    /// Number of rows, without the padding.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.x.len().saturating_sub(PADDING)
    }
}

/// What list entries call a row.
#[derive(Debug, Clone, Copy)]
pub enum Names<'a> {
    /// The row's own number, less the base.
    Rows {
        /// What is taken off.
        base: u32,
    },
    /// The place that the row shows, `[rows]`.
    Places(&'a [u32]),
}

impl Names<'_> {
    /// The name of one row.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, row: u32) -> u32 {
        match self {
            Self::Rows { base } => row.wrapping_sub(*base),
            Self::Places(places) => places[row as usize],
        }
    }
}

/// The candidates around a few particles, side by side in memory.
#[derive(Debug, Default, Clone)]
pub struct Nearby {
    /// x of each, σ.
    pub x: Vec<f32>,
    /// y of each, σ.
    pub y: Vec<f32>,
    /// z of each, σ.
    pub z: Vec<f32>,
    /// Name of each.
    pub name: Vec<u32>,
    /// How many there are; a register beyond them nothing is near to anything.
    pub len: usize,
}

impl Nearby {
    /// Makes room for the rows of `runs` and two registers more, and checks that the runs are rows.
    ///
    /// # Panics
    /// Where a run is not one of rows: that is a bug of the caller.
    pub fn make_room(&mut self, candidates: &Candidates, names: &Names<'_>, runs: &[Range<u32>]) {
        let rows = candidates.rows();
        let mut total = 0;
        for run in runs {
            assert!(run.start <= run.end && run.end as usize <= rows);
            total += (run.end - run.start) as usize;
        }
        if let Names::Places(places) = names {
            assert!(places.len() >= rows + PADDING, "padded as candidates are");
        }
        if self.x.len() < total + 2 * PADDING {
            for axis in [&mut self.x, &mut self.y, &mut self.z] {
                axis.resize(total + 2 * PADDING, 0.0);
            }
            self.name.resize(total + 2 * PADDING, 0);
        }
    }

    /// Checks that `elements` of each kind can be read, and that there is room for all that may be found among `room`.
    ///
    /// # Panics
    /// Where that is not so: that is a bug of the caller.
    pub fn check(&self, elements: usize, room: usize) {
        for axis in [&self.x, &self.y, &self.z] {
            assert!(axis.len() >= elements);
        }
        assert!(self.name.len() >= elements);
        assert!(room >= self.len + PADDING);
    }

    /// Ends the gathering at `len` candidates: far beyond them lies a register of nothing.
    pub fn finish(&mut self, len: usize) {
        self.len = len;
        // Its distance to anything overflows to infinity, which no radius reaches.
        self.x[len..len + PADDING].fill(f32::MAX);
    }
}

/// The particle whose neighbors are wanted.
#[derive(Debug, Clone, Copy)]
pub struct Center {
    /// Coordinates in single precision, σ.
    pub at: [f32; 3],
    /// Its own name, which is left out.
    pub name: u32,
}

/// Gathers candidates and finds near ones among them. Calls are few and large, so that an
/// implementation for an instruction set costs a call for each particle and none for each cell.
pub trait RowScanner: Sync {
    /// Copies the rows of `runs`, one run after another, to `nearby`.
    fn gather(
        &self,
        candidates: &Candidates,
        names: Names<'_>,
        runs: &[Range<u32>],
        nearby: &mut Nearby,
    );

    /// Writes to `found` the names of the candidates whose distance to `center` is at most the root of
    /// `radius2` σ², without `center` itself, and returns how many they are; names fit into 16 bits.
    ///
    /// `found` is at least as long as the candidates and [`PADDING`] more.
    fn near_narrow(
        &self,
        nearby: &Nearby,
        center: Center,
        radius2: f32,
        found: &mut [u16],
    ) -> usize;

    /// As [`RowScanner::near_narrow`], with names of 32 bits.
    fn near_wide(&self, nearby: &Nearby, center: Center, radius2: f32, found: &mut [u32]) -> usize;
}

/// The scanner that needs no particular instruction set.
#[derive(Debug, Clone, Copy, Default)]
pub struct ScalarScanner;

impl ScalarScanner {
    fn near<T: Copy>(
        nearby: &Nearby,
        center: Center,
        radius2: f32,
        found: &mut [T],
        entry: impl Fn(u32) -> T,
    ) -> usize {
        let [x, y, z] = center.at;
        let mut count = 0;
        let candidates = nearby.x[..nearby.len]
            .iter()
            .zip(&nearby.y)
            .zip(&nearby.z)
            .zip(&nearby.name);
        for (((xj, yj), zj), name) in candidates {
            let (dx, dy, dz) = (x - xj, y - yj, z - zj);
            // Written always, counted only if near: no branch to mispredict.
            found[count] = entry(*name);
            let is_near = dx * dx + dy * dy + dz * dz <= radius2;
            count += usize::from(is_near & (*name != center.name));
        }
        count
    }
}

impl RowScanner for ScalarScanner {
    fn gather(
        &self,
        candidates: &Candidates,
        names: Names<'_>,
        runs: &[Range<u32>],
        nearby: &mut Nearby,
    ) {
        nearby.make_room(candidates, &names, runs);
        let mut len = 0;
        for run in runs {
            for row in run.clone() {
                nearby.x[len] = candidates.x[row as usize];
                nearby.y[len] = candidates.y[row as usize];
                nearby.z[len] = candidates.z[row as usize];
                nearby.name[len] = names.of(row);
                len += 1;
            }
        }
        nearby.finish(len);
    }

    fn near_narrow(
        &self,
        nearby: &Nearby,
        center: Center,
        radius2: f32,
        found: &mut [u16],
    ) -> usize {
        Self::near(nearby, center, radius2, found, |name| name as u16)
    }

    fn near_wide(&self, nearby: &Nearby, center: Center, radius2: f32, found: &mut [u32]) -> usize {
        Self::near(nearby, center, radius2, found, |name| name)
    }
}
