//! The parts of space that ranks own, and the columns that the table of one part has.
//!
//! ```text
//!   bundles across x and y, owned by four ranks; the plane of a cut is itself divided (a step), which is right to one bundle
//!
//!      0 0 0 2 2 2
//!      0 0 0 2 2 2      cuts follow the particles in each bundle, which all ranks know
//!      0 0 1 2 3 3      halo of rank 1: particles of other ranks within a radius of its columns
//!      1 1 1 3 3 3
//! ```
//!
//! Cuts never enter the physics: a list depends on the particles around its owner, wherever they came from.

use glam::DVec3;

/// The columns of a sort, and the bundles that they belong to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Number of columns along x and y.
    pub count: [u32; 2],
    /// The first column along y of each bundle, and the end. Along x a bundle is one column wide.
    pub ends: Vec<u32>,
    /// Sides of the box, σ.
    pub lengths: DVec3,
}

impl Columns {
    /// Number of bundles.
    #[must_use]
    pub fn bundles(&self) -> usize {
        self.count[0] as usize * (self.ends.len() - 1)
    }

    /// The bundle of a column.
    #[must_use]
    pub fn bundle(&self, [x, y]: [u32; 2]) -> usize {
        let across = self.ends.partition_point(|end| *end <= y) - 1;
        x as usize * (self.ends.len() - 1) + across
    }

    /// Whether the bundles are these, whatever the sides of the box.
    #[must_use]
    pub fn has_bundles_of(&self, other: &Self) -> bool {
        (self.count, &self.ends) == (other.count, &other.ends)
    }

    /// Sides of a column along x and y, σ.
    fn edges(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.lengths[axis] / f64::from(self.count[axis]))
    }

    /// The rank of each bundle: recursive bisection by the particles in each, along the longer side of what is left to cut.
    ///
    /// # Panics
    /// Where there are more ranks than bundles.
    #[must_use]
    pub fn cut(&self, weights: &[u64], ranks: usize) -> Vec<u32> {
        assert!(ranks <= weights.len(), "a bundle for each rank");
        let edges = self.edges();
        let across = self.ends.len() - 1;
        let at = |bundle: usize| [(bundle / across) as u32, self.ends[bundle % across]];
        let mut owners = vec![0; weights.len()];
        let mut left = vec![((0..weights.len()).collect::<Vec<usize>>(), 0, ranks)];
        while let Some((mut bundles, first, ranks)) = left.pop() {
            if ranks == 1 {
                bundles.iter().for_each(|bundle| owners[*bundle] = first as u32);
                continue;
            }
            let side = [0, 1].map(|axis| {
                let all = || bundles.iter().map(|bundle| at(*bundle)[axis]);
                let long = all().max().unwrap_or(0) - all().min().unwrap_or(0);
                f64::from(long) * edges[axis]
            });
            let along = usize::from(side[1] > side[0]);
            bundles.sort_unstable_by_key(|bundle| (at(*bundle)[along], at(*bundle)[1 - along]));
            let all: u64 = bundles.iter().map(|bundle| weights[*bundle]).sum();
            let half = ranks / 2;
            let wanted = all * half as u64 / ranks as u64;
            let mut sum = 0;
            let before = bundles.iter().map(|bundle| {
                sum += weights[*bundle];
                sum - weights[*bundle]
            });
            let before: Vec<u64> = before.collect();
            let allowed = half..=bundles.len() - (ranks - half);
            let at_half = allowed.min_by_key(|k| before[*k].abs_diff(wanted)).unwrap_or(half);
            let others = bundles.split_off(at_half);
            left.push((bundles, first, half));
            left.push((others, first + half, ranks - half));
        }
        owners
    }

    /// For each column that one rank owns, the columns of other ranks within a radius, σ; elsewhere nothing.
    #[must_use]
    pub fn beyond(&self, owners: &[u32], rank: usize, radius: f64) -> Beyond {
        let (edges, [nx, ny]) = (self.edges(), self.count);
        let reach = [0, 1].map(|k| (radius / edges[k]).ceil().min(self.count[k].into()) as i64);
        let mut others = vec![Vec::new(); nx as usize * ny as usize];
        for (x, y) in (0..nx).flat_map(|x| (0..ny).map(move |y| (x, y))) {
            if owners[self.bundle([x, y])] as usize != rank {
                continue;
            }
            let to = &mut others[(x * ny + y) as usize];
            for dx in -reach[0]..=reach[0] {
                for dy in -reach[1]..=reach[1] {
                    let gap = [(dx, edges[0]), (dy, edges[1])]
                        .map(|(k, edge)| (k.abs() - 1).max(0) as f64 * edge);
                    let beside = [(x, dx, nx), (y, dy, ny)].map(|(at, away, count)| {
                        (i64::from(at) + away).rem_euclid(count.into()) as u32
                    });
                    let owner = owners[self.bundle(beside)];
                    let least2 = gap[0] * gap[0] + gap[1] * gap[1];
                    if owner as usize != rank && least2 <= radius * radius {
                        to.push(Other { owner, away: [dx as f64, dy as f64], least2 });
                    }
                }
            }
        }
        Beyond { columns: self.clone(), edges, others }
    }
}

