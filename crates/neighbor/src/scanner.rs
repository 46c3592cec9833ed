//! The innermost loops of the searches: gather the candidates of a group, then find the near ones of each particle or cluster.

use std::ops::Range;

use crate::clusters::{CLUSTER, ClusterNeighbors, GroupBounds, GroupCandidates};
use crate::rows::{Candidates, Center, Numbering};
use crate::sort::{ColumnTable, RowCoordinates};

/// 1.5·2²³: added to a number below 2²² and subtracted again, it leaves the nearest integer.
const ROUNDING: f32 = 12_582_912.0;

/// Where the numbers of near candidates go.
#[derive(Debug)]
pub enum Found<'a> {
    /// Numbers that fit into 16 bits.
    Narrow(&'a mut [u16]),
    /// Numbers of 32 bits.
    Wide(&'a mut [u32]),
}

/// Gathers candidates and finds the near ones, for one instruction set.
///
/// Calls are few and large: an implementation costs one dynamic call per particle or cluster, and none per cell.
pub trait Scanner: Sync {
    /// Copies the rows of `runs`, one run after another, to `candidates`.
    fn gather_rows(
        &self,
        coordinates: &RowCoordinates,
        numbering: Numbering<'_>,
        runs: &[Range<u32>],
        candidates: &mut Candidates,
    );

    /// Writes the numbers of the near candidates, without `center` itself, and returns their count.
    ///
    /// A candidate is near where its squared distance to `center` is at most `radius2` σ². `found` is at least as long as the
    /// candidates and [`PADDING`](crate::PADDING) more.
    fn near(
        &self,
        candidates: &Candidates,
        center: Center,
        radius2: f32,
        found: Found<'_>,
    ) -> usize;

    /// Gathers the slots of `runs` that lie within the search radius of the bounds.
    fn gather_slots(
        &self,
        table: &ColumnTable,
        bounds: &GroupBounds,
        runs: &[Range<u32>],
        candidates: &mut GroupCandidates,
    );

    /// Adds to `found` the candidates within the search radius of a member, without the members themselves.
    ///
    /// The members have the slots from `first` on, and `own` has their coordinates relative to the middle.
    /// `found` has room for all candidates and [`PADDING`](crate::PADDING) more.
    fn near_cluster(
        &self,
        candidates: &GroupCandidates,
        bounds: &GroupBounds,
        own: [[f32; 3]; CLUSTER],
        first: u32,
        found: &mut ClusterNeighbors,
    );
}

/// The scanner that needs no particular instruction set.
#[derive(Debug, Clone, Copy, Default)]
pub struct ScalarScanner;

fn near<T: Copy>(
    candidates: &Candidates,
    center: Center,
    radius2: f32,
    found: &mut [T],
    entry: impl Fn(u32) -> T,
) -> usize {
    let [x, y, z] = center.at;
    let mut count = 0;
    let candidates = candidates.x[..candidates.len]
        .iter()
        .zip(&candidates.y)
        .zip(&candidates.z)
        .zip(&candidates.number);
    for (((xj, yj), zj), number) in candidates {
        let (dx, dy, dz) = (x - xj, y - yj, z - zj);
        // Each number is written, and only near ones are counted: there is no branch to mispredict.
        found[count] = entry(*number);
        let is_near = dx * dx + dy * dy + dz * dz <= radius2;
        count += usize::from(is_near & (*number != center.number));
    }
    count
}

impl Scanner for ScalarScanner {
    fn gather_rows(
        &self,
        coordinates: &RowCoordinates,
        numbering: Numbering<'_>,
        runs: &[Range<u32>],
        candidates: &mut Candidates,
    ) {
        candidates.make_room(coordinates, &numbering, runs);
        let mut len = 0;
        for run in runs {
            for row in run.clone() {
                candidates.x[len] = coordinates.x[row as usize];
                candidates.y[len] = coordinates.y[row as usize];
                candidates.z[len] = coordinates.z[row as usize];
                candidates.number[len] = numbering.of(row);
                len += 1;
            }
        }
        candidates.finish(len);
    }

    fn near(
        &self,
        candidates: &Candidates,
        center: Center,
        radius2: f32,
        found: Found<'_>,
    ) -> usize {
        match found {
            Found::Narrow(found) => near(candidates, center, radius2, found, |n| n as u16),
            Found::Wide(found) => near(candidates, center, radius2, found, |n| n),
        }
    }

    fn gather_slots(
        &self,
        table: &ColumnTable,
        bounds: &GroupBounds,
        runs: &[Range<u32>],
        candidates: &mut GroupCandidates,
    ) {
        candidates.make_room(table, runs);
        let coordinates = table.at();
        let mut len = 0;
        for slot in runs.iter().cloned().flatten() {
            let at = [0, 1, 2].map(|axis| coordinates[axis][slot as usize]);
            let at = bounds.relative(at);
            let mut gap2 = 0.0;
            for (at, half) in at.iter().zip(bounds.half) {
                let gap = (at.abs() - half).max(0.0);
                gap2 += gap * gap;
            }
            for (to, at) in candidates.at.iter_mut().zip(at) {
                to[len] = at;
            }
            candidates.square[len] = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
            candidates.slot[len] = slot;
            // Each candidate is written, and only near ones are counted: there is no branch to mispredict.
            len += usize::from(gap2 <= bounds.radius2);
        }
        candidates.len = len;
    }

    fn near_cluster(
        &self,
        candidates: &GroupCandidates,
        bounds: &GroupBounds,
        own: [[f32; 3]; CLUSTER],
        first: u32,
        found: &mut ClusterNeighbors,
    ) {
        let [x, y, z] = candidates.at.each_ref().map(|axis| &axis[..candidates.len]);
        let spheres = own.map(|own| bounds.sphere(own));
        for (k, slot) in candidates.slot[..candidates.len].iter().enumerate() {
            let mut is_near = [false; CLUSTER];
            for ((is_near, own), (t, limit)) in is_near.iter_mut().zip(own).zip(spheres) {
                let Some(lengths) = bounds.folds else {
                    let squares = candidates.square[k] + t[0] * x[k] + t[1] * y[k] + t[2] * z[k];
                    *is_near = squares <= limit;
                    continue;
                };
                let mut r2 = 0.0;
                for (axis, at) in [x[k], y[k], z[k]].into_iter().enumerate() {
                    // The nearest integer is found without a call.
                    let d = at - own[axis];
                    let boxes = d * (1.0 / lengths[axis]) + ROUNDING;
                    let d = d - lengths[axis] * (boxes - ROUNDING);
                    r2 += d * d;
                }
                *is_near = r2 <= bounds.radius2;
            }
            let is_other = slot.wrapping_sub(first) >= CLUSTER as u32;
            let first_half = (is_near[0] | is_near[1]) & is_other;
            let second_half = (is_near[2] | is_near[3]) & is_other;
            let kinds =
                [first_half & second_half, first_half & !second_half, second_half & !first_half];
            for ((slots, len), is_of_kind) in found.slots.iter_mut().zip(&mut found.len).zip(kinds)
            {
                slots[*len] = *slot;
                *len += usize::from(is_of_kind);
            }
        }
    }
}
