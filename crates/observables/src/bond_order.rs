//! Bond-orientational order: how the directions to neighbors are arranged, and which particles are solid-like.

mod harmonics;
mod particles;

use crate::{BuildContext, Findings, Observable, ObservableError, ObservableSpec, recipe};
use lennard_core::exact::exact_sum;
use lennard_core::{DVec3, Own, PeriodicBox, View, persist};

use crate::error::within_box;
use crate::series::{Series, columns};

use harmonics::Harmonics;
use particles::{Bonds, SolidRule, TEN_WOLDE, usual_reach};

const SPEC: ObservableSpec = ObservableSpec {
    name: "bond-order",
    summary: "Steinhardt's Q4, Q6, W4, W6 of all bonds and of each particle, averaged over neighbors too, and the share of solid-like particles",
    equation: "Q_l = sqrt(4 pi/(2 l + 1) sum_m |q_lm|^2), q_lm = <Y_lm> over bonds; solid-like: q6(i).q6*(j)/|q6(i)||q6(j)| > 0.5 for 7 neighbors",
    source: "P. J. Steinhardt, D. R. Nelson and M. Ronchetti, Phys. Rev. B 28, 784 (1983); P. R. ten Wolde, M. J. Ruiz-Montero and D. Frenkel, J. Chem. Phys. 104, 9932 (1996); W. Lechner and C. Dellago, J. Chem. Phys. 129, 114707 (2008)",
    suits: crate::Suits::Atoms,
    every: 100,
    alone: Some("looks at neighbors beyond those that forces have"),
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 14;

lennard_core::options! {
    /// Options of [`BondOrder`].
    pub struct BondOrderOptions {
        /// Distance up to which particles are neighbors.
        r_max: Option<f64> = None, else "1.42/ρ^(1/3) of the box at each sample: the first minimum of g(r)", Words("a number above 0, at most half the shortest box side"), in "σ";
        /// Two neighbors are in order above this product of their moments of order 6.
        threshold: f64 = TEN_WOLDE.threshold, Between(0.0, 1.0);
        /// Fewest neighbors in order with a solid-like particle.
        bonds: usize = TEN_WOLDE.bonds, Whole(1, 100);
    }
}

recipe!(BondOrderOptions, |options, context| BondOrder::new(options, context)?);

columns! {
    /// One row for each sample.
    struct Rows {
        time, q4, q6, w4, w6, local_q4, local_q6, averaged_q4, averaged_q6, averaged_w4,
        averaged_w6, solid, neighbors
    }
}

/// Bond-orientational order of orders 4 and 6.
///
/// A bond joins a particle with a neighbor, and q_lm(i) is the mean of Y_lm over the bonds of particle i. From its moments come
///
/// Q_l = √(4π/(2l + 1)·Σ_m |q_lm|²) and W_l = Σ (l l l; m₁ m₂ m₃)·q_lm₁·q_lm₂·q_lm₃/(Σ_m |q_lm|²)^{3/2}.
///
/// `bond_order_q6` is of the mean over all bonds. It is 0.57 in a face-centred crystal, 0.48 in a hexagonal one, and 0.51 in a
/// body-centred one with 14 neighbors. In a liquid it is of order 1/√(bonds). `local_q6` is the mean of Q₆ over particles, each
/// with its own bonds. For `averaged_q6` the moments of a particle are first averaged over itself and its neighbors. A particle is
/// solid-like where the moments of order 6 are alike at it and at seven of its neighbors at least.
#[derive(Debug, Clone, PartialEq)]
pub struct BondOrder {
    r_max: Option<f64>,
    rule: SolidRule,
    orders: [Harmonics; 2],
    series: Series<Rows>,
}

impl BondOrder {
    /// Nothing seen yet.
    ///
    /// # Errors
    /// [`ObservableError`] where `r_max` is beyond half the shortest side.
    pub fn new(
        options: &BondOrderOptions,
        context: &BuildContext,
    ) -> Result<Self, ObservableError> {
        within_box("r_max", options.r_max, &context.cell)?;
        Ok(Self {
            r_max: options.r_max,
            rule: SolidRule { threshold: options.threshold, bonds: options.bonds },
            orders: [Harmonics::new(4), Harmonics::new(6)],
            series: Series::new(Rows::default(), MOST_ROWS),
        })
    }

    /// What each sample gives: the columns after the time.
    fn look(&self, cell: &PeriodicBox, positions: &[DVec3]) -> [f64; 12] {
        let reach = self.r_max.map(|r| r.min(cell.largest_cutoff()));
        let reach = reach.unwrap_or_else(|| usual_reach(cell, positions.len()));
        let [four, six] = &self.orders;
        let bonds = Bonds::new([four, six], cell, positions, reach);
        let [all_four, all_six] = bonds.of_all();
        let sums = exact_sum(positions.len(), |i| {
            let [own_four, own_six] = &bonds.moments[i];
            let [mean_four, mean_six] = &bonds.averaged(i);
            [
                four.q(own_four),
                six.q(own_six),
                four.q(mean_four),
                six.q(mean_six),
                four.w(mean_four),
                six.w(mean_six),
                bonds.neighbors[i].len() as f64,
            ]
        });
        let n = positions.len() as f64;
        let [q4, q6, mean_q4, mean_q6, mean_w4, mean_w6, neighbors] = sums.map(|sum| sum / n);
        [
            four.q(&all_four),
            six.q(&all_six),
            four.w(&all_four),
            six.w(&all_six),
            q4,
            q6,
            mean_q4,
            mean_q6,
            mean_w4,
            mean_w6,
            bonds.solid(self.rule, |_| true) as f64 / n,
            neighbors,
        ]
    }
}

/// Bytes that [`solid_share`] takes for a particle: its moments, its neighbors, and its place in a cell.
const SHARE_BYTES: usize = 310;
/// About how many particles have bonds at once: a larger box is looked at layer by layer.
const AT_ONCE: usize = 200_000;

/// Bytes that [`solid_share`] takes in a box of `n` particles.
#[must_use]
pub fn solid_share_bytes(n: usize) -> usize {
    n.min(AT_ONCE) * SHARE_BYTES
}

/// The share of solid-like particles in a configuration, by the rule of ten Wolde, Ruiz-Montero and Frenkel (1996).
///
/// Neighbors are particles up to 1.42·ρ^{−1/3}. A crystal at rest has 1, a dense liquid some hundredths.
#[must_use]
pub fn solid_share(cell: &PeriodicBox, positions: &[DVec3]) -> f64 {
    solid_share_of_all(&Own::all_of(positions.len()), cell, positions)
}

/// As [`solid_share`], where each rank has the positions of the particles that it keeps.
pub(crate) fn solid_share_of_all(own: &Own, cell: &PeriodicBox, positions: &[DVec3]) -> f64 {
    let blocks = match own.team() {
        None => [1, own.all().div_ceil(AT_ONCE).max(1)],
        // Thin blocks take more time, and no rank holds much more than it keeps.
        Some(_) => {
            let around = 4.0 * usual_reach(cell, own.all());
            let of_block = OF_A_BLOCK * own.all() as f64 / own.rank_of()[1] as f64;
            let sides = cell.lengths();
            let width = (of_block * sides.y * sides.z / own.all() as f64).sqrt();
            let width = (width - around).max(around);
            [sides.y, sides.z].map(|side| (side / width).max(1.0) as usize)
        }
    };
    solid_by_blocks(own, cell, positions, blocks) as f64 / own.all().max(1) as f64
}

/// The share of a rank's particles that it looks at together.
const OF_A_BLOCK: f64 = 0.1;

/// The number of solid-like particles, counted in blocks across y and z. Neighbors of neighbors decide on a particle, so that each
/// block has two reaches more around it. Ranks take blocks in turn, and each gets what lies there.
fn solid_by_blocks(
    own: &Own,
    cell: &PeriodicBox,
    positions: &[DVec3],
    blocks: [usize; 2],
) -> usize {
    let six = Harmonics::new(6);
    let reach = usual_reach(cell, own.all());
    let sides = [cell.lengths().y, cell.lengths().z];
    let across = |k: usize, r: DVec3| [cell.wrap(r).y, cell.wrap(r).z][k];
    let block_of = |r: DVec3| {
        let [j, k] = [0, 1].map(|axis| {
            let at = across(axis, r) / sides[axis] * blocks[axis] as f64;
            (at as usize).min(blocks[axis] - 1)
        });
        j * blocks[1] + k
    };
    let near = |block: usize| -> Vec<DVec3> {
        let at = [block / blocks[1], block % blocks[1]];
        let is_near = |r: &&DVec3| {
            (0..2).all(|axis| {
                let width = sides[axis] / blocks[axis] as f64;
                let away = (across(axis, **r) - (at[axis] as f64 + 0.5) * width).abs();
                away.min(sides[axis] - away) <= 0.5 * width + 2.0 * reach
            })
        };
        positions.iter().filter(is_near).copied().collect()
    };
    let [rank, ranks] = own.rank_of();
    let all = blocks[0] * blocks[1];
    let mut solid = 0;
    for first in (0..all).step_by(ranks) {
        let near =
            own.deal(|rank| if first + rank < all { near(first + rank) } else { Vec::new() });
        if !near.is_empty() {
            let bonds = Bonds::new([&six], cell, &near, reach);
            solid += bonds.solid(TEN_WOLDE, |i| block_of(near[i]) == first + rank);
        }
    }
    own.count(solid)
}

impl Observable for BondOrder {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let mut row = [view.state.time; 13];
        row[1..].copy_from_slice(&self.look(view.cell(), &view.state.positions));
        self.series.push(&row);
    }

    fn finish(&self, discarded: f64) -> Findings {
        let rows = self.series.rows();
        let cut = (discarded * self.series.len() as f64).round() as usize;
        let named = [
            ("bond_order_q4", &rows.q4),
            ("bond_order_q6", &rows.q6),
            ("bond_order_w4", &rows.w4),
            ("bond_order_w6", &rows.w6),
            ("local_q4", &rows.local_q4),
            ("local_q6", &rows.local_q6),
            ("averaged_q4", &rows.averaged_q4),
            ("averaged_q6", &rows.averaged_q6),
            ("averaged_w4", &rows.averaged_w4),
            ("averaged_w6", &rows.averaged_w6),
            ("solid_share", &rows.solid),
            ("neighbors_in_reach", &rows.neighbors),
        ];
        let averages = named.map(|(name, column)| self.series.average(name, "", column, cut));
        let columns = named.map(|(name, column)| (name, "", column));
        let table = self.series.table("bond_order", "order of bonds", columns);
        Findings { averages: averages.into(), tables: vec![table], ..Findings::default() }
    }
}

persist!(BondOrder { series, fixed r_max, rule, orders });

#[cfg(test)]
mod tests;