/// What lies beyond the columns of one rank.
#[derive(Debug, Default)]
pub struct Beyond {
    columns: Columns,
    edges: [f64; 2],
    /// For each column, by x, then y.
    others: Vec<Vec<Other>>,
}

/// A column of another rank, as seen from a column.
#[derive(Debug, Clone)]
struct Other {
    owner: u32,
    /// How many columns away it is along x and y.
    away: [f64; 2],
    /// The square of the distance between the nearest points of both columns, σ².
    least2: f64,
}

impl Beyond {
    /// Whether a column of another rank is within a radius of the column, σ, at most the radius that was asked for.
    #[must_use]
    pub fn is_outer(&self, [x, y]: [u32; 2], radius: f64) -> bool {
        let mut others = self.others[(x * self.columns.count[1] + y) as usize].iter();
        others.any(|other| other.least2 <= radius * radius)
    }

    /// Writes, for a place `r` σ in a column, each other rank with the square of the distance to its nearest column, σ².
    pub fn ranks_near(&self, column: [u32; 2], r: DVec3, near: &mut Vec<(u32, f64)>) {
        near.clear();
        let [x, y] = column;
        let others = &self.others[(x * self.columns.count[1] + y) as usize];
        if others.is_empty() {
            return;
        }
        let inside = [0, 1].map(|axis| {
            let length = self.columns.lengths[axis];
            let folded = r[axis] - (r[axis] / length).floor() * length;
            // The sort may have rounded to another column: the place then counts as its edge.
            (folded - f64::from(column[axis]) * self.edges[axis]).clamp(0.0, self.edges[axis])
        });
        for Other { owner: rank, away, .. } in others {
            let gap = [0, 1].map(|axis| {
                let (away, edge) = (away[axis], self.edges[axis]);
                if away > 0.0 {
                    away * edge - inside[axis]
                } else if away < 0.0 {
                    inside[axis] - (away + 1.0) * edge
                } else {
                    0.0
                }
            });
            let d2 = gap[0] * gap[0] + gap[1] * gap[1];
            match near.iter_mut().find(|(known, _)| known == rank) {
                Some((_, least)) => *least = least.min(d2),
                None => near.push((*rank, d2)),
            }
        }
    }
}

/// A radius with the margins that searches add for rounding to single precision, σ.
///
/// Coordinates have errors of the last place of the extent, a few box sides. Squared distances in the search by clusters have
/// errors of the last place of the square of twice a group and the radius.
#[must_use]
pub fn with_rounding(lengths: DVec3, radius: f64) -> f64 {
    let last_places = 16.0 * f64::from(f32::EPSILON);
    let extent = radius + 4.0 * lengths.max_element();
    radius + last_places * (extent + extent * extent / radius)
}

/// What a part has of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Belongs {
    /// The rank owns it.
    Own,
    /// Some particles of it are in the halo.
    Halo,
    /// Nothing.
    Nowhere,
}

/// The columns that a table has, in the order of its slots: all of them, or the columns of a part ahead of its halo.
#[derive(Debug, Clone, Default)]
pub(crate) struct Present {
    /// Number of particles of all ranks; `None` where the table has all particles.
    whole: Option<usize>,
    /// The place of each column among these, `[columns]`; empty where the table has all of them.
    place: Vec<u32>,
    /// The columns, in the order of their places.
    columns: Vec<u32>,
    /// The place of the first column of each bundle of the part, and the end.
    bundles: Vec<u32>,
}

/// No place.
const NOWHERE: u32 = u32::MAX;

impl Present {
    /// Begins a part of so many particles.
    pub fn begin(&mut self, whole: usize) {
        self.whole = Some(whole);
    }

    /// Takes the columns of a part. `first` has the first column of each bundle of the box, and the end.
    pub fn take(&mut self, belongs: &[Belongs], first: &[u32]) {
        let of = |wanted: Belongs| {
            (0..).zip(belongs).filter(move |(_, b)| **b == wanted).map(|(column, _)| column)
        };
        self.columns.clear();
        self.columns.extend(of(Belongs::Own));
        let own = self.columns.len() as u32;
        self.columns.extend(of(Belongs::Halo));
        self.place.clear();
        self.place.resize(belongs.len(), NOWHERE);
        for (place, column) in (0..).zip(&self.columns) {
            self.place[*column as usize] = place;
        }
        let owned = first.iter().filter_map(|column| self.place.get(*column as usize).copied());
        self.bundles.clear();
        self.bundles.extend(owned.filter(|place| *place < own).chain([own]));
    }

