//! Pairs of a start that are so close that no run may begin there.

use lennard_core::{DVec3, PeriodicBox, SpeciesTable};
use lennard_integrators::Response;
use lennard_scene::Scene;

use crate::EngineError;
use crate::close_pairs::{Sizes, closest_pair};
use crate::starting_molecules::Origin;

/// Start positions nearer than this (σ) are refused: U(0.5 σ) = 16,128 ε would blow any step up.
pub const SMALLEST_START_DISTANCE: f64 = 0.5;

/// Springs of contacts may overlap by this share of their length at the start, where half of it ends a run.
const DEEPEST_AT_START: f64 = 0.25;
/// Hard bodies overlap where they are nearer than this share of their contact distance.
const HARD: f64 = 1.0 - 1e-9;

/// Refuses positions at which pair forces would blow any step up.
///
/// # Errors
/// [`EngineError::Scene`] with the closest pair.
pub(crate) fn pairs(
    scene: &Scene,
    origin: &Origin<'_>,
    cell: &PeriodicBox,
    positions: &[DVec3],
    species: &SpeciesTable,
) -> Result<(), EngineError> {
    if scene.longest_cutoff() == 0.0 {
        return Ok(());
    }
    let exclusions = scene.molecules().exclusions();
    let sizes = Sizes::of(scene, species);
    let closest = closest_pair(cell, positions, &exclusions, &sizes, SMALLEST_START_DISTANCE);
    let Some(pair) = closest else {
        return Ok(());
    };
    let found = format!(
        "particles {} and {} of {} at a distance of {:.4} σ (counted from 1)",
        pair.i + 1,
        pair.j + 1,
        origin.name,
        pair.distance
    );
    let allowed = format!(
        "no pair nearer than {} σ",
        (SMALLEST_START_DISTANCE * pair.sigma * 1e4).round() / 1e4
    );
    Err(scene.source.invalid(origin.key, found, allowed).into())
}

/// Refuses bodies that overlap by more than contacts bear.
///
/// # Errors
/// [`EngineError::Scene`] with the closest pair.
pub(crate) fn contacts(
    scene: &Scene,
    key: &str,
    cell: &PeriodicBox,
    positions: &[DVec3],
    species: &SpeciesTable,
) -> Result<(), EngineError> {
    let Some(table) = &scene.contact else {
        return Ok(());
    };
    let (share, what) = match table.options.response() {
        Response::Spring(_) => (1.0 - DEEPEST_AT_START, "soft bodies overlap by a quarter at most"),
        Response::Impact { .. } => (HARD, "hard bodies do not overlap"),
        Response::Unilateral(_) => {
            (HARD, "bodies of unilateral contacts do not overlap at the start")
        }
    };
    let exclusions = scene.molecules().exclusions();
    let sizes = Sizes::of(scene, species);
    let within = share * table.diameter;
    let Some(pair) = closest_pair(cell, positions, &exclusions, &sizes, within) else {
        return Ok(());
    };
    let found = format!(
        "particles {} and {} at a distance of {:.6} σ, and they touch at {:.6} σ (counted from 1)",
        pair.i + 1,
        pair.j + 1,
        pair.distance,
        table.diameter * pair.sigma
    );
    Err(scene.source.invalid(key, found, format!("positions apart: {what}")).into())
}
