//! Pairs of particles that are too close, through sparse bins.

use std::collections::HashMap;

use lennard_core::{DVec3, PeriodicBox, SpeciesTable};
use lennard_scene::Scene;

/// Two particles and their distance in σ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosePair {
    /// Index of the first, from 0.
    pub i: usize,
    /// Index of the second, from 0.
    pub j: usize,
    /// Their distance, nearest image, σ.
    pub distance: f64,
    /// σ_ab of the two, in σ.
    pub sigma: f64,
}

impl ClosePair {
    /// The distance in units of σ_ab.
    #[must_use]
    pub fn in_own_units(&self) -> f64 {
        self.distance / self.sigma
    }
}

/// The closest pair of particles of a scene nearer than `within`, in units of σ_ab of each pair; excluded pairs are left out.
#[must_use]
pub(crate) fn closest_pair(
    scene: &Scene,
    species: &SpeciesTable,
    cell: &PeriodicBox,
    positions: &[DVec3],
    within: f64,
) -> Option<ClosePair> {
    let exclusions = scene.molecules().exclusions();
    let n = species.n_species();
    let sigma: Vec<f64> = (0..n * n).map(|k| scene.species_pair(k / n, k % n).sigma).collect();
    let size = |i: usize, j: usize| {
        (!exclusions.exclude(i, j)).then(|| sigma[species.of(i) * n + species.of(j)])
    };
    closest(cell, positions, size, scene.largest_sigma(), within)
}

/// The closest pair nearer than `within`, or `None`: O(N) through bins. Distances are in units of the size of each pair, of which
/// `largest` is the largest. Pairs without a size are left out, and so are positions that are not finite.
pub(crate) fn closest(
    cell: &PeriodicBox,
    positions: &[DVec3],
    size: impl Fn(usize, usize) -> Option<f64>,
    largest: f64,
    within: f64,
) -> Option<ClosePair> {
    let mut bins = Bins::new(cell, within * largest);
    let mut best: Option<ClosePair> = None;
    for (j, r) in positions.iter().enumerate().filter(|(_, r)| r.is_finite()) {
        let nearest = bins.nearest(positions, *r, |i| size(i, j));
        let pair = nearest
            .and_then(|(i, distance)| Some(ClosePair { i, j, distance, sigma: size(i, j)? }));
        let limit = best.map_or(within, |best| best.in_own_units());
        best = pair.filter(|pair| pair.in_own_units() < limit).or(best);
        bins.insert(j as u32, *r);
    }
    best
}

/// Points sorted into bins no smaller than a given distance, sparse, so that a wide empty box costs nothing.
pub(crate) struct Bins<'a> {
    cell: &'a PeriodicBox,
    counts: [i32; 3],
    members: HashMap<[i32; 3], Vec<u32>>,
}

impl<'a> Bins<'a> {
    pub(crate) fn new(cell: &'a PeriodicBox, smallest: f64) -> Self {
        // 2²⁰ bins an axis are plenty, and keep the index in range for any box.
        let counts =
            (cell.lengths() / smallest).floor().clamp(DVec3::ONE, DVec3::splat(1_048_576.0));
        Self { cell, counts: counts.as_ivec3().to_array(), members: HashMap::new() }
    }

    fn bin_of(&self, r: DVec3) -> [i32; 3] {
        let fraction = self.cell.wrap(r) / self.cell.lengths();
        std::array::from_fn(|axis| {
            ((fraction[axis] * f64::from(self.counts[axis])) as i32).clamp(0, self.counts[axis] - 1)
        })
    }

    pub(crate) fn insert(&mut self, index: u32, r: DVec3) {
        self.members.entry(self.bin_of(r)).or_default().push(index);
    }

    /// The nearest of the points in the bins around `r`, among the points that have a size, in units of it; with its distance.
    pub(crate) fn nearest(
        &self,
        points: &[DVec3],
        r: DVec3,
        size: impl Fn(usize) -> Option<f64>,
    ) -> Option<(usize, f64)> {
        let home = self.bin_of(r);
        let mut best: Option<(usize, f64, f64)> = None;
        let around = |axis: usize| -> Vec<i32> {
            let count = self.counts[axis];
            let mut bins: Vec<i32> = (-1..=1).map(|d| (home[axis] + d).rem_euclid(count)).collect();
            bins.sort_unstable();
            bins.dedup();
            bins
        };
        let (xs, ys, zs) = (around(0), around(1), around(2));
        for &x in &xs {
            for &y in &ys {
                for &z in &zs {
                    for &k in self.members.get(&[x, y, z]).into_iter().flatten() {
                        let Some(size) = size(k as usize) else {
                            continue;
                        };
                        let d = self.cell.minimum_image(r - points[k as usize]).length();
                        if best.is_none_or(|b| d / size < b.2) {
                            best = Some((k as usize, d, d / size));
                        }
                    }
                }
            }
        }
        best.map(|(k, d, _)| (k, d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closest_pair_is_found_across_the_face_of_the_box() {
        let cell = PeriodicBox::new(DVec3::new(10.0, 1e6, 10.0)).unwrap();
        let points =
            [DVec3::new(0.1, 5.0, 5.0), DVec3::new(9.8, 5.0, 5.0), DVec3::new(5.0, 5.0, f64::NAN)];
        let found = |within| closest(&cell, &points, |_, _| Some(1.0), 1.0, within);
        let pair = found(0.5).unwrap();
        assert_eq!((pair.i, pair.j), (0, 1));
        assert!((pair.distance - 0.3).abs() < 1e-12);
        assert_eq!(found(0.2), None);
    }
}
