//! The innermost loops of the search for shared lists: what is near to a group, and to each of its fours.

use std::ops::Range;

use crate::blocks::REACH;
use crate::columns::ColumnTable;
use crate::scan::PADDING;

/// Particles that share a list: those at consecutive places.
pub const SHARERS: usize = 4;

/// 1.5·2²³: added to a number below 2²² and taken off again, it leaves the nearest whole number.
const ROUNDING: f32 = 12_582_912.0;

/// The box around a group of particles, and what is near to it.
#[derive(Debug, Clone, Copy)]
pub struct Around {
    /// The middle of the box, in fixed point.
    pub middle: [i32; 3],
    /// From the middle to the faces along each axis, σ, rounded up.
    pub half: [f32; 3],
    /// Length of a unit along each axis, σ.
    pub scale: [f32; 3],
    /// Sides of the periodic box, σ, where distances from the middle must be folded; otherwise none.
    pub folds: Option<[f32; 3]>,
    /// What is near, σ², with a margin for all rounding.
    pub radius2: f32,
}

impl Around {
    /// Coordinates in fixed point as seen from the middle, σ.
    #[inline(always)]
    #[must_use]
    pub fn relative(&self, at: [i32; 3]) -> [f32; 3] {
        let axis = |axis: usize| at[axis].wrapping_sub(self.middle[axis]) as f32 * self.scale[axis];
        [axis(0), axis(1), axis(2)]
    }

    /// The sphere around a point o as seen from the middle: c lies in it where |c|² − t·c is at most the limit, with
    /// t = 2·o and the limit R² − |o|². Good where nothing is folded.
    #[inline(always)]
    #[must_use]
    pub fn sphere(&self, [x, y, z]: [f32; 3]) -> ([f32; 3], f32) {
        let limit = self.radius2 - (x * x + y * y + z * z);
        ([2.0 * x, 2.0 * y, 2.0 * z], limit)
    }
}

/// The surroundings of a group, side by side in memory.
#[derive(Debug, Default, Clone)]
pub struct Gathered {
    /// Coordinates along each axis as seen from the middle of the group, σ.
    pub at: [Vec<f32>; 3],
    /// Square of the distance from the middle of the group, σ².
    pub square: Vec<f32>,
    /// Place of each.
    pub place: Vec<u32>,
    /// How many there are; what lies beyond them means nothing.
    pub len: usize,
}

impl Gathered {
    /// Makes room for the places of `runs` and two registers more, and checks that runs are places.
    ///
    /// # Panics
    /// Where a run is not one of places: that is a bug of the caller.
    pub fn make_room(&mut self, table: &ColumnTable, runs: &[Range<u32>]) {
        let places = table.particle.len();
        for axis in &table.at {
            assert!(axis.len() >= places + PADDING, "padded");
        }
        let mut total = 2 * PADDING;
        for run in runs {
            assert!(run.start <= run.end && run.end as usize <= places);
            total += (run.end - run.start) as usize;
        }
        if self.place.len() < total {
            for axis in &mut self.at {
                axis.resize(total, 0.0);
            }
            self.square.resize(total, 0.0);
            self.place.resize(total, 0);
        }
    }

    /// Checks that a register beyond the last element can be read, and that `found` has room for a register more than
    /// may be found.
    ///
    /// # Panics
    /// Where that is not so: that is a bug of the caller.
    pub fn check(&self, found: &Found) {
        for axis in &self.at {
            assert!(axis.len() >= self.len + PADDING);
        }
        assert!(self.square.len() >= self.len + PADDING);
        assert!(self.place.len() >= self.len + PADDING);
        for (places, len) in found.places.iter().zip(found.len) {
            assert!(places.len() >= len + self.len + PADDING);
        }
    }
}

/// In [`Found`], what is near to one of the first two sharers and to one of the last two.
pub const FOR_ALL: usize = 0;
/// In [`Found`], what is near to one of the first two sharers and to none of the last two.
pub const FOR_FIRST_TWO: usize = 1;
/// In [`Found`], what is near to one of the last two sharers and to none of the first two.
pub const FOR_LAST_TWO: usize = 2;

/// What is near to the sharers of a list, by those whom it is near to.
#[derive(Debug, Default, Clone)]
pub struct Found {
    /// Places, by those whom they are for.
    pub places: [Vec<u32>; 3],
    /// How many there are of each; what lies beyond them means nothing.
    pub len: [usize; 3],
    /// Scratch of an ordering.
    far: Vec<u32>,
}

impl Found {
    /// Makes room for what was gathered, and begins with the sharers themselves.
    pub(crate) fn begin(&mut self, sharers: Range<u32>, gathered: &Gathered) {
        let room = SHARERS + gathered.len + PADDING;
        for places in &mut self.places {
            if places.len() < room {
                places.resize(room, 0);
            }
        }
        self.len = [sharers.len(), 0, 0];
        for (place, sharer) in self.places[FOR_ALL].iter_mut().zip(sharers) {
            *place = sharer;
        }
    }

    /// What is for some of the sharers.
    pub(crate) fn of(&self, whom: usize) -> &[u32] {
        &self.places[whom][..self.len[whom]]
    }

    /// The next of what is for some of the sharers, from an element on, and how many of these count.
    pub(crate) fn chunk<const N: usize>(&self, whom: usize, from: usize) -> (&[u32; N], usize) {
        const { assert!(N <= PADDING) };
        let next = self.places[whom][from..].first_chunk().expect("room");
        (next, (self.len[whom] - from).min(N))
    }

