//! What lies around the slots of one rank: the columns that its search looks into, and the particles that its lists may name.
//!
//! ```text
//!   columns across x and y, where o has slots of the rank:
//!
//!      . n n n n .      n: a near column, within the list radius of some o
//!      n n o o n n
//!      n n o o n n      halo: the particles of near columns that are themselves within the radius of some o
//!      . n n n n .
//! ```
//!
//! Columns are taken whole along z. Halos are a little larger than the lists ask for, and no list has to be read for them.

use std::ops::Range;

use glam::DVec3;
use lennard_core::parallel::map_ranges;

use super::cells::Cells;
use super::cells::wrap_cell;

/// Another column as seen from a column.
#[derive(Debug, Clone, Copy)]
struct Offset {
    /// How many columns away it is along x and y.
    columns: [i64; 2],
    /// The square of the distance between the nearest points of both columns, σ².
    least2: f64,
    /// The square of the distance from the other column to the farthest point of this one, σ².
    most2: f64,
}

/// What a column has of the slots of a rank.
#[derive(Debug, Clone)]
struct Column {
    slots: Range<u32>,
    /// Whether a slot belongs to the rank.
    has_own: bool,
    /// Whether a slot belongs to another rank.
    has_others: bool,
    /// Whether the search of the rank looks into it.
    near: bool,
}

/// The surroundings of the slots of one rank in a sort.
#[derive(Debug)]
pub struct Around {
    /// Number of columns along x and y.
    count: [u32; 2],
    own: Range<u32>,
    /// Sides of the box, σ.
    lengths: DVec3,
    /// Sides of a column along x and y, σ.
    edges: [f64; 2],
    radius2: f64,
    /// The columns within the radius, the nearest ones first.
    offsets: Vec<Offset>,
    /// By x, then y.
    columns: Vec<Column>,
}

impl Around {
    /// The surroundings of some slots in a box, for lists of a radius, σ.
    #[must_use]
    pub fn new(cells: Cells<'_>, lengths: DVec3, r_list: f64, own: &Range<usize>) -> Self {
        let [nx, ny, nz] = cells.count();
        let edges = [lengths.x / f64::from(nx), lengths.y / f64::from(ny)];
        let radius = with_rounding(lengths, r_list);
        let mut around = Self {
            count: [nx, ny],
            own: own.start as u32..own.end as u32,
            lengths,
            edges,
            radius2: radius * radius,
            offsets: offsets_within(radius, edges, [nx, ny]),
            columns: Vec::new(),
        };
        let column = |[x, y]: [u32; 2]| {
            let slots = cells.slots(x, y, [0, nz - 1]);
            let [before, own, behind] = around.parts(&slots);
            Column {
                has_own: !own.is_empty(),
                has_others: !before.is_empty() || !behind.is_empty(),
                near: false,
                slots,
            }
        };
        around.columns = all_columns([nx, ny]).map(column).collect();
        for at in around.columns_where(|column| column.has_own) {
            for k in 0..around.offsets.len() {
                around.mark(around.beside(at, around.offsets[k]));
            }
        }
        around
    }

    /// Marks one more column that the search looks into.
    pub fn mark(&mut self, at: [u32; 2]) {
        let index = self.index(at);
        self.columns[index].near = true;
    }

    /// The slots of other ranks in all columns that the search looks into, in ascending runs.
    #[must_use]
    pub fn near(&self) -> Vec<Range<usize>> {
        let runs = self.near_parts().into_iter();
        runs.map(|(run, _)| run.start as usize..run.end as usize).collect()
    }

    /// The slots of other ranks that the lists may name, ascending; `position` gives the sorted positions at slots of
    /// [`Around::near`], σ.
    #[must_use]
    pub fn halo(&self, cells: Cells<'_>, position: impl Fn(usize) -> DVec3 + Sync) -> Vec<u32> {
        let near = self.near_parts();
        map_ranges(near.len(), |parts| {
            let mut halo = Vec::new();
            for (slots, at) in &near[parts] {
                let has_own = |offset: &&Offset| self.column(self.beside(*at, **offset)).has_own;
                let own: Vec<&Offset> = self.offsets.iter().filter(has_own).collect();
                if own.iter().any(|offset| offset.most2 <= self.radius2) {
                    halo.extend(slots.clone());
                } else {
                    let is_within = |slot: &u32| {
                        let slot = *slot as usize;
                        let across = cells.across(slot, position(slot), self.lengths);
                        self.is_within(across, *at, &own)
                    };
                    halo.extend(slots.clone().filter(is_within));
                }
            }
            halo
        })
        .concat()
    }

