//! What ranks ask of each other before and beside their steps: whether they can run together, and whether one of them failed.

use std::hash::{DefaultHasher, Hash, Hasher};

use lennard_core::{Backend, Own, PeriodicBox, SpeedLimit, Team};
use lennard_forcefield::FEWEST_ON_RANKS;
use lennard_scene::Scene;

use crate::error::RanksError;
use crate::failure::LARGEST_MOVE;
use crate::{EngineError, watchdog};

/// The most: numbers of particles have 32 bits, and positions as many for each side of the box.
const MOST: usize = 1_000_000_000;

/// Refuses ranks that have another scene, and scenes that ranks do not run.
pub(crate) fn can_share(scene: &Scene, team: &Team) -> Result<(), EngineError> {
    let what = (env!("CARGO_PKG_VERSION"), scene.resolved_toml());
    same(team, "scene or version of the program", "", &what)?;
    Ok(scene.check_for_ranks()?)
}

/// Refuses ranks that have another instruction set.
pub(crate) fn same_isa(team: &Team, isa: &str) -> Result<(), RanksError> {
    let advice = "\n  one that all have: --isa avx2 or --isa portable";
    same(team, "instruction set", advice, &isa)
}

fn same(
    team: &Team,
    what: &'static str,
    advice: &'static str,
    value: &impl Hash,
) -> Result<(), RanksError> {
    let differs = team.first_that_differs(&[hash_of(value)]);
    differs.map_or(Ok(()), |rank| Err(RanksError::Differs { rank, what, advice }))
}

/// The particles, of `n`, that this rank keeps.
pub(crate) fn can_keep(team: &Team, particles: usize) -> Result<Own, RanksError> {
    match (FEWEST_ON_RANKS..=MOST).contains(&particles) {
        true => Ok(Own::of_rank(team, particles)),
        false => Err(RanksError::Particles { particles, fewest: FEWEST_ON_RANKS, most: MOST }),
    }
}

/// Shares the forces of a scene that ranks run.
pub(crate) fn share(
    forces: &mut dyn Backend,
    team: &Team,
    cell: &PeriodicBox,
) -> Result<(), RanksError> {
    let limit = SpeedLimit { every: watchdog::EVERY, largest: LARGEST_MOVE };
    let shares = forces.share(team, cell, limit)?;
    assert!(shares, "a scene for ranks has lists");
    Ok(())
}

fn hash_of(value: &impl Hash) -> u64 {
    // Its keys are constants, so that it gives all ranks the same.
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

/// What this rank found. Where another one failed, this one fails too.
pub(crate) fn alike<T>(
    team: Option<&Team>,
    found: Result<T, EngineError>,
) -> Result<T, EngineError> {
    let failed = team.is_some_and(|team| team.any(found.is_err()));
    match found {
        Ok(_) if failed => Err(RanksError::Elsewhere.into()),
        found => found,
    }
}

/// [`alike`], of what rank 0 made or wrote.
pub(crate) fn made<T, E: Into<EngineError>>(
    own: &Own,
    made: Result<T, E>,
) -> Result<T, EngineError> {
    alike(own.team(), made.map_err(E::into))
}
