//! The bonds of each particle to its neighbors, and what they say of its surroundings.

use lennard_core::{DVec3, PeriodicBox, parallel};

use super::harmonics::{Harmonics, Moments, NOTHING};
use crate::cells::Cells;

/// The first minimum of g(r) in a liquid and between the first shells of a crystal, in units of ρ^{−1/3}.
const FIRST_MINIMUM: f64 = 1.42;

/// The distance up to which particles are neighbors where none is given, σ, in a box of `n` particles.
pub(super) fn usual_reach(cell: &PeriodicBox, n: usize) -> f64 {
    let distance = (cell.volume() / n.max(1) as f64).cbrt();
    (FIRST_MINIMUM * distance).min(cell.largest_cutoff())
}

/// Who is solid-like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SolidRule {
    /// Two neighbors are in order where q₆(i)·q₆*(j)/(|q₆(i)||q₆(j)|) exceeds this.
    pub threshold: f64,
    /// The fewest neighbors in order with a solid-like particle.
    pub bonds: usize,
}

/// The rule of ten Wolde, Ruiz-Montero and Frenkel.
pub(super) const TEN_WOLDE: SolidRule = SolidRule { threshold: 0.5, bonds: 7 };

/// Neighbors of all particles, with the moments of N orders of their bonds. The last order tells who is solid-like.
pub(super) struct Bonds<'a, const N: usize> {
    pub orders: [&'a Harmonics; N],
    /// The neighbors of each particle.
    pub neighbors: Vec<Vec<u32>>,
    /// The mean over the bonds of each particle, of each order; zero without neighbors.
    pub moments: Vec<[Moments; N]>,
}

impl<'a, const N: usize> Bonds<'a, N> {
    /// Looks at the neighbors up to `reach` σ, at most half the shortest side.
    pub(super) fn new(
        orders: [&'a Harmonics; N],
        cell: &PeriodicBox,
        positions: &[DVec3],
        reach: f64,
    ) -> Self {
        let numbered: Vec<(u32, DVec3)> = (0_u32..).zip(positions.iter().copied()).collect();
        let cells = Cells::new(&numbered, cell, reach);
        drop(numbered);
        let of_particle = |i: usize| {
            let place = cell.wrap(positions[i]);
            let mut neighbors = Vec::new();
            for points in cells.around(cells.home(place)) {
                points.squared_distances(place, cells.sides(), 0, |first, squared| {
                    for (id, r2) in points.ids()[first..].iter().zip(squared) {
                        if *r2 <= reach * reach && *id as usize != i {
                            neighbors.push(*id);
                        }
                    }
                });
            }
            let mut moments = [NOTHING; N];
            for j in &neighbors {
                let bond = cell.minimum_image(positions[*j as usize] - positions[i]);
                for (harmonics, moments) in orders.iter().zip(&mut moments) {
                    harmonics.add(moments, bond);
                }
            }
            let share = 1.0 / neighbors.len().max(1) as f64;
            (neighbors, moments.map(|m| scaled(&m, share)))
        };
        let mut neighbors = vec![Vec::new(); positions.len()];
        let mut moments = vec![[NOTHING; N]; positions.len()];
        parallel::for_each_piece_pair(&mut neighbors, &mut moments, |first, neighbors, moments| {
            for (k, (neighbors, moments)) in neighbors.iter_mut().zip(moments).enumerate() {
                (*neighbors, *moments) = of_particle(first + k);
            }
        });
        Self { orders, neighbors, moments }
    }

    /// The mean moments over all bonds.
    pub(super) fn of_all(&self) -> [Moments; N] {
        let mut sum = [NOTHING; N];
        let mut bonds = 0;
        for (neighbors, moments) in self.neighbors.iter().zip(&self.moments) {
            bonds += neighbors.len();
            for (sum, own) in sum.iter_mut().zip(moments) {
                add(sum, own, neighbors.len() as f64);
            }
        }
        sum.map(|m| scaled(&m, 1.0 / bonds.max(1) as f64))
    }

    /// The moments of a particle averaged over itself and its neighbors.
    pub(super) fn averaged(&self, i: usize) -> [Moments; N] {
        let mut sum = self.moments[i];
        for j in &self.neighbors[i] {
            for (sum, other) in sum.iter_mut().zip(&self.moments[*j as usize]) {
                add(sum, other, 1.0);
            }
        }
        let share = 1.0 / (1 + self.neighbors[i].len()) as f64;
        sum.map(|m| scaled(&m, share))
    }

    /// Whether a particle is solid-like.
    pub(super) fn is_solid(&self, i: usize, rule: SolidRule) -> bool {
        let order = self.orders[N - 1];
        let product =
            |i: usize, j: usize| order.product(&self.moments[i][N - 1], &self.moments[j][N - 1]);
        let size = |i: usize| product(i, i).sqrt();
        let own = size(i);
        let in_order = |j: &&u32| {
            let j = **j as usize;
            product(i, j) > rule.threshold * own * size(j)
        };
        self.neighbors[i].iter().filter(in_order).count() >= rule.bonds
    }

    /// How many of the particles that count are solid-like.
    pub(super) fn solid(&self, rule: SolidRule, counts: impl Fn(usize) -> bool + Sync) -> usize {
        let counts = parallel::map_ranges(self.neighbors.len(), |range| {
            range.filter(|i| counts(*i) && self.is_solid(*i, rule)).count()
        });
        counts.into_iter().sum()
    }
}

fn add(to: &mut Moments, moments: &Moments, weight: f64) {
    for (to, from) in to.iter_mut().zip(moments) {
        to[0] += weight * from[0];
        to[1] += weight * from[1];
    }
}

fn scaled(moments: &Moments, factor: f64) -> Moments {
    moments.map(|[re, im]| [factor * re, factor * im])
}
