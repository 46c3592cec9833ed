//! What the end of the pair potential adds to second derivatives of U, which no pair loop sees.

use lennard_core::{Molecules, Own, SpeciesTable, View};

/// Width of the shell inside a cutoff whose pairs tell how many lie at the cutoff, as a part of the cutoff.
const SHELL: f64 = 0.05;
/// Steps of a run for each particle around which pairs are counted. Counting then costs about one percent of the run.
const STEPS_PER_CENTRE: u64 = 5;
/// 2⁶⁴ times the golden ratio: multiples, taken modulo 2⁶⁴, spread evenly over all particles.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// Where the potential of two species ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairEnd {
    /// The cutoff r_ab, σ.
    pub r_cut: f64,
    /// U′(r_ab) just inside the cutoff, ε/σ; zero where the force is continuous.
    pub slope: f64,
    /// U(r_ab) of the potential before it was shifted, ε; zero where the energy is not shifted.
    pub shift: f64,
}

/// Sums over all pairs, estimated from the pairs around a few particles.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct EndSums {
    /// Σ U′_ab·δ(r − r_ab), ε/σ².
    pub jump: f64,
    /// Σ U′_ab·r²·δ(r − r_ab), ε.
    pub jump_r2: f64,
    /// Σ U_ab(r_ab) over the pairs inside their cutoffs, ε.
    pub shift: f64,
}

/// The ends of all pairs of species, row by row, `[species]²`; empty where nothing has an end that counts.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Ends(Vec<PairEnd>);

impl Ends {
    pub fn new(ends: Vec<PairEnd>) -> Self {
        let counts = ends.iter().any(|e| e.slope != 0.0 || e.shift != 0.0);
        Self(if counts { ends } else { Vec::new() })
    }

    pub fn are_none(&self) -> bool {
        self.0.is_empty()
    }

    /// The sums of one state, the `sample`-th of samples that are `every` steps apart. Successive samples look around different
    /// particles.
    ///
    /// A delta function at the cutoff becomes a weight (4 − 6x)/d of the pairs at r = r_ab − x·d with 0 < x < 1. This weight takes the
    /// density of pairs at the cutoff itself, up to a part in d² of its curvature.
    pub fn sums(
        &self,
        view: &View<'_>,
        species: &SpeciesTable,
        molecules: &Molecules,
        (sample, every): (u64, u64),
    ) -> EndSums {
        let positions = &view.state.positions;
        let (cell, exclusions) = (view.cell(), molecules.exclusions());
        let (own, n) = (view.system.own(), view.len());
        let centres = n.min(every.div_ceil(STEPS_PER_CENTRE) as usize);
        let mut sums = EndSums::default();
        for k in 0..centres {
            let i = if centres == n {
                k
            } else {
                let turn = (sample * centres as u64 + k as u64).wrapping_mul(GOLDEN);
                ((u128::from(turn) * n as u128) >> 64) as usize
            };
            let here = own.index(i);
            let center = own.vector(here.map(|i| positions[i]));
            let [kind] = own.told(here.map(|i| [species.of(i) as u64])).unwrap_or_default();
            let row = &self.0[kind as usize * species.n_species()..];
            let pairs = own.numbers().zip(positions).enumerate().filter_map(|(here, (j, r))| {
                let r2 = cell.minimum_image(*r - center).length_squared();
                let kind = species.of(here);
                let r_cut = row[kind].r_cut;
                let counts = r2 < r_cut * r_cut && i != j && !exclusions.exclude(i, j);
                counts.then_some((kind, r2))
            });
            // Pairs come in the order of their numbers, from one rank after another.
            for (kind, r2) in all_pairs(own, pairs) {
                let end = row[kind];
                let width = SHELL * end.r_cut;
                let x = (end.r_cut - r2.sqrt()) / width;
                let at_end = if x < 1.0 { (4.0 - 6.0 * x) / width } else { 0.0 };
                sums.jump += end.slope * at_end;
                sums.jump_r2 += end.slope * at_end * r2;
                sums.shift += end.shift;
            }
        }
        // Each pair is seen from both of its particles.
        let share = 0.5 * n as f64 / centres as f64;
        EndSums {
            jump: share * sums.jump,
            jump_r2: share * sums.jump_r2,
            shift: share * sums.shift,
        }
    }
}

