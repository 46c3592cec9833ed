//! The arithmetic of pairs with everything in registers: the speed limit of the pair loops.

use super::lanes::Lanes;
use crate::pair::{PairForm, TwelveSix};

/// Registers of independent pairs that [`arithmetic`] keeps in flight.
const IN_FLIGHT: usize = 4;

/// Computes `rounds`·IN_FLIGHT registers of pairs with everything in registers: no list and no memory.
///
/// A pair costs differences, formula, comparison and three sums. Returns the number of pairs computed, and a number that
/// depends on all of them, so that the compiler cannot remove the work.
#[inline(always)]
pub fn arithmetic<L: Lanes>(isa: L::Isa, r_cut: f64, rounds: u64) -> (u64, f64) {
    let r_cut2 = L::constant(isa, r_cut * r_cut);
    let zero = L::constant(isa, 0.0);
    let mut force = [[zero; 3]; IN_FLIGHT];
    // Distances creep, so that no two rounds are equal.
    let mut at = [1.1, 1.3, 1.7, 2.1].map(|x| x * 0.577);
    for _ in 0..rounds {
        for k in 0..IN_FLIGHT {
            at[k] += 1e-12;
            let x = L::constant(isa, at[k]);
            let (dx, dy, dz) = (x - zero, x - force[k][0] * zero, x - force[k][1] * zero);
            let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
            let f = TwelveSix.eval([zero; 3], r2, r2.recip()).force.keep(r2.at_most(r_cut2));
            force[k][0] = dx.mul_add(f, force[k][0]);
            force[k][1] = dy.mul_add(f, force[k][1]);
            force[k][2] = dz.mul_add(f, force[k][2]);
        }
    }
    let mut sum = 0.0;
    for [x, y, z] in force {
        sum += x.sum() + y.sum() + z.sum();
    }
    (rounds * (IN_FLIGHT * L::WIDTH) as u64, sum)
}
