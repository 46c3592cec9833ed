//! Half lists of tiles: pairs of clusters, of which each meets the other once.

use std::ops::Range;

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_core::parallel::for_each_with;

use crate::clusters::{CLUSTER, ClusterRow, ClusterTable, FIXED_UNITS};
use crate::grid::GridError;
use crate::scan::PADDING;

/// Clusters a chunk at least: below it, what chunks share outweighs what they save.
const CLUSTERS_PER_CHUNK: usize = 54;
/// Chunks of a system of moderate size. Each has a copy of the forces on what its particles meet, and the
/// copies are added in order: more chunks serve more threads and cost every thread more.
const CHUNKS: usize = 8;
/// Clusters a chunk in large systems, where a chunk reaches little beyond itself.
const CLUSTERS_PER_LARGE_CHUNK: usize = 4000;
/// Chunks at most.
const MOST_CHUNKS: usize = 64;

/// How many chunks: a function of the number of clusters alone, since it is part of the definition of a sum.
fn chunks_of(clusters: usize) -> usize {
    let few = (clusters / CLUSTERS_PER_CHUNK).clamp(1, CHUNKS);
    few.max((clusters / CLUSTERS_PER_LARGE_CHUNK).min(MOST_CHUNKS))
}

/// The boxes around clusters, side by side in memory and padded by [`PADDING`].
#[derive(Debug, Clone, Default)]
pub struct Bounds {
    /// Middles along each axis, in units of L/2³².
    pub center: [Vec<i32>; 3],
    /// From the middles to the faces along each axis, σ, rounded up.
    pub half: [Vec<f32>; 3],
    /// Which clusters have particles in different columns of the sort.
    spans: Vec<bool>,
}

impl Bounds {
    fn resize(&mut self, clusters: usize) {
        for axis in 0..3 {
            self.center[axis].resize(clusters + PADDING, 0);
            self.half[axis].resize(clusters + PADDING, 0.0);
        }
        self.spans.resize(clusters, false);
    }

    fn set(&mut self, cluster: usize, row: &ClusterRow, spans: bool, scale: [f64; 3]) {
        for (axis, (at, scale)) in row.0.iter().zip(scale).enumerate() {
            let from_first = at.map(|x| i64::from(x.wrapping_sub(at[0])));
            let low = from_first.iter().min().copied().unwrap_or_default();
            let high = from_first.iter().max().copied().unwrap_or_default();
            let middle = (low + high) >> 1;
            self.center[axis][cluster] = at[0].wrapping_add(middle as i32);
            let half = (high - middle + 1) as f64 * scale;
            self.half[axis][cluster] = (half * (1.0 + 1e-6)) as f32;
        }
        self.spans[cluster] = spans;
    }

    fn bytes(&self) -> usize {
        let axes = self.center.iter().map(Vec::capacity).sum::<usize>();
        8 * axes + self.spans.capacity()
    }
}

/// The search around one cluster.
#[derive(Debug, Clone, Copy)]
pub struct TileSearch<'a> {
    /// All rows.
    pub rows: &'a [ClusterRow],
    /// The boxes around them.
    pub bounds: &'a Bounds,
    /// The cluster.
    pub own: u32,
    /// Length of a unit along each axis, σ.
    pub scale: [f32; 3],
    /// What is near, σ².
    pub radius2: f32,
}

impl TileSearch<'_> {
    /// Checks that runs are clusters, that bounds are padded, and that there is room for all that may be found.
    ///
    /// # Panics
    /// Where that is not so: that is a bug of the caller.
    pub fn check(&self, runs: &[Range<u32>], room: usize) {
        let clusters = self.rows.len();
        for axis in 0..3 {
            assert!(self.bounds.center[axis].len() >= clusters + PADDING);
            assert!(self.bounds.half[axis].len() >= clusters + PADDING);
        }
        assert!(runs.iter().all(|run| run.end as usize <= clusters));
        assert!(room >= Self::room(runs));
    }

    /// Room that `found` must have for some runs.
    #[must_use]
    pub fn room(runs: &[Range<u32>]) -> usize {
        runs.iter().map(|run| run.len()).sum::<usize>() + PADDING
    }
}