    /// Runs of slots of this rank that contain all whose lists may name slots of other ranks.
    #[must_use]
    pub fn outer(&self) -> Vec<Range<usize>> {
        let mut outer = self.columns_where(|column| column.has_own);
        outer.retain(|at| {
            let mut beside = self.offsets.iter().map(|offset| self.beside(*at, *offset));
            beside.any(|at| self.column(at).has_others)
        });
        let own = outer.into_iter().map(|at| {
            let [_, own, _] = self.parts(&self.column(at).slots);
            own.start as usize..own.end as usize
        });
        own.collect()
    }

    /// The runs of [`Around::near`], each with its column.
    fn near_parts(&self) -> Vec<(Range<u32>, [u32; 2])> {
        let near = self.columns_where(|column| column.near && column.has_others);
        let parts = near.into_iter().flat_map(|at| {
            let [before, _, behind] = self.parts(&self.column(at).slots);
            [(before, at), (behind, at)]
        });
        let mut parts: Vec<_> = parts.filter(|(run, _)| !run.is_empty()).collect();
        parts.sort_unstable_by_key(|(run, _)| run.start);
        parts
    }

    /// Whether a place in a column, in columns, is within the radius of one of these other columns.
    fn is_within(&self, at: [f64; 2], column: [u32; 2], others: &[&Offset]) -> bool {
        let inside = [0, 1].map(|axis| at[axis] - f64::from(column[axis]));
        others.iter().any(|offset| {
            let [x, y] = [0, 1].map(|axis| {
                let columns = offset.columns[axis];
                let gap = match columns {
                    0 => 0.0,
                    1.. => columns as f64 - inside[axis],
                    _ => inside[axis] - (columns + 1) as f64,
                };
                gap * self.edges[axis]
            });
            x * x + y * y <= self.radius2
        })
    }

    /// Of some slots, the ones before the slots of this rank, among them, and behind them.
    fn parts(&self, Range { start, end }: &Range<u32>) -> [Range<u32>; 3] {
        let [first, last] = [self.own.start, self.own.end].map(|slot| slot.clamp(*start, *end));
        [*start..first, first..last, last..*end]
    }

    /// The columns of some kind, by x, then y.
    fn columns_where(&self, is: impl Fn(&Column) -> bool) -> Vec<[u32; 2]> {
        let all = all_columns(self.count).zip(&self.columns);
        all.filter(|(_, column)| is(column)).map(|(at, _)| at).collect()
    }

    fn column(&self, at: [u32; 2]) -> &Column {
        &self.columns[self.index(at)]
    }

    fn index(&self, [x, y]: [u32; 2]) -> usize {
        x as usize * self.count[1] as usize + y as usize
    }

    /// The column of the box at an offset from a column.
    fn beside(&self, [x, y]: [u32; 2], offset: Offset) -> [u32; 2] {
        let [nx, ny] = self.count;
        let [dx, dy] = offset.columns;
        [wrap_cell(i64::from(x) + dx, nx), wrap_cell(i64::from(y) + dy, ny)]
    }
}

/// The columns across the box, by x, then y.
fn all_columns([nx, ny]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    (0..nx).flat_map(move |x| (0..ny).map(move |y| [x, y]))
}

/// A list radius with the margins that searches add for rounding to single precision, σ.
///
/// Coordinates have errors of the last place of the extent, a few box sides. Squared distances in the search by clusters have
/// errors of the last place of the square of twice a group and the radius.
fn with_rounding(lengths: DVec3, r_list: f64) -> f64 {
    let last_places = 16.0 * f64::from(f32::EPSILON);
    let side = lengths.max_element();
    let extent = r_list + 4.0 * side;
    r_list + last_places * (extent + extent * extent / r_list)
}

/// The columns of these sides within a radius of a column, the nearest ones first; farther than across the box there are none.
fn offsets_within(radius: f64, edges: [f64; 2], count: [u32; 2]) -> Vec<Offset> {
    let reach = [0, 1].map(|axis| (radius / edges[axis]).ceil().min(count[axis].into()) as i64);
    let mut offsets = Vec::new();
    for x in -reach[0]..=reach[0] {
        for y in -reach[1]..=reach[1] {
            let apart = |columns: [i64; 2]| {
                let [x, y] = [0, 1].map(|axis| columns[axis] as f64 * edges[axis]);
                x * x + y * y
            };
            let offset = Offset {
                columns: [x, y],
                least2: apart([x, y].map(|columns| (columns.abs() - 1).max(0))),
                most2: apart([x, y]),
            };
            if offset.least2 <= radius * radius {
                offsets.push(offset);
            }
        }
    }
    offsets.sort_by(|a, b| a.most2.total_cmp(&b.most2));
    offsets
}

