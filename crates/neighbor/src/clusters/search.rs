//! The search that fills the chunks of a cluster list.

use std::ops::Range;

use lennard_core::{Exclusions, PeriodicBox};

use super::block::Block;
use super::chunk::ClusterChunk;
use super::format::{BLOCK_REACH, CLUSTER, Reach, cluster_center};
use super::found::{ClusterNeighbors, Excluded, GroupBounds, GroupCandidates};
use crate::chunk_slots::{ATOMS_PER_CHUNK, SMALLEST_CUT};
use crate::scanner::Scanner;
use crate::sort::{CellRange, ColumnGrid, ColumnTable, FIXED_UNITS, wrap_cell};
use crate::validity::{LARGE_SYSTEM, farthest_apart};

/// Particles per group: one gathering of candidates serves a group.
const GROUP: usize = 16;
const _: () = assert!(GROUP.is_multiple_of(CLUSTER) && ATOMS_PER_CHUNK.is_multiple_of(GROUP));
/// No slot is this one or follows it.
const NO_SLOT: u32 = u32::MAX - CLUSTER as u32 + 1;
/// Rounding of coordinates, distances and squares in single precision, in units in the last place of the largest.
///
/// Conversions, products and differences on three axes are each off by half a unit. The total is doubled for safety.
const LAST_PLACES: f64 = 8.0;
/// Largest distance along each axis between a member of a compact cluster and its center, σ.
///
/// Coordinates relative to the center are rounded to single precision, and only small ones give accurate differences.
const COMPACT: f64 = 3.0;

/// Buffers that one thread reuses while it fills chunks.
#[derive(Default)]
pub(super) struct Scratch {
    xs: Vec<AxisCell>,
    ys: Vec<AxisCell>,
    runs: Vec<Range<u32>>,
    /// Runs in columns that share no blocks with the group.
    far_runs: Vec<Range<u32>>,
    candidates: GroupCandidates,
    found: ClusterNeighbors,
    far: Vec<u32>,
    excluded: Excluded,
    /// The room of the blocks of one chunk.
    blocks: Vec<Block>,
}

/// The number of a column along an axis, and its distance from the bounds of a group.
struct AxisCell {
    number: u32,
    /// The square of the distance, σ².
    gap2: f64,
}

/// The search of one build; all groups share it.
pub(super) struct Search<'a> {
    table: &'a ColumnTable,
    /// Coordinates of each slot along each axis in fixed point.
    at: [&'a [i32]; 3],
    scanner: &'a dyn Scanner,
    /// Sides of the box, σ.
    lengths: [f64; 3],
    /// Length of a fixed-point unit along each axis, σ.
    scale: [f64; 3],
    /// The list radius with the rounding of fixed-point coordinates, σ.
    radius: f64,
    /// The largest distance at the build of two particles that come within the cutoff while the list is in use, σ.
    farthest: f64,
    /// Pairs that do not interact, and the slot of each particle where there are any.
    exclusions: (&'a Exclusions, &'a [u32]),
    /// Whether lists are built aside and move into room that fits.
    ///
    /// The lists of many particles are most of the memory. Elsewhere the move would take longer than the memory is worth.
    aside: bool,
}

impl<'a> Search<'a> {
    /// The search over a sorted table in a box.
    pub fn new(
        table: &'a ColumnTable,
        cell: &PeriodicBox,
        reach: Reach,
        scanner: &'a dyn Scanner,
        exclusions: (&'a Exclusions, &'a [u32]),
    ) -> Self {
        let lengths = cell.lengths();
        let rounding = 4.0 * lengths.max_element() / FIXED_UNITS;
        Self {
            table,
            at: table.at(),
            scanner,
            lengths: lengths.to_array(),
            scale: (lengths / FIXED_UNITS).to_array(),
            radius: reach.r_list + rounding,
            farthest: farthest_apart(reach, table.whole()) + rounding,
            exclusions,
            aside: table.whole() >= LARGE_SYSTEM,
        }
    }