    /// Orders what is for all: first the sharers and what a block reaches from a base together with them, then the others,
    /// ascending. Gives how many come first, and the base.
    pub(crate) fn near_first(&mut self) -> (usize, u32) {
        let places = &mut self.places[FOR_ALL][..self.len[FOR_ALL]];
        let (low, high) = places
            .iter()
            .fold((u32::MAX, 0), |(low, high), p| (low.min(*p), high.max(*p)));
        if high.saturating_sub(low) <= REACH {
            return (places.len(), low);
        }
        let around_the_sharers = places[0].saturating_sub(REACH / 2);
        let base = around_the_sharers.min(high - REACH).max(low);
        self.far.clear();
        let mut near = 0;
        for at in 0..places.len() {
            let place = places[at];
            // Those below the base are beyond any reach.
            if place.wrapping_sub(base) <= REACH {
                places[near] = place;
                near += 1;
            } else {
                self.far.push(place);
            }
        }
        self.far.sort_unstable();
        places[near..].copy_from_slice(&self.far);
        (near, base)
    }

    /// Adds what is for two of the sharers, from an element on, to what is for all.
    pub(crate) fn give_to_all(&mut self, pair: usize, from: usize) {
        let [for_all, pairs @ ..] = &mut self.places;
        let rest = self.len[pair] - from;
        // By whole registers, for which there is room on both sides.
        for at in (0..rest).step_by(PADDING) {
            let some: &[u32; PADDING] = pairs[pair - 1][from + at..].first_chunk().expect("room");
            let to = self.len[FOR_ALL] + at;
            for_all[to..to + PADDING].copy_from_slice(some);
        }
        self.len[FOR_ALL] += rest;
    }
}

/// The innermost loops of the search, for an instruction set.
pub trait SharedScanner: Sync {
    /// Gathers the places of `runs` that lie within the radius of the box.
    fn gather(
        &self,
        table: &ColumnTable,
        around: &Around,
        runs: &[Range<u32>],
        gathered: &mut Gathered,
    );

    /// Adds to `found` the places within the radius of one of the sharers, which are at `own` as seen from the
    /// middle, without those of the sharers, which begin with `first`. `found` has room for [`PADDING`] more than were
    /// gathered.
    fn near(
        &self,
        gathered: &Gathered,
        around: &Around,
        own: [[f32; 3]; SHARERS],
        first: u32,
        found: &mut Found,
    );
}

/// The scanner that needs no particular instruction set.
#[derive(Debug, Clone, Copy, Default)]
pub struct ScalarSharedScanner;

impl SharedScanner for ScalarSharedScanner {
    fn gather(
        &self,
        table: &ColumnTable,
        around: &Around,
        runs: &[Range<u32>],
        gathered: &mut Gathered,
    ) {
        gathered.make_room(table, runs);
        let mut len = 0;
        for place in runs.iter().cloned().flatten() {
            let at = [0, 1, 2].map(|axis| table.at[axis][place as usize]);
            let at = around.relative(at);
            let mut gap2 = 0.0;
            for (at, half) in at.iter().zip(around.half) {
                let gap = (at.abs() - half).max(0.0);
                gap2 += gap * gap;
            }
            for (to, at) in gathered.at.iter_mut().zip(at) {
                to[len] = at;
            }
            gathered.square[len] = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
            gathered.place[len] = place;
            // Written always, counted only if near: no branch to mispredict.
            len += usize::from(gap2 <= around.radius2);
        }
        gathered.len = len;
    }

    fn near(
        &self,
        gathered: &Gathered,
        around: &Around,
        own: [[f32; 3]; SHARERS],
        first: u32,
        found: &mut Found,
    ) {
        let [x, y, z] = gathered.at.each_ref().map(|axis| &axis[..gathered.len]);
        let spheres = own.map(|own| around.sphere(own));
        for (k, place) in gathered.place[..gathered.len].iter().enumerate() {
            let mut is_near = [false; SHARERS];
            for ((is_near, own), (t, limit)) in is_near.iter_mut().zip(own).zip(spheres) {
                let Some(lengths) = around.folds else {
                    let squares = gathered.square[k] - t[0] * x[k] - t[1] * y[k] - t[2] * z[k];
                    *is_near = squares <= limit;
                    continue;
                };
                let mut r2 = 0.0;
                for (axis, at) in [x[k], y[k], z[k]].into_iter().enumerate() {
                    // The nearest whole number, without a call.
                    let d = at - own[axis];
                    let boxes = d * (1.0 / lengths[axis]) + ROUNDING;
                    let d = d - lengths[axis] * (boxes - ROUNDING);
                    r2 += d * d;
                }
                *is_near = r2 <= around.radius2;
            }
            let is_other = place.wrapping_sub(first) >= SHARERS as u32;
            let first_two = (is_near[0] | is_near[1]) & is_other;
            let last_two = (is_near[2] | is_near[3]) & is_other;
            let whom = [
                first_two & last_two,
                first_two & !last_two,
                last_two & !first_two,
            ];
            for ((places, len), is_for) in found.places.iter_mut().zip(&mut found.len).zip(whom) {
                places[*len] = *place;
                *len += usize::from(is_for);
            }
        }
    }
}
