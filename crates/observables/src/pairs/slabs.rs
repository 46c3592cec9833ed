//! Pairs of the particles of several ranks: each rank counts the pairs of one slab of the box.
//!
//! ```text
//!   | rank 0 | rank 1 | rank 2 |     slabs along the longest side, each with about as many particles
//!        ....          ....          around slab 1: the particles of others within the radius
//! ```
//!
//! A pair inside a slab counts twice there. A pair across counts once in each of two slabs. Half of the sum over all slabs is the
//! number of pairs, wherever the slabs lie.

use lennard_core::{DVec3, Own, PeriodicBox};

use super::count_distances;

/// Slabs are whole numbers of these layers. There are so many for each rank.
const LAYERS: usize = 64;

/// [`count_distances`] over the particles of all ranks, of which this one gives its own.
#[must_use]
pub(crate) fn count_distances_of_all(
    own: &Own,
    positions: &[DVec3],
    cell: &PeriodicBox,
    r_max: f64,
    bins: usize,
) -> Vec<u64> {
    let count = |points: &[DVec3]| count_distances(points, cell, r_max, bins);
    if own.team().is_none() {
        return count(positions);
    }
    let slabs = Slabs::new(own, positions, cell);
    let some = |wanted: &dyn Fn(f64) -> bool| {
        let at = |r: &&DVec3| wanted(cell.wrap(**r)[slabs.axis]);
        positions.iter().filter(at).copied().collect()
    };
    let inside = own.deal(|rank| some(&|x| slabs.owner(x) == rank));
    let around = own.deal(|rank| some(&|x| slabs.is_around(rank, x, r_max)));
    let [within, outside] = [&inside, &around].map(|points| count(points));
    let mut twice: Vec<i64> = count(&[inside, around].concat())
        .into_iter()
        .zip(within.iter().zip(outside))
        .map(|(all, (within, outside))| (all - outside + within) as i64)
        .collect();
    own.add_up(&mut twice);
    twice.into_iter().map(|counts| (counts / 2) as u64).collect()
}

/// The slabs that ranks own.
struct Slabs {
    axis: usize,
    /// The thickness of a layer, σ.
    thickness: f64,
    /// The first layer of each rank, and the end.
    first: Vec<usize>,
}

impl Slabs {
    /// Slabs with about as many of the particles of all ranks.
    fn new(own: &Own, positions: &[DVec3], cell: &PeriodicBox) -> Self {
        let lengths = cell.lengths();
        let axis = lengths.max_position();
        let [_, ranks] = own.rank_of();
        let layers = LAYERS * ranks;
        let mut slabs =
            Self { axis, thickness: lengths[axis] / layers as f64, first: vec![0, layers] };
        let mut counts = vec![0; layers];
        positions.iter().for_each(|r| counts[slabs.layer(cell.wrap(*r)[axis])] += 1);
        own.add_up(&mut counts);
        let mut sum = 0;
        let up_to = counts.iter().map(|count| {
            sum += count;
            sum as usize
        });
        let up_to: Vec<usize> = up_to.collect();
        let begin = |rank| up_to.partition_point(|sum| sum * ranks < own.all() * rank);
        slabs.first = (0..ranks).map(begin).chain([layers]).collect();
        slabs
    }

    fn layer(&self, x: f64) -> usize {
        let last = self.first[self.first.len() - 1] - 1;
        ((x / self.thickness) as usize).min(last)
    }

    /// The rank that owns a coordinate inside the box, σ.
    fn owner(&self, x: f64) -> usize {
        let layer = self.layer(x);
        self.first.partition_point(|first| *first <= layer) - 1
    }

    /// Whether a coordinate outside the slab of a rank may be within a radius of it, σ.
    fn is_around(&self, rank: usize, x: f64, radius: f64) -> bool {
        let [begin, end] = [0, 1].map(|k| self.first[rank + k]);
        let layers = self.first[self.first.len() - 1];
        let near = (radius / self.thickness).ceil() as usize + 1;
        let layer = self.layer(x);
        let away = |from: usize, to: usize| (to + layers - from) % layers;
        begin < end
            && self.owner(x) != rank
            && (away(end - 1, layer) <= near || away(layer, begin) <= near)
    }
}

#[cfg(test)]
mod tests {
    use lennard_core::team_of_threads;

    use super::*;
    use crate::testing::random_positions;

    #[test]
    fn ranks_count_the_pairs_of_one_process_in_a_liquid_and_in_a_droplet() {
        let cell = PeriodicBox::new(DVec3::new(9.0, 11.0, 10.0)).unwrap();
        let liquid = random_positions(500, 10.0, 3);
        // All particles in one layer, and beyond the faces of the box.
        let droplet: Vec<DVec3> = liquid.iter().map(|r| 0.01 * *r - DVec3::splat(0.05)).collect();
        for (positions, r_max) in [(&liquid, 4.5), (&liquid, 0.5), (&droplet, 2.0)] {
            let expected = count_distances(positions, &cell, r_max, 37);
            assert!(expected.iter().sum::<u64>() > 50);
            for ranks in 1..6 {
                let found = team_of_threads(ranks, |team| {
                    let own = Own::of_rank(&team, positions.len());
                    let here = &positions[own.numbers()];
                    count_distances_of_all(&own, here, &cell, r_max, 37)
                });
                assert!(found.iter().all(|counts| *counts == expected), "{ranks}, {r_max}");
            }
        }
    }
}