    /// Writes the lists of the clusters at `slots` to a chunk without lists.
    pub fn fill(&self, slots: Range<usize>, scratch: &mut Scratch, chunk: &mut ClusterChunk) {
        (chunk.first_slot, chunk.end_slot) = (slots.start as u32, slots.end as u32);
        if self.aside {
            chunk.move_to(&mut scratch.blocks);
        }
        let room = chunk.blocks.capacity();
        for group in slots.clone().step_by(GROUP) {
            let group = group..(group + GROUP).min(slots.end);
            let bounds = self.bounds(group.clone());
            let near = self.find_runs(&bounds, group.start, scratch);
            let base = self.base(&near);
            let Scratch { runs, far_runs, candidates, found, far, excluded, .. } = scratch;
            self.scanner.gather_slots(self.table, &bounds, runs, candidates);
            for first in group.clone().step_by(CLUSTER) {
                let end = (first + CLUSTER).min(group.end);
                // A cluster of fewer particles repeats its last one.
                let members: [[i32; 3]; CLUSTER] =
                    std::array::from_fn(|k| self.at((first + k).min(end - 1)));
                let members_range = first as u32..end as u32;
                found.begin(members_range.clone(), candidates);
                let own = members.map(|at| bounds.relative(at));
                // The slots behind fewer members belong to others, which may be neighbors: no slot is left out at first.
                let is_whole = members_range.len() == CLUSTER;
                let left_out = if is_whole { first as u32 } else { NO_SLOT };
                self.scanner.near_cluster(candidates, &bounds, own, left_out, found);
                if !is_whole {
                    found.leave_out(&members_range);
                }
                far.clear();
                if !far_runs.is_empty() {
                    found.part(far_runs, far);
                }
                let excluded = self.exclude(members_range, found, excluded);
                if let Some(excluded) = excluded {
                    far.retain(|slot| !excluded.slots().contains(slot));
                }
                chunk.push((found, far), self.is_compact(&members), base, excluded);
            }
        }
        let last_is_compact = chunk.spans.last().is_some_and(|span| span.compact);
        let is_cut = self.table.whole() >= SMALLEST_CUT;
        chunk.sums_in_common = slots.len().is_multiple_of(CLUSTER) || is_cut && last_is_compact;
        chunk.finish();
        if self.aside {
            chunk.move_back(&mut scratch.blocks);
        } else if chunk.blocks.capacity() > room {
            // Room of before stays: the next build may have more particles in this chunk again.
            chunk.give_back();
        }
    }

