//! Stops a run that has gone wrong, and says what went wrong; checks a few forces against sums over all pairs.
//!
//! Watching has two parts. The forces refuse numbers that are not finite at every evaluation. The watchdog checks the speeds at
//! every [`EVERY`]th step and wherever something is sampled. On sampled steps it checks the conserved energy. At every
//! [`LISTS_EVERY`]th step it checks forces of a few particles ([`crate::ForceCheck`]). A box too small for its cutoff is refused
//! before the first step, and by the forces where it shrinks.

use lennard_core::{DVec3, Own, SpeciesTable, State, System, parallel, persist};
use lennard_forcefield::AllPairs;
use lennard_scene::Scene;

use crate::failure::{LARGEST_ENERGY_CHANGE, Symptom};
use crate::schedule::SET_ASIDE_EVERY;

/// Steps between two checks of the speeds. With a limit of a fifth of σ per step, no particle
/// crosses more than a few σ unseen. A check costs far below 1 % of the steps between.
pub const EVERY: u64 = 20;

/// Steps between two looks at forces of a few particles, which show whether a list missed a pair; a multiple of [`EVERY`].
pub const LISTS_EVERY: u64 = 100;

/// What the watchdog does how often, for plans and benchmarks.
#[must_use]
pub fn what_is_done() -> String {
    format!(
        "speeds every {EVERY} steps, forces of one or two particles every {LISTS_EVERY}, a state set aside every {SET_ASIDE_EVERY}"
    )
}

/// The largest squared speed of some particles, (σ/τ)², the same for any number of threads; NaN counts as infinite.
fn largest_squared_speed(velocities: &[DVec3]) -> f64 {
    let squared = |v: &DVec3| {
        let v2 = v.length_squared();
        if v2.is_nan() { f64::INFINITY } else { v2 }
    };
    let of_ranges = parallel::map_ranges(velocities.len(), |range| {
        velocities[range].iter().map(squared).fold(0.0, f64::max)
    });
    of_ranges.into_iter().fold(0.0, f64::max)
}

/// Fails where a particle moves more than `largest` σ in one step.
///
/// # Errors
/// The symptom.
pub fn check_speeds(own: &Own, state: &State, dt: f64, largest: f64) -> Result<(), Symptom> {
    let squared = own.largest(largest_squared_speed(&state.velocities));
    if squared * dt * dt <= largest * largest {
        return Ok(());
    }
    let (particle, speed) = fastest(own, state).unwrap_or((0, f64::INFINITY));
    Err(Symptom::TooFast { particle, distance: speed * dt, largest })
}

/// Fails where the conserved energy per particle has left its start by more than `LARGEST_ENERGY_CHANGE`.
///
/// # Errors
/// The symptom.
pub fn check_energy(from: f64, to: f64) -> Result<(), Symptom> {
    if (to - from).abs() <= LARGEST_ENERGY_CHANGE {
        Ok(())
    } else {
        Err(Symptom::EnergyRunAway { from, to })
    }
}

/// The number of the fastest particle of all ranks with its speed, σ/τ; the last of several.
pub(crate) fn fastest(own: &Own, state: &State) -> Option<(usize, f64)> {
    let speeds =
        state.velocities.iter().map(|v| if v.is_finite() { v.length() } else { f64::INFINITY });
    let here = own.numbers().zip(speeds).max_by(|a, b| a.1.total_cmp(&b.1));
    let Some(team) = own.team() else { return here };
    let words = here.map_or([0, 0], |(number, speed)| [number as u64, speed.to_bits()]);
    let all = team.concat(&words);
    let all =
        all.as_chunks().0.iter().map(|[number, bits]| (*number as usize, f64::from_bits(*bits)));
    all.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// An estimate of the largest stable dt of an explicit method with limit ωh = `limit` in a fluid: h =
/// limit/ω_max. Here ω_max² = U″(r₀)·c/m at the closest approach r₀ that thermal pairs reach, U(r₀) ≈ 4T.
///
/// For Lennard-Jones 4(s² − s) = 4T with s = r₀⁻⁶, and U″ = 4(156 s² − 42 s)·s^{1/3}. A pair vibrates with
/// its reduced mass, a factor 2 in ω². Rough (±30 %), which is enough to name a cause.
#[must_use]
pub fn rough_stable_dt(temperature: f64, limit: f64) -> f64 {
    let s = 0.5 * (1.0 + (1.0 + 4.0 * temperature).sqrt());
    let curvature = 4.0 * (156.0 * s * s - 42.0 * s) * s.cbrt();
    limit / (2.0 * curvature).sqrt()
}

/// The pair of species that bounds the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FastestPair {
    /// The two species, by number.
    pub species: [usize; 2],
    /// The estimate of [`rough_stable_dt`], τ.
    pub stable_dt: f64,
}

