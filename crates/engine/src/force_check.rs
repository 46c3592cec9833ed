//! Forces of a few particles at a time, against sums over all pairs: what shows that no list missed a pair.

use lennard_core::{DVec3, State, persist};
use lennard_forcefield::AllPairs;

use crate::failure::Symptom;
use crate::watchdog::LISTS_EVERY;

/// Particles checked at a look, where a step is long enough for as many.
const AT_A_LOOK: usize = 2;
/// For numbers of particles in this range two particles are checked at a time, otherwise one. A step of few
/// particles costs little, and with very many each position comes from memory.
const ENOUGH: std::ops::RangeInclusive<usize> = 500..=100_000;
/// The golden ratio less 1: particles whose turns follow each other lie far apart.
const STRIDE: f64 = 0.618_033_988_749_895;

/// Checks forces of a state against sums over all pairs, and counts what it saw.
///
/// The step alone decides whose turn it is. After N/2 checks (N where one particle is checked at a time) each particle
/// has had its turn once. The checked forces belong to the positions of the state, as every method leaves them.
#[derive(Debug, Clone)]
pub struct ForceCheck {
    all_pairs: AllPairs,
    seen: Seen,
}

/// Forces that were checked and found right.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seen {
    /// How many.
    pub forces: u64,
    /// The largest deviation among them, in units of what rounding explains; 0 of none.
    pub largest_deviation: f64,
}

impl Seen {
    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            forces: self.forces + other.forces,
            largest_deviation: self.largest_deviation.max(other.largest_deviation),
        }
    }
}

impl ForceCheck {
    /// A check by these sums that has seen nothing yet.
    #[must_use]
    pub fn new(all_pairs: AllPairs) -> Self {
        Self { all_pairs, seen: Seen::default() }
    }

    /// What was counted so far.
    #[must_use]
    pub fn seen(&self) -> Seen {
        self.seen
    }

    /// Counts what a look saw.
    pub fn count(&mut self, seen: Seen) {
        self.seen = self.seen.and(seen);
    }

    /// Checks the particles whose turn it is. `other` is the force in the state on a particle that is not by pairs, ε/σ.
    ///
    /// # Errors
    /// [`Symptom::WrongForce`] for the first one whose force differs by more than rounding explains.
    pub fn look(&self, state: &State, other: impl Fn(usize) -> DVec3) -> Result<Seen, Symptom> {
        turns(state.step / LISTS_EVERY, state.len())
            .map(|particle| self.check(particle, state, &other))
            .try_fold(Seen::default(), |seen, one| Ok(seen.and(one?)))
    }

    fn check(
        &self,
        particle: usize,
        state: &State,
        other: &dyn Fn(usize) -> DVec3,
    ) -> Result<Seen, Symptom> {
        let wanted = self.all_pairs.force_on(particle, &state.cell, &state.positions);
        // The same formula on the same position gives the same bits: the sum alone rounds.
        let other = other(particle);
        let tolerance = wanted.tolerance + 4.0 * f64::EPSILON * other.length();
        let wanted = wanted.force + other;
        let found = state.forces[particle];
        let deviation = (found - wanted).length() / tolerance;
        if deviation <= 1.0 {
            return Ok(Seen { forces: 1, largest_deviation: deviation });
        }
        Err(Symptom::WrongForce { particle, found, wanted, tolerance })
    }
}

/// The particles of `n` whose turn it is at a look.
fn turns(look: u64, n: usize) -> impl Iterator<Item = usize> {
    let count = if ENOUGH.contains(&n) { AT_A_LOOK } else { 1 };
    let n = n as u64;
    let near = (STRIDE * n as f64) as u64;
    let stride =
        (near.max(1)..=n + 1).find(|stride| greatest_common_divisor(*stride, n) == 1).unwrap_or(1);
    let first = look % n.max(1) * count as u64;
    (first..first + count as u64).map(move |turn| (turn % n * stride % n) as usize)
}

fn greatest_common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

persist!(ForceCheck { ..seen, fixed all_pairs });
persist!(Seen { forces, largest_deviation });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_particle_has_its_turn_and_neighbors_in_time_lie_far_apart() {
        for n in [1, 2, 3, 4, 108, 256, 499, 500, 864, 1000, 4001] {
            let looks = if ENOUGH.contains(&n) { n.div_ceil(AT_A_LOOK) } else { n };
            // From anywhere on.
            let first = 7 * n as u64;
            let mut seen = vec![0; n];
            for look in first..first + looks as u64 {
                turns(look, n).for_each(|i| seen[i] += 1);
            }
            assert!(seen.iter().all(|k| (1..=2).contains(k)), "{n}: {seen:?}");
            if n > 100 {
                let at = |look| turns(look, n).next().unwrap() as i64;
                assert!((at(1) - at(0)).abs() > n as i64 / 5);
            }
        }
    }
}