    /// Number of particles of the whole system, where the table has `n`.
    pub fn whole(&self, n: usize) -> usize {
        self.whole.unwrap_or(n)
    }

    /// The place of a column; `None` where the table does not have it.
    #[inline(always)]
    pub fn place(&self, column: u32) -> Option<u32> {
        if self.place.is_empty() {
            return Some(column);
        }
        let place = self.place[column as usize];
        (place != NOWHERE).then_some(place)
    }

    /// The column at a place.
    #[inline(always)]
    pub fn column(&self, place: usize) -> u32 {
        if self.place.is_empty() { place as u32 } else { self.columns[place] }
    }

    /// Number of columns, of so many of the box.
    pub fn count(&self, all: u32) -> u32 {
        if self.place.is_empty() { all } else { self.columns.len() as u32 }
    }

    /// The place of the first column of each bundle, and the end of the last one; `all` of the whole box.
    pub fn bundles(&self, all: impl FnOnce() -> Vec<u32>) -> Vec<u32> {
        if self.place.is_empty() { all() } else { self.bundles.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest part over the mean, where each bundle has as many particles as `density` says at its middle.
    fn imbalance(columns: &Columns, density: impl Fn([f64; 2]) -> f64, ranks: usize) -> f64 {
        let across = columns.ends.len() - 1;
        let weight = |bundle: usize| {
            let (x, k) = (bundle / across, bundle % across);
            let [y, end] = [columns.ends[k], columns.ends[k + 1]];
            let [nx, ny] = columns.count.map(f64::from);
            let at = [(x as f64 + 0.5) / nx - 0.5, 0.5 * f64::from(y + end) / ny - 0.5];
            (300.0 * density(at) * f64::from(end - y)) as u64
        };
        let weights: Vec<u64> = (0..columns.bundles()).map(weight).collect();
        let mut parts = vec![0; ranks];
        for (owner, weight) in columns.cut(&weights, ranks).into_iter().zip(&weights) {
            parts[owner as usize] += weight;
        }
        let most = parts.iter().max().unwrap();
        *most as f64 * ranks as f64 / weights.iter().sum::<u64>() as f64
    }

    #[test]
    fn parts_of_a_liquid_a_slab_and_a_droplet_have_nearly_as_many_particles() {
        let ends = (0..60).step_by(4).chain([60]).collect();
        let columns = Columns { count: [60, 60], ends, lengths: DVec3::splat(108.0) };
        let liquid = |_: [f64; 2]| 1.0;
        let slab = |[x, _]: [f64; 2]| if x.abs() < 0.2 { 1.0 } else { 0.01 };
        let droplet = |[x, y]: [f64; 2]| if x.hypot(y) < 0.3 { 1.0 } else { 0.01 };
        for ranks in [1, 2, 3, 4, 6, 9, 16] {
            // A part of the liquid, and of what is dense, has 16 bundles or more.
            assert!(imbalance(&columns, liquid, ranks) <= 1.05, "{ranks}");
            assert!(imbalance(&columns, slab, ranks) <= 1.10, "{ranks}");
            assert!(imbalance(&columns, droplet, ranks) <= 1.10, "{ranks}");
        }
    }

    #[test]
    fn a_rank_without_neighbors_sees_nothing_beyond_and_distances_are_to_the_nearest_column() {
        let columns =
            Columns { count: [6, 4], ends: vec![0, 2, 4], lengths: DVec3::new(12.0, 8.0, 5.0) };
        let owners: Vec<u32> = (0..columns.bundles()).map(|k| u32::from(k >= 6)).collect();
        let mut near = Vec::new();
        let alone = columns.beyond(&vec![0; owners.len()], 0, 3.0);
        alone.ranks_near([0, 0], DVec3::ZERO, &mut near);
        assert!(near.is_empty() && !alone.is_outer([0, 0], 3.0));
        let beyond = columns.beyond(&owners, 0, 3.0);
        // Columns 0 to 2 are owned; across the face of the box lies the other rank too.
        beyond.ranks_near([0, 0], DVec3::new(0.5, 1.0, 0.0), &mut near);
        assert_eq!(near, [(1, 0.25)]);
        beyond.ranks_near([2, 3], DVec3::new(5.25, 7.0, 0.0), &mut near);
        assert_eq!(near, [(1, 0.5625)]);
        assert!(beyond.is_outer([2, 3], 1.0) && !beyond.is_outer([1, 0], 1.0));
    }
}