    /// Finds the pairs of a cluster that do not interact and brings them forward, where there are any.
    #[inline]
    fn exclude<'e>(
        &self,
        members: Range<u32>,
        found: &mut ClusterNeighbors,
        excluded: &'e mut Excluded,
    ) -> Option<&'e Excluded> {
        let (exclusions, slot_of) = self.exclusions;
        if exclusions.are_none() {
            return None;
        }
        let count = members.len();
        excluded.find(exclusions, members, &self.table.particle, slot_of);
        found.bring_forward(count, excluded);
        Some(excluded)
    }

    /// Whether a loop may take all coordinates relative to the cluster center; see [`crate::Span::compact`].
    fn is_compact(&self, members: &[[i32; 3]; CLUSTER]) -> bool {
        let center = cluster_center(members[1], members[2]);
        (0..3).all(|axis| {
            let apart = |a: [i32; 3], b: [i32; 3]| {
                let units = a[axis].wrapping_sub(b[axis]).unsigned_abs();
                f64::from(units) * self.scale[axis]
            };
            let farthest = members.iter().map(|at| apart(*at, center)).fold(0.0, f64::max);
            // Every particle may move by a skin, and so may the center.
            // No neighbor may come to lie more than half a box from the center.
            // The second and third member may not either, since the center halves their distance.
            let reach = farthest.max(apart(members[1], members[2])) + self.farthest;
            farthest <= COMPACT && reach < 0.5 * self.lengths[axis]
        })
    }

    #[inline(always)]
    fn at(&self, slot: usize) -> [i32; 3] {
        let [x, y, z] = &self.at;
        [x[slot], y[slot], z[slot]]
    }

    /// The bounds of the particles at some slots.
    fn bounds(&self, slots: Range<usize>) -> GroupBounds {
        let first = self.at(slots.start);
        let mut low = [0_i32; 3];
        let mut high = [0_i32; 3];
        for slot in slots {
            let at = self.at(slot);
            for axis in 0..3 {
                let from_first = at[axis].wrapping_sub(first[axis]);
                low[axis] = low[axis].min(from_first);
                high[axis] = high[axis].max(from_first);
            }
        }
        let mut bounds = GroupBounds {
            middle: first,
            half: [0.0; 3],
            scale: self.scale.map(|s| s as f32),
            folds: None,
            radius2: 0.0,
        };
        let mut farthest = 0.0_f64;
        for axis in 0..3 {
            let (low, high) = (i64::from(low[axis]), i64::from(high[axis]));
            let middle = (low + high) >> 1;
            bounds.middle[axis] = first[axis].wrapping_add(middle as i32);
            let half = (high - middle + 1) as f64 * self.scale[axis] * (1.0 + 1e-6);
            bounds.half[axis] = half as f32;
            let reach = half + self.radius;
            // The factor is a safety margin: no near candidate may appear on the other side of the box.
            if reach * 1.001 >= 0.5 * self.lengths[axis] {
                bounds.folds = Some(self.lengths.map(|l| l as f32));
            }
            farthest = farthest.max(reach.min(self.lengths[axis]));
        }
        let last_places = LAST_PLACES * f64::from(f32::EPSILON);
        let radius = self.radius + last_places * (self.radius + farthest);
        // The search subtracts squared distances from the middle, |c|² and |o|². Both are at most (|c| + |o|)².
        let [x, y, z] = bounds.half.map(f64::from);
        let both = self.radius + 2.0 * (x * x + y * y + z * z).sqrt();
        let radius2 = radius * radius + last_places * both * both;
        bounds.radius2 = radius2 as f32 * (1.0 + 4.0 * f32::EPSILON);
        bounds
    }

    /// Finds the runs of slots within the search radius of the bounds: columns, or parts of them. Runs are disjoint.
    ///
    /// They follow each other as seen from the group, whose first slot is given. The ones that share blocks with the group come
    /// first, and the result contains their slots alone.
    fn find_runs(&self, bounds: &GroupBounds, first: usize, scratch: &mut Scratch) -> Range<u32> {
        let Scratch { xs, ys, runs, far_runs, .. } = scratch;
        let grid = &self.table.grid;
        let [nx, ny] = grid.across;
        let [x, y, _] = self.at(first);
        let own = grid.column(ColumnGrid::part(x, nx), ColumnGrid::part(y, ny));
        self.columns_near(bounds, 0, xs);
        self.columns_near(bounds, 1, ys);
        runs.clear();
        far_runs.clear();
        let radius2 = f64::from(bounds.radius2);
        let half = f64::from(bounds.half[2]);
        let units = 1.0 / self.scale[2];
        for x in &*xs {
            for y in &*ys {
                let left = radius2 - x.gap2 - y.gap2;
                if left < 0.0 {
                    continue;
                }
                let column = grid.column(x.number, y.number);
                let runs = if grid.share_blocks(own, column) { &mut *runs } else { &mut *far_runs };
                // Two units are added, since coordinates are rounded. No point is farther away than the box is long.
                let reach = ((half + left.sqrt()) * units).min(FIXED_UNITS) as i64 + 2;
                for slices in self.slices_near(bounds.middle[2], reach) {
                    let run = self.table.slots_of(column, slices);
                    if !run.is_empty() {
                        runs.push(run);
                    }
                }
            }
        }
        let low = runs.iter().map(|run| run.start).min().unwrap_or_default();
        let high = runs.iter().map(|run| run.end).max().unwrap_or_default();
        runs.extend_from_slice(far_runs);
        low..high
    }

    /// A base from which entries reach all of some slots, if there is one.
    fn base(&self, slots: &Range<u32>) -> Option<u32> {
        if self.table.grid.all_in_reach {
            return Some(0);
        }
        (slots.len() <= BLOCK_REACH as usize + 1).then_some(slots.start)
    }

    /// The columns along an axis that lie within the search radius of the bounds.
    fn columns_near(&self, bounds: &GroupBounds, axis: usize, columns: &mut Vec<AxisCell>) {
        columns.clear();
        let count = i64::from(self.table.grid.across[axis]);
        let edge = self.lengths[axis] / count as f64;
        let middle = f64::from(bounds.middle[axis] as u32) * self.scale[axis];
        let half = f64::from(bounds.half[axis]);
        let radius = f64::from(bounds.radius2).sqrt();
        let (low, high) = (middle - half, middle + half);
        let first = ((low - radius) / edge).floor();
        let last = ((high + radius) / edge).floor();
        if last - first + 1.0 >= count as f64 {
            // All columns are near, and each may stand for several images: no distance is safe to claim.
            let all = (0..count).map(|number| AxisCell { number: number as u32, gap2: 0.0 });
            columns.extend(all);
            return;
        }
        for k in first as i64..=last as i64 {
            let below = k as f64 * edge - high;
            let above = low - (k + 1) as f64 * edge;
            // The factor is a margin: the sort used coordinates in fixed point.
            let gap = below.max(above).max(0.0) * (1.0 - 1e-9);
            columns.push(AxisCell { number: wrap_cell(k, count as u32), gap2: gap * gap });
        }
    }

    /// The slices of a column within `reach` units of a point along z, in one run or two runs.
    #[inline(always)]
    fn slices_near(&self, middle: i32, reach: i64) -> impl Iterator<Item = [u32; 2]> {
        let slices = self.table.grid.slices;
        let middle = i64::from(middle as u32);
        // The product does not overflow: z is at most 2³⁴, and the number of slices is far below 2²⁹.
        let part = |z: i64| (z * i64::from(slices)) >> 32;
        let (first, last) = (part(middle - reach), part(middle + reach));
        CellRange { first, last }.runs(slices)
    }
}

#[cfg(test)]
mod tests;