/// The tiles of some consecutive clusters.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TileChunk {
    /// The first cluster.
    pub first: u32,
    /// Where the tiles of each cluster begin in `partners`, and the end, `[clusters + 1]`.
    pub starts: Vec<u32>,
    /// How many tiles of each cluster, those that come first, hold pairs that must be left out.
    pub masked: Vec<u32>,
    /// The partners of one cluster after another, counted from `first` around the box: the cluster
    /// itself is the first partner of each.
    pub partners: Vec<u32>,
    /// How many clusters from `first` on are met.
    pub reach: u32,
}

/// Finds what is near to a cluster.
pub trait TileScanner: Sync {
    /// Writes to `found` the clusters of `runs` whose boxes come within the radius of that of the cluster,
    /// and returns how many they are; `found` has [`TileSearch::room`].
    fn candidates(&self, search: &TileSearch<'_>, runs: &[Range<u32>], found: &mut [u32]) -> usize;

    /// Keeps those of `candidates` of which some particle lies within the radius of some particle of the
    /// cluster, and returns how many they are.
    fn near(&self, search: &TileSearch<'_>, candidates: &mut [u32]) -> usize;
}

/// The scanner that needs no particular instruction set.
#[derive(Debug, Clone, Copy, Default)]
pub struct ScalarTileScanner;

impl TileScanner for ScalarTileScanner {
    fn candidates(&self, search: &TileSearch<'_>, runs: &[Range<u32>], found: &mut [u32]) -> usize {
        let Bounds { center, half, .. } = search.bounds;
        let own = search.own as usize;
        let mut count = 0;
        for partner in runs.iter().cloned().flatten() {
            let at = partner as usize;
            let mut gap2 = 0.0_f32;
            for axis in 0..3 {
                let apart = center[axis][own].wrapping_sub(center[axis][at]);
                let apart = apart.unsigned_abs() as f32 * search.scale[axis];
                let gap = (apart - (half[axis][own] + half[axis][at])).max(0.0);
                gap2 += gap * gap;
            }
            found[count] = partner;
            count += usize::from(gap2 <= search.radius2);
        }
        count
    }

    fn near(&self, search: &TileSearch<'_>, candidates: &mut [u32]) -> usize {
        let own = search.rows[search.own as usize].0;
        let mut count = 0;
        for k in 0..candidates.len() {
            let candidate = candidates[k];
            let other = search.rows[candidate as usize].0;
            let mut least = f32::INFINITY;
            for i in 0..CLUSTER {
                let mut r2 = [0.0_f32; CLUSTER];
                for ((own, other), scale) in own.iter().zip(&other).zip(search.scale) {
                    for (r2, other) in r2.iter_mut().zip(other) {
                        let d = own[i].wrapping_sub(*other) as f32 * scale;
                        *r2 += d * d;
                    }
                }
                least = r2.into_iter().fold(least, f32::min);
            }
            candidates[count] = candidate;
            count += usize::from(least <= search.radius2);
        }
        count
    }
}

/// A half list of tiles in fixed point: every pair of particles within the list radius, by the nearest
/// image, is in exactly one tile.
///
/// Cluster b is a partner of cluster a, and not the other way around, where it comes after it by less
/// than half of all clusters, counted around: so the partners of a chunk lie close behind it.
#[derive(Debug, Clone)]
pub struct TileList {
    cell: PeriodicBox,
    radius: f64,
    table: ClusterTable,
    rows: Vec<ClusterRow>,
    bounds: Bounds,
    chunks: Vec<TileChunk>,
}

impl TileList {
    /// An empty list for a box and a list radius r_list in σ, at most half the shortest side.
    #[must_use]
    pub fn new(cell: PeriodicBox, radius: f64) -> Self {
        Self {
            cell,
            radius,
            table: ClusterTable::default(),
            rows: Vec::new(),
            bounds: Bounds::default(),
            chunks: Vec::new(),
        }
    }

    /// The sorted particles.
    #[must_use]
    pub fn table(&self) -> &ClusterTable {
        &self.table
    }

    /// The tiles, chunk by chunk.
    #[must_use]
    pub fn chunks(&self) -> &[TileChunk] {
        &self.chunks
    }

    /// The list radius r_list, σ.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Number of tiles.
    #[must_use]
    pub fn tiles(&self) -> u64 {
        self.chunks.iter().map(|c| c.partners.len() as u64).sum()
    }

    /// Rows that a force loop must have: all clusters, and again as many of the first ones as chunks at
    /// the end meet.
    #[must_use]
    pub fn rows(&self) -> usize {
        let reach = self.chunks.iter().map(|c| (c.first + c.reach) as usize);
        reach.max().unwrap_or_default().max(self.table.clusters())
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let chunks = self.chunks.iter().map(|c| {
            4 * (c.starts.capacity() + c.masked.capacity() + c.partners.capacity())
                + size_of::<TileChunk>()
        });
        self.table.bytes()
            + self.rows.capacity() * size_of::<ClusterRow>()
            + self.bounds.bytes()
            + chunks.sum::<usize>()
    }

    /// Builds the list for `positions` (unwrapped, σ): a pure function of them.
    ///
    /// # Errors
    /// [`GridError`] where a position cannot be placed.
    pub fn build(
        &mut self,
        positions: &[DVec3],
        scanner: &dyn TileScanner,
    ) -> Result<(), GridError> {
        self.table.sort(&self.cell, positions)?;
        self.fill_rows(positions);
        let clusters = self.table.clusters();
        let chunks = chunks_of(clusters);
        self.chunks.resize_with(chunks, TileChunk::default);
        let search = Search::new(
            self.cell.lengths(),
            self.radius,
            &self.table,
            &self.rows,
            &self.bounds,
            scanner,
        );
        for_each_with(&mut self.chunks, |scratch: &mut Scratch, c, chunk| {
            let own = (c * clusters / chunks) as u32..((c + 1) * clusters / chunks) as u32;
            search.fill(own, scratch, chunk);
        });
        Ok(())
    }

    /// The rows and bounds of the build.
    fn fill_rows(&mut self, positions: &[DVec3]) {
        let (lengths, table) = (self.cell.lengths(), &self.table);
        let units = FIXED_UNITS / lengths;
        let scale = (lengths / FIXED_UNITS).to_array();
        let clusters = table.clusters();
        self.rows.resize(clusters, ClusterRow::default());
        self.bounds.resize(clusters);
        for (c, row) in self.rows.iter_mut().enumerate() {
            let position = |place: usize| positions[table.particle[place] as usize];
            *row = table.row(c, lengths, units, position);
            self.bounds.set(c, row, table.spans(row), scale);
        }
    }

    /// The particles listed for each particle, `[N]`, ascending: for tests and for observers, not for
    /// force loops. All particles of a partner are listed, near or not.
    #[must_use]
    pub fn neighbors(&self) -> Vec<Vec<u32>> {
        let particle = &self.table.particle;
        let n = particle.len();
        let mut all = vec![Vec::new(); n];
        let clusters = self.table.clusters();
        let places = |c: usize| c * CLUSTER..((c + 1) * CLUSTER).min(n);
        for chunk in &self.chunks {
            for (k, span) in chunk.starts.windows(2).enumerate() {
                let own = chunk.first as usize + k;
                for partner in &chunk.partners[span[0] as usize..span[1] as usize] {
                    let partner = (chunk.first + partner) as usize % clusters;
                    for i in places(own) {
                        for j in places(partner) {
                            if own != partner || i < j {
                                all[particle[i] as usize].push(particle[j]);
                                all[particle[j] as usize].push(particle[i]);
                            }
                        }
                    }
                }
            }
        }
        for neighbors in &mut all {
            neighbors.sort_unstable();
        }
        all
    }
}

/// No cluster.
const NONE: u32 = u32::MAX;

fn position_of(cluster: u32, found: &[u32]) -> Option<usize> {
    if cluster == NONE {
        return None;
    }
    found.iter().position(|p| *p == cluster)
}

/// What one thread needs while it fills chunks.
#[derive(Default)]
struct Scratch {
    runs: Vec<Range<u32>>,
    found: Vec<u32>,
}

/// What the search for partners has in common for all clusters.
struct Search<'a> {
    table: &'a ClusterTable,
    rows: &'a [ClusterRow],
    bounds: &'a Bounds,
    scanner: &'a dyn TileScanner,
    /// Length of a unit along each axis, σ.
    scale: [f64; 3],
    radius: f64,
    radius2: f32,
}

impl<'a> Search<'a> {
    fn new(
        lengths: DVec3,
        radius: f64,
        table: &'a ClusterTable,
        rows: &'a [ClusterRow],
        bounds: &'a Bounds,
        scanner: &'a dyn TileScanner,
    ) -> Self {
        // Differences are exact but for the rounding of each coordinate to a unit; numbers as large as half
        // the box, squares and sums of three in single precision err by a few last places.
        let longest = lengths.max_element();
        let radius = radius
            + 8.0 * f64::from(f32::EPSILON) * (radius + longest / 16.0)
            + 4.0 * longest / FIXED_UNITS;
        Self {
            table,
            rows,
            bounds,
            scanner,
            scale: (lengths / FIXED_UNITS).to_array(),
            radius,
            radius2: (radius * radius) as f32 * (1.0 + 4.0 * f32::EPSILON),
        }
    }

