//! Counting pairs by distance.

mod slabs;

use lennard_core::{DVec3, Own, PeriodicBox, SpeciesTable};
use rayon::prelude::*;

pub(crate) use self::slabs::count_distances_of_all;

use crate::cells::{BATCH, Cells, Points, nearest};
use crate::species_pairs::SpeciesPair;

/// Particles whose pairs one task counts. Counts are whole numbers, so that no result depends on it.
const ROWS_A_TASK: usize = 64;

/// Counts the pairs (each once) whose minimum-image distance falls into each of `bins` equal bins of
/// [0, r_max). Positions may be unwrapped; `r_max` is at most half the shortest side.
#[must_use]
pub fn count_distances(
    positions: &[DVec3],
    cell: &PeriodicBox,
    r_max: f64,
    bins: usize,
) -> Vec<u64> {
    let histogram = Histogram::new(cell, r_max, bins);
    let numbered: Vec<(u32, DVec3)> = (0_u32..).zip(positions.iter().copied()).collect();
    let cells = Cells::new(&numbered, cell, r_max);
    if cells.len() == 1 {
        return histogram.all_pairs(cells.members(0));
    }
    histogram.pairs_in_cells(&cells)
}

/// The same counts for the pairs of each two species a ≤ b, row by row. They add up to `all`, the counts of all pairs, since the
/// same bits decide about each pair. Positions are of the particles `own`, and pairs of all ranks count.
#[must_use]
pub fn count_distances_by_species(
    species: &SpeciesTable,
    own: &Own,
    positions: &[DVec3],
    cell: &PeriodicBox,
    r_max: f64,
    all: &[u64],
) -> Vec<Vec<u64>> {
    let of = |wanted: &dyn Fn(usize) -> bool| {
        let places = positions.iter().enumerate();
        let chosen = places.filter(|(i, _)| wanted(species.of(*i)));
        let chosen: Vec<DVec3> = chosen.map(|(_, r)| *r).collect();
        count_distances_of_all(own, &chosen, cell, r_max, all.len())
    };
    let less = |mut whole: Vec<u64>, part: &[u64]| {
        whole.iter_mut().zip(part).for_each(|(n, m)| *n -= m);
        whole
    };
    let like: Vec<Vec<u64>> = (0..species.n_species()).map(|a| of(&|s| s == a)).collect();
    let together = |a: usize, b: usize| match species.n_species() {
        2 => all.to_vec(),
        _ => of(&|s| s == a || s == b),
    };
    SpeciesPair::all(species)
        .map(
            |SpeciesPair { a, b }| {
                if a == b {
                    like[a].clone()
                } else {
                    less(less(together(a, b), &like[a]), &like[b])
                }
            },
        )
        .collect()
}

/// The same counts over the pairs inside molecules of `sites` consecutive sites: the same bits decide about each pair.
#[must_use]
pub(crate) fn count_distances_inside(
    sites: usize,
    positions: &[DVec3],
    cell: &PeriodicBox,
    r_max: f64,
    bins: usize,
) -> Vec<u64> {
    let histogram = Histogram::new(cell, r_max, bins);
    let molecules = positions.len() / sites;
    histogram.over(molecules.div_ceil(ROWS_A_TASK), |task, counts| {
        for m in task * ROWS_A_TASK..((task + 1) * ROWS_A_TASK).min(molecules) {
            let sites = &positions[m * sites..(m + 1) * sites];
            let points: Points = sites.iter().map(|r| cell.wrap(*r)).collect();
            for i in 0..points.len() {
                histogram.count(counts, points.get(i), &points, i + 1);
            }
        }
    })
}

struct Histogram {
    sides: DVec3,
    r_max: f64,
    per_length: f64,
    bins: usize,
}

impl Histogram {
    fn new(cell: &PeriodicBox, r_max: f64, bins: usize) -> Self {
        Self { sides: cell.lengths(), r_max, per_length: bins as f64 / r_max, bins }
    }

    /// Counts the distances from one point to those from `first` on; what lies beyond r_max goes to a bin of
    /// its own behind the last.
    fn count(&self, counts: &mut [u64], from: DVec3, to: &Points, first: usize) {
        let mut bins = [0_u32; BATCH];
        let last = self.bins as f64 - 1.0;
        let beyond = self.bins as f64;
        let [x, y, z] = to.coordinates(first).map(|r| r.chunks(BATCH));
        // One loop from coordinates to bins: in two, counting takes three times as long.
        for ((x, y), z) in x.zip(y).zip(z) {
            for (((bin, x), y), z) in bins.iter_mut().zip(x).zip(y).zip(z) {
                let r = nearest(from, DVec3::new(*x, *y, *z), self.sides).length();
                // Just below r_max the product can round up to the number of bins.
                let place = (r * self.per_length).min(last);
                *bin = if r < self.r_max { place } else { beyond } as u32;
            }
            for bin in &bins[..x.len()] {
                counts[*bin as usize] += 1;
            }
        }
    }

