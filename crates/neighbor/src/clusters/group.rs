//! The bounds of a group of particles, and the candidates around it.

use std::ops::Range;

use crate::sort::{ColumnTable, PADDING};

/// The bounding box of a group of particles, and the search radius around it.
#[derive(Debug, Clone, Copy)]
pub struct GroupBounds {
    /// The middle of the bounding box, in fixed point.
    pub middle: [i32; 3],
    /// Distance from the middle to the faces along each axis, σ, rounded up.
    pub half: [f32; 3],
    /// Length of a fixed-point unit along each axis, σ.
    pub scale: [f32; 3],
    /// Sides of the periodic box, σ, where distances from the middle must be folded; otherwise none.
    pub folds: Option<[f32; 3]>,
    /// The square of the search radius, σ², with a margin for all rounding.
    pub radius2: f32,
}

impl GroupBounds {
    /// A point in fixed point relative to the middle, σ.
    #[inline(always)]
    #[must_use]
    pub fn relative(&self, at: [i32; 3]) -> [f32; 3] {
        let axis = |axis: usize| at[axis].wrapping_sub(self.middle[axis]) as f32 * self.scale[axis];
        [axis(0), axis(1), axis(2)]
    }

    /// The search sphere around a point o relative to the middle, as t = 2·o and the limit R² − |o|².
    ///
    /// A candidate c lies in it where |c|² − t·c is at most the limit. This holds where nothing is folded.
    #[inline(always)]
    #[must_use]
    pub fn sphere(&self, [x, y, z]: [f32; 3]) -> ([f32; 3], f32) {
        let limit = self.radius2 - (x * x + y * y + z * z);
        ([2.0 * x, 2.0 * y, 2.0 * z], limit)
    }
}

/// The candidates around a group, side by side in memory.
#[derive(Debug, Default, Clone)]
pub struct GroupCandidates {
    /// Coordinates along each axis relative to the middle of the group, σ.
    pub at: [Vec<f32>; 3],
    /// Square of the distance from the middle of the group, σ².
    pub square: Vec<f32>,
    /// Slot of each candidate.
    pub slot: Vec<u32>,
    /// Count of candidates; elements behind them have no meaning.
    pub len: usize,
}

impl GroupCandidates {
    /// Makes room for the slots of `runs` and two registers more, and checks that the runs contain slots only. Coordinates
    /// of the table have a register of padding.
    ///
    /// # Panics
    /// Where a run contains something else than slots: that is a bug of the caller.
    pub fn make_room(&mut self, table: &ColumnTable, runs: &[Range<u32>]) {
        let slots = table.particle.len();
        let mut total = 2 * PADDING;
        for run in runs {
            assert!(run.start <= run.end && run.end as usize <= slots);
            total += (run.end - run.start) as usize;
        }
        if self.slot.len() < total {
            for axis in &mut self.at {
                axis.resize(total, 0.0);
            }
            self.square.resize(total, 0.0);
            self.slot.resize(total, 0);
        }
    }
}
