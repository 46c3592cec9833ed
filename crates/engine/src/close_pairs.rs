//! Pairs of particles that are too close, through sparse bins.

use std::collections::HashMap;

use lennard_core::{DVec3, Exclusions, PeriodicBox, SpeciesTable};
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

/// σ_ab of pairs of particles.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes<'a> {
    species: Option<&'a SpeciesTable>,
    sigma: Vec<f64>,
    largest: f64,
}

impl<'a> Sizes<'a> {
    /// σ_ab = 1 for all.
    pub const ONE: Sizes<'static> = Sizes { species: None, sigma: Vec::new(), largest: 1.0 };

    /// Of the pairs of species of a scene.
    #[must_use]
    pub fn of(scene: &Scene, species: &'a SpeciesTable) -> Self {
        if scene.mixture.is_none() {
            return Self::ONE;
        }
        let n = species.n_species();
        let sigma = |k: usize| scene.species_pair(k / n, k % n).sigma;
        Self {
            species: Some(species),
            sigma: (0..n * n).map(sigma).collect(),
            largest: scene.largest_sigma(),
        }
    }

    /// σ_ab of two particles, in σ.
    #[must_use]
    pub fn between(&self, i: usize, j: usize) -> f64 {
        self.species
            .map_or(1.0, |species| self.sigma[species.of(i) * species.n_species() + species.of(j)])
    }
}

/// The closest pair nearer than `within`, or `None`: O(N) through bins of that size. Distances are in units of σ_ab of each pair.
///
/// Positions that are not finite are left out, and so are excluded pairs.
#[must_use]
pub fn closest_pair(
    cell: &PeriodicBox,
    positions: &[DVec3],
    exclusions: &Exclusions,
    sizes: &Sizes<'_>,
    within: f64,
) -> Option<ClosePair> {
    let mut bins = Bins::new(cell, within * sizes.largest);
    let mut best: Option<ClosePair> = None;
    for (j, r) in positions.iter().enumerate().filter(|(_, r)| r.is_finite()) {
        let size = |i| (!exclusions.exclude(i, j)).then(|| sizes.between(i, j));
        if let Some((i, distance)) = bins.nearest(positions, *r, size) {
            let pair = ClosePair { i, j, distance, sigma: sizes.between(i, j) };
            if pair.in_own_units() < best.map_or(within, |b| b.in_own_units()) {
                best = Some(pair);
            }
        }
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
        let closest = |within| closest_pair(&cell, &points, &Exclusions::NONE, &Sizes::ONE, within);
        let pair = closest(0.5).unwrap();
        assert_eq!((pair.i, pair.j), (0, 1));
        assert!((pair.distance - 0.3).abs() < 1e-12);
        assert_eq!(closest(0.2), None);
    }
}