    fn fill(&self, own: Range<u32>, scratch: &mut Scratch, chunk: &mut TileChunk) {
        let clusters = self.rows.len() as u32;
        let partial = if self.table.in_last() < CLUSTER {
            clusters - 1
        } else {
            NONE
        };
        chunk.first = own.start;
        chunk.starts.clear();
        chunk.masked.clear();
        chunk.partners.clear();
        chunk.reach = 0;
        for c in own {
            let start = chunk.partners.len();
            chunk.starts.push(start as u32);
            let found = self.find(c, scratch);
            // From the chunk's first cluster on, around the box.
            let first = chunk.first;
            let counted = |partner: u32| {
                if partner < first {
                    partner + clusters - first
                } else {
                    partner - first
                }
            };
            chunk.partners.push(c - first);
            chunk.partners.extend(found.iter().map(|p| counted(*p)));
            let masked = if c == partial {
                1 + found.len()
            } else if let Some(k) = position_of(partial, found) {
                chunk.partners.swap(start + 1, start + 1 + k);
                2
            } else {
                1
            };
            chunk.masked.push(masked as u32);
        }
        chunk.starts.push(chunk.partners.len() as u32);
        chunk.reach = 1 + chunk.partners.iter().max().copied().unwrap_or_default();
    }

    /// The partners of a cluster, without itself.
    fn find<'s>(&self, own: u32, scratch: &'s mut Scratch) -> &'s [u32] {
        let Scratch { runs, found } = scratch;
        runs.clear();
        let several = self.runs(own, runs);
        let room = TileSearch::room(runs);
        if found.len() < room {
            found.resize(room, 0);
        }
        let search = TileSearch {
            rows: self.rows,
            bounds: self.bounds,
            own,
            scale: self.scale.map(|s| s as f32),
            radius2: self.radius2,
        };
        let mut count = self.scanner.candidates(&search, runs, found);
        // A cluster that spans columns is met in each of them, and a long one in both runs of a column.
        let mut kept = 0;
        for k in 0..count {
            let candidate = found[k];
            let twice = several || self.bounds.spans[candidate as usize];
            if !(twice && found[..kept].contains(&candidate)) {
                found[kept] = candidate;
                kept += 1;
            }
        }
        count = self.scanner.near(&search, &mut found[..kept]);
        &found[..count]
    }

    /// The clusters that belong to the tiles of `own`, those that come after it by less than half of all,
    /// or by just half if it is in the first half: one stretch, or two around the end.
    fn belonging(&self, own: u32) -> [Range<u32>; 2] {
        let clusters = self.rows.len() as u32;
        let half = clusters / 2;
        let ahead = if clusters.is_multiple_of(2) && own >= half {
            half.saturating_sub(1)
        } else {
            half
        };
        let end = own + 1 + ahead;
        [own + 1..end.min(clusters), 0..end.saturating_sub(clusters)]
    }

    /// Writes to `runs` the clusters that belong to `own` in columns, and parts of them, that come within the
    /// radius of it; gives whether two runs are of one column.
    fn runs(&self, own: u32, runs: &mut Vec<Range<u32>>) -> bool {
        let at = own as usize;
        let bounds = self.bounds;
        let grid = &self.table.grid;
        let belonging = self.belonging(own);
        let middle = [0, 1].map(|a| f64::from(bounds.center[a][at] as u32) * self.scale[a]);
        let half = [0, 1, 2].map(|a| f64::from(bounds.half[a][at]));
        let [xs, ys] = [0, 1].map(|a| self.parts(middle[a], half[a], a));
        let radius2 = self.radius * self.radius;
        let mut several = false;
        for x in xs.first..=xs.last {
            let (x, gap_x) = xs.at(x);
            let left = radius2 - gap_x * gap_x;
            for y in ys.first..=ys.last {
                let (y, gap_y) = ys.at(y);
                let column = grid.column(x, y);
                let all = self.table.clusters_of_column(column);
                let some = |b: &Range<u32>| all.start < b.end && b.start < all.end;
                let left = left - gap_y * gap_y;
                if left < 0.0 || !(some(&belonging[0]) || some(&belonging[1])) {
                    continue;
                }
                let slices = self.slices(bounds.center[2][at], half[2] + left.sqrt());
                several |= slices[1].is_some();
                for slices in slices.into_iter().flatten() {
                    let run = self.table.clusters_of(column, slices);
                    for part in &belonging {
                        let run = run.start.max(part.start)..run.end.min(part.end);
                        if !run.is_empty() {
                            runs.push(run);
                        }
                    }
                }
            }
        }
        several
    }

    /// The columns along an axis that come within the radius of a box.
    #[inline(always)]
    fn parts(&self, middle: f64, half: f64, axis: usize) -> Parts {
        let count = self.table.grid.across[axis];
        let edge = FIXED_UNITS / f64::from(count) * self.scale[axis];
        let (low, high) = (middle - half, middle + half);
        let first = ((low - self.radius) / edge).floor() as i64;
        let last = ((high + self.radius) / edge).floor() as i64;
        let all = last - first + 1 >= i64::from(count);
        let (first, last) = if all {
            (0, i64::from(count) - 1)
        } else {
            (first, last)
        };
        Parts {
            first,
            last,
            count: i64::from(count),
            all,
            low,
            high,
            edge,
        }
    }

    /// The slices of a column within `reach` σ of a point along z, in one run or two.
    #[inline(always)]
    fn slices(&self, middle: i32, reach: f64) -> [Option<[u32; 2]>; 2] {
        let count = i64::from(self.table.grid.slices);
        let reach = (reach / self.scale[2]) as i64 + 2;
        let middle = i64::from(middle as u32);
        // Up to 2³⁴ times the number of slices, which is far below 2²⁹.
        let part = |z: i64| (z * count) >> 32;
        let (first, last) = (part(middle - reach), part(middle + reach));
        if last - first + 1 >= count {
            return [Some([0, count as u32 - 1]), None];
        }
        // The box is longer than the run, and the run begins or ends in it.
        let around = |slice: i64| {
            let slice = if slice < 0 { slice + count } else { slice };
            (if slice >= count { slice - count } else { slice }) as u32
        };
        let (a, b) = (around(first), around(last));
        if a <= b {
            [Some([a, b]), None]
        } else {
            [Some([a, count as u32 - 1]), Some([0, b])]
        }
    }
}

/// Consecutive columns along an axis, some of them around the end.
#[derive(Clone, Copy)]
struct Parts {
    first: i64,
    last: i64,
    /// Columns that there are.
    count: i64,
    /// Whether every column is meant, once.
    all: bool,
    low: f64,
    high: f64,
    edge: f64,
}

impl Parts {
    /// The column numbered `k`, counted on beyond the ends, and its distance from the box, σ.
    #[inline(always)]
    fn at(&self, k: i64) -> (u32, f64) {
        let part = if (0..self.count).contains(&k) {
            k
        } else {
            k.rem_euclid(self.count)
        };
        // Where all columns come near, each stands for several images: no distance is safe to claim.
        let gap = if self.all {
            0.0
        } else {
            let below = k as f64 * self.edge - self.high;
            let above = self.low - (k + 1) as f64 * self.edge;
            below.max(above).max(0.0)
        };
        // Places were found in fixed point: a last place of care.
        (part as u32, gap * (1.0 - 1e-9))
    }
}