/// The pair of species with the shortest [`rough_stable_dt`]; `None` where no pair repels. The unit of time of a pair is
/// σ_ab·√(2μ_ab/ε_ab) with the reduced mass μ_ab.
#[must_use]
pub fn fastest_pair(
    scene: &Scene,
    species: &SpeciesTable,
    temperature: f64,
    limit: f64,
) -> Option<FastestPair> {
    let of_pair = |[a, b]: [usize; 2]| {
        let pair = scene.species_pair(a, b);
        let [m_a, m_b] = [a, b].map(|a| species.species(a).mass);
        let unit = pair.sigma * (2.0 * m_a * m_b / ((m_a + m_b) * pair.epsilon)).sqrt();
        FastestPair {
            species: [a, b],
            stable_dt: unit * rough_stable_dt(temperature / pair.epsilon, limit),
        }
    };
    let pairs = scene.species_pairs();
    let repelling = pairs.filter(|[a, b]| scene.species_pair(*a, *b).epsilon > 0.0);
    let shortest = |x: &FastestPair, y: &FastestPair| x.stable_dt.total_cmp(&y.stable_dt);
    repelling.map(of_pair).min_by(shortest)
}

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

    /// Checks the particles whose turn it is, on all ranks alike. `other` is the force in the state on a particle that is not by
    /// pairs, ε/σ, from its index in the arrays. Sums in it need all ranks: one that does not keep the particle asks for another.
    ///
    /// # Errors
    /// [`Symptom::WrongForce`] for the first one whose force differs by more than rounding explains.
    pub fn look(
        &self,
        system: &System,
        state: &State,
        other: impl Fn(usize) -> DVec3,
    ) -> Result<Seen, Symptom> {
        turns(state.step / LISTS_EVERY, system.len())
            .map(|particle| self.check(particle, system, state, &other))
            .try_fold(Seen::default(), |seen, one| Ok(seen.and(one?)))
    }

    fn check(
        &self,
        particle: usize,
        system: &System,
        state: &State,
        other: &dyn Fn(usize) -> DVec3,
    ) -> Result<Seen, Symptom> {
        let (own, State { cell, positions, .. }) = (system.own(), state);
        let wanted = self.all_pairs.force_over(own, system.species(), particle, cell, positions);
        let index = own.index(particle);
        // The same formula on the same position gives the same bits: the sum alone rounds.
        let other = other(index.unwrap_or(0));
        let other = own.vector(index.map(|_| other));
        let tolerance = wanted.tolerance + 4.0 * f64::EPSILON * other.length();
        let wanted = wanted.force + other;
        let found = own.vector(index.map(|i| state.forces[i]));
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

pub(crate) fn greatest_common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

persist!(ForceCheck { ..seen, fixed all_pairs });
persist!(Seen { forces, largest_deviation });

#[cfg(test)]
mod tests {
    use lennard_core::PeriodicBox;

    use crate::failure::LARGEST_MOVE;

    use super::*;

    fn state(speed: f64) -> State {
        let mut s = State::new(
            PeriodicBox::new(DVec3::splat(10.0)).unwrap(),
            vec![DVec3::ZERO, DVec3::new(0.5, 0.0, 0.0)],
            vec![DVec3::ZERO; 2],
        );
        s.velocities[1].y = speed;
        s
    }

    #[test]
    fn a_particle_is_stopped_just_past_the_limit_and_not_just_below() {
        let dt = 0.01;
        assert!(
            check_speeds(&Own::all_of(2), &state(0.999 * LARGEST_MOVE / dt), dt, LARGEST_MOVE)
                .is_ok()
        );
        let found =
            check_speeds(&Own::all_of(2), &state(1.001 * LARGEST_MOVE / dt), dt, LARGEST_MOVE);
        assert!(matches!(found, Err(Symptom::TooFast { particle: 1, .. })), "{found:?}");
        assert!(check_speeds(&Own::all_of(2), &state(f64::NAN), dt, LARGEST_MOVE).is_err());
        for (change, is_sound) in [(0.9, true), (-0.9, true), (1.1, false), (-1.1, false)] {
            assert_eq!(check_energy(-4.0, -4.0 + change).is_ok(), is_sound, "{change}");
        }
        assert!(check_energy(-4.0, f64::NAN).is_err());
    }

    #[test]
    fn the_rough_limit_lies_near_the_known_one() {
        // Blow-up of velocity Verlet near the triple point is seen between 0.02 and 0.04 τ.
        let h = rough_stable_dt(0.722, 2.0);
        assert!((0.02..0.045).contains(&h), "{h}");
    }

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