    /// Adds up what the tasks count.
    fn over(&self, tasks: usize, count: impl Fn(usize, &mut [u64]) + Sync) -> Vec<u64> {
        let mut counts = (0..tasks)
            .into_par_iter()
            .fold(
                || vec![0_u64; self.bins + 1],
                |mut counts, task| {
                    count(task, &mut counts);
                    counts
                },
            )
            .reduce(
                || vec![0_u64; self.bins + 1],
                |mut a, b| {
                    a.iter_mut().zip(b).for_each(|(x, y)| *x += y);
                    a
                },
            );
        counts.truncate(self.bins);
        counts
    }

    fn all_pairs(&self, r: &Points) -> Vec<u64> {
        self.over(r.len().div_ceil(ROWS_A_TASK), |task, counts| {
            for i in task * ROWS_A_TASK..((task + 1) * ROWS_A_TASK).min(r.len()) {
                self.count(counts, r.get(i), r, i + 1);
            }
        })
    }

    /// Pairs within a cell and with half of the 26 cells around it.
    fn pairs_in_cells(&self, cells: &Cells) -> Vec<u64> {
        self.over(cells.len(), |c, counts| {
            let own = cells.members(c);
            for i in 0..own.len() {
                let from = own.get(i);
                self.count(counts, from, own, i + 1);
                for others in cells.forward(c) {
                    self.count(counts, from, others, 0);
                }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::random_positions;

    fn brute_force(r: &[DVec3], cell: &PeriodicBox, r_max: f64, bins: usize) -> Vec<u64> {
        let mut counts = vec![0; bins];
        for i in 0..r.len() {
            for j in 0..i {
                let distance = cell.minimum_image(r[i] - r[j]).length();
                if distance < r_max {
                    counts[(distance / r_max * bins as f64) as usize] += 1;
                }
            }
        }
        counts
    }

    #[test]
    fn pairs_inside_molecules_are_counted_among_all_pairs() {
        let cell = PeriodicBox::new(DVec3::new(9.0, 11.0, 10.0)).unwrap();
        let positions = random_positions(300, 10.0, 3);
        let (r_max, bins, sites) = (4.5, 37, 3);
        let inside = count_distances_inside(sites, &positions, &cell, r_max, bins);
        let mut expected = vec![0; bins];
        for molecule in positions.chunks(sites) {
            let counts = brute_force(molecule, &cell, r_max, bins);
            expected.iter_mut().zip(counts).for_each(|(a, b)| *a += b);
        }
        assert_eq!(inside, expected);
        let all = count_distances(&positions, &cell, r_max, bins);
        assert!(all.iter().zip(&inside).all(|(all, inside)| all >= inside));
        assert!(inside.iter().sum::<u64>() > 50);
    }

    #[test]
    fn pairs_of_species_are_counted_as_the_plain_definition_has_them() {
        let cell = PeriodicBox::new(DVec3::new(9.0, 11.0, 10.0)).unwrap();
        let positions = random_positions(300, 10.0, 3);
        for kinds in [2, 3] {
            let species = crate::testing::mixture(300, |i| i * i % 7 % kinds);
            // 4.5 takes the double loop, 2.0 the cells.
            for r_max in [4.5, 2.0] {
                let all = count_distances(&positions, &cell, r_max, 37);
                let own = Own::all_of(300);
                let found =
                    count_distances_by_species(&species, &own, &positions, &cell, r_max, &all);
                let pairs = SpeciesPair::all(&species).zip(&found);
                for (SpeciesPair { a, b }, found) in pairs {
                    let mut expected = vec![0; 37];
                    for i in species.particles(a) {
                        for j in species.particles(b).filter(|j| a != b || *j < i) {
                            let d = cell.minimum_image(positions[i] - positions[j]).length();
                            if d < r_max {
                                expected[(d / r_max * 37.0) as usize] += 1;
                            }
                        }
                    }
                    assert!(expected.iter().sum::<u64>() > 10);
                    assert_eq!(found, &expected, "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn cells_and_the_double_loop_count_the_same_pairs_on_any_number_of_threads() {
        let sides = DVec3::new(9.0, 11.0, 10.0);
        let cell = PeriodicBox::new(sides).unwrap();
        let unit = random_positions(700, 1.0, 5);
        // Unwrapped: each particle some boxes away.
        let positions: Vec<DVec3> = unit
            .iter()
            .enumerate()
            .map(|(i, r)| (*r + DVec3::splat(i as f64 % 5.0 - 2.0)) * sides)
            .collect();
        // 4.5 takes the double loop, 2.2 and 0.5 the cells (4 to 5, and 9 along each side).
        for r_max in [4.5, 2.2, 0.5] {
            let expected = brute_force(&positions, &cell, r_max, 37);
            assert!(expected.iter().sum::<u64>() > 50);
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let found = pool.install(|| count_distances(&positions, &cell, r_max, 37));
                assert_eq!(found, expected, "r_max = {r_max}");
            }
        }
    }
}
