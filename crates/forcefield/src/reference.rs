//! The reference loop: all pairs, serial, scalar, in double precision. Every other loop is judged by it.

use glam::DVec3;
use lennard_core::{Configuration, Exclusions};

use crate::interaction::Pairwise;
use crate::sums::{PerParticle, Totals, outer};

/// Writes forces and returns the totals; `each` takes the entries of each particle where they are wanted.
pub fn evaluate(
    pairwise: &Pairwise,
    exclusions: &Exclusions,
    at: Configuration<'_>,
    forces: &mut [DVec3],
    mut each: Option<&mut [PerParticle]>,
) -> Totals {
    let Configuration { cell, positions, .. } = at;
    let r_cut = pairwise.model().r_cut;
    let mut totals = Totals::NOTHING;
    forces.fill(DVec3::ZERO);
    for i in 0..positions.len() {
        for j in i + 1..positions.len() {
            let r_ij = cell.minimum_image(positions[i] - positions[j]);
            let r2 = r_ij.length_squared();
            if r2 <= r_cut * r_cut
                && !exclusions.exclude(i, j)
                && let Some(pair) = pairwise.between(i, j, r2)
            {
                let f_ij = pair.force * r_ij;
                forces[i] += f_ij;
                forces[j] -= f_ij;
                totals.add_end(&pair, r_ij);
                totals.at_cutoff += pairwise.energy_at_cutoff(i, j);
                if let Some(each) = &mut each {
                    for k in [i, j] {
                        each[k].0 += 0.5 * pair.energy;
                        each[k].1 += 0.5 * outer(r_ij, f_ij);
                    }
                }
            }
        }
    }
    totals.laplacian *= 2.0;
    totals
}