/// Pairs of one particle that all ranks found, each by the species of the other and r²; one rank after another.
fn all_pairs(own: &Own, here: impl Iterator<Item = (usize, f64)>) -> Vec<(usize, f64)> {
    let Some(team) = own.team() else { return here.collect() };
    let words: Vec<u64> = here.flat_map(|(kind, r2)| [kind as u64, r2.to_bits()]).collect();
    let all = team.concat(&words);
    all.as_chunks().0.iter().map(|[kind, r2]| (*kind as usize, f64::from_bits(*r2))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::estimate_stationary;
    use crate::testing::{context, mixture, random_positions, view_of};
    use lennard_core::Species;
    use std::f64::consts::PI;

    /// U′ of the Lennard-Jones potential.
    fn slope(r: f64) -> f64 {
        24.0 * (r.powi(-7) - 2.0 * r.powi(-13))
    }

    /// Means of the sums for each particle over states of random points, which have g = 1 between different particles, where pairs are
    /// counted around `centres` of them. They come with their errors.
    fn of_random_points(
        (n, density): (usize, f64),
        (species, ends): (&SpeciesTable, &Ends),
        centres: u64,
        samples: u64,
    ) -> [(f64, f64); 3] {
        let side = (n as f64 / density).cbrt();
        let cell = context(side, n).cell;
        let mut found = [const { Vec::new() }; 3];
        for sample in 0..samples {
            view_of(&cell, random_positions(n, side, sample), |view| {
                let at = (sample, centres * STEPS_PER_CENTRE);
                let sums = ends.sums(view, species, &Molecules::ATOMS, at);
                for (all, x) in found.iter_mut().zip([sums.jump, sums.jump_r2, sums.shift]) {
                    all.push(x / n as f64);
                }
            });
        }
        found.map(|all| {
            let estimate = estimate_stationary(&all);
            (estimate.mean, estimate.standard_error)
        })
    }

    fn agree((found, error): (f64, f64), expected: f64, part: f64) {
        assert!(error < part * expected.abs(), "{error} of {expected}");
        assert!((found - expected).abs() < 4.0 * error, "{found} ± {error}, {expected}");
    }

    #[test]
    fn each_pair_of_species_counts_at_its_own_cutoff() {
        // One fluid under two names, half and half. The pairs of B end at 1.5, the others at 2.5.
        let (n, rho) = (128, 0.6);
        let species = mixture(n, |i| i % 2);
        let end = |r_cut: f64| PairEnd { r_cut, slope: slope(r_cut), shift: 0.1 * r_cut };
        let ends = Ends::new(vec![end(2.5), end(2.5), end(2.5), end(1.5)]);
        let others = 1.0 - 1.0 / n as f64;
        let over =
            |f: &dyn Fn(f64) -> f64| 2.0 * PI * rho * others * (0.75 * f(2.5) + 0.25 * f(1.5));
        let r4 = over(&|r| r.powi(4) * slope(r));
        // X/9 of the jump with g = 1.
        assert!((-r4 / 9.0 + 1.09).abs() < 0.02, "{r4}");
        for (centres, samples) in [(n as u64, 300), (2, 20_000)] {
            let [jump, jump_r2, shift] =
                of_random_points((n, rho), (&species, &ends), centres, samples);
            agree(jump, over(&|r| r * r * slope(r)), 0.05);
            agree(jump_r2, r4, 0.03);
            agree(shift, over(&|r| r.powi(3) / 3.0 * 0.1 * r), 0.01);
        }
    }

    #[test]
    fn a_particle_of_few_is_no_pair_with_itself() {
        let (n, rho) = (2, 0.03);
        let species = SpeciesTable::one(Species::unnamed(), n);
        let end = PairEnd { r_cut: 1.5, slope: slope(1.5), shift: 0.0 };
        let ends = Ends::new(vec![end]);
        let found = of_random_points((n, rho), (&species, &ends), 2, 40_000);
        agree(found[0], 0.5 * 2.0 * PI * rho * 2.25 * slope(1.5), 0.06);
    }
}