#[cfg(test)]
mod tests {
    use lennard_core::PeriodicBox;

    use super::*;
    use crate::sort::{ColumnTable, Positions, RowTable};

    const LENGTHS: DVec3 = DVec3::new(17.0, 13.0, 9.0);
    const RADIUS: f64 = 2.3;

    fn positions() -> Vec<DVec3> {
        (0..1500)
            .map(|k| DVec3::new(0.819_17, 0.671_04, 0.549_73) * LENGTHS * f64::from(k))
            .collect()
    }

    /// Compares with distances across the columns between all pairs.
    fn compare(cells: Cells<'_>, at: impl Fn(usize) -> DVec3 + Sync) {
        let n = positions().len();
        for own in [0..n / 3, n / 3..2 * n / 3, 700..731, 1490..n, 0..n] {
            let around = Around::new(cells, LENGTHS, RADIUS, &own);
            let halo = around.halo(cells, &at);
            assert!(halo.is_sorted() && halo.iter().all(|slot| !own.contains(&(*slot as usize))));
            let near: Vec<usize> = around.near().into_iter().flatten().collect();
            assert!(halo.iter().all(|slot| near.contains(&(*slot as usize))));
            let outer: Vec<usize> = around.outer().into_iter().flatten().collect();
            let mut pairs = 0;
            for other in (0..n).filter(|slot| !own.contains(slot)) {
                let meets = own.clone().filter(|slot| {
                    let apart = (at(other) - at(*slot)) / LENGTHS;
                    let apart = (apart - apart.round()) * LENGTHS;
                    apart.truncate().length() <= RADIUS
                });
                let meets: Vec<usize> = meets.collect();
                pairs += meets.len();
                if !meets.is_empty() {
                    assert!(halo.contains(&(other as u32)), "slot {other}");
                    assert!(meets.iter().all(|slot| outer.contains(slot)));
                }
            }
            assert_eq!(pairs > 0, own.len() < n);
            assert_eq!(halo.is_empty(), own.len() == n);
        }
    }

    #[test]
    fn halos_have_all_that_lists_may_name_and_only_outer_slots_name_them() {
        let cell = PeriodicBox::new(LENGTHS).unwrap();
        let positions = positions();
        let mut rows = RowTable::default();
        rows.sort(&cell, Positions::ById(&positions), RADIUS).unwrap();
        compare(Cells::Rows(&rows), |slot| positions[rows.particle[slot] as usize]);
        let mut columns = ColumnTable::default();
        columns.sort(&cell, Positions::ById(&positions)).unwrap();
        compare(Cells::Columns(&columns), |slot| positions[columns.particle[slot] as usize]);
    }

    #[test]
    fn a_halo_ends_at_the_radius_inside_a_column() {
        let cell = PeriodicBox::new(LENGTHS).unwrap();
        let positions = positions();
        let mut rows = RowTable::default();
        rows.sort(&cell, Positions::ById(&positions), RADIUS).unwrap();
        // Whole layers of cells along x: the rank ends at a face.
        let [nx, ny, nz] = rows.count();
        let layer = |x: u32| {
            let first = rows.slots_between(x, 0, [0, nz - 1]).start as usize;
            first..rows.slots_between(x, ny - 1, [0, nz - 1]).end as usize
        };
        let own = layer(3).start..layer(5).end;
        let around = Around::new(Cells::Rows(&rows), LENGTHS, RADIUS, &own);
        let edge = LENGTHS.x / f64::from(nx);
        let faces = [3.0 * edge, 6.0 * edge];
        let within = (0..positions.len()).filter(|slot| {
            let x = positions[rows.particle[*slot] as usize].x.rem_euclid(LENGTHS.x);
            !own.contains(slot) && (faces[0] - RADIUS..faces[1] + RADIUS).contains(&x)
        });
        let within: Vec<u32> = within.map(|slot| slot as u32).collect();
        let halo = around.halo(Cells::Rows(&rows), |slot| positions[rows.particle[slot] as usize]);
        assert_eq!(halo, within);
    }
}
