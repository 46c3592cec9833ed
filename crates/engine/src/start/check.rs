//! What must hold of every start: bonds, distances of pairs and of bodies, and places between the walls.

use lennard_core::{DVec3, PeriodicBox};
use lennard_integrators::Response;
use lennard_scene::Scene;

use super::molecules;
use super::value::{Origin, Start};
use crate::EngineError;

/// Start positions nearer than this (σ) are refused: U(0.5 σ) = 16,128 ε would blow any step up.
pub const SMALLEST_START_DISTANCE: f64 = 0.5;
/// U(0.8 σ) is 43 ε: nearer sites of molecules on a lattice would heat the fluid beyond use.
const SMALLEST_OF_MOLECULES: f64 = 0.8;
/// Pairs of species on a lattice nearer than this, in units of σ_ab, have the start relaxed: U(0.9 σ) is 6.6 ε.
const SMALLEST_OF_SPECIES: f64 = 0.9;

/// Springs of contacts may overlap by this share of their length at the start, where half of it ends a run.
const DEEPEST_AT_START: f64 = 0.25;
/// Hard bodies overlap where they are nearer than this share of their contact distance.
const HARD: f64 = 1.0 - 1e-9;

/// The start with all that is asked of it.
///
/// # Errors
/// [`EngineError::Scene`] with the first thing that is wrong.
pub(super) fn checked(
    scene: &Scene,
    origin: &Origin,
    mut start: Start,
) -> Result<Start, EngineError> {
    if origin.is_given || !scene.system.held.is_empty() {
        molecules::check(scene, origin, &start)?;
    }
    pairs(scene, origin, &start)?;
    // Places at random are no bodies yet: relaxation takes them apart.
    if !start.relax {
        contacts(scene, origin, &start)?;
        let is_mixed = !origin.is_given && scene.mixture.is_some();
        start.relax = is_mixed && start.closest(scene, SMALLEST_OF_SPECIES).is_some();
    }
    if start.relax && !scene.walls.is_empty() {
        let found = "a lattice between walls that is too narrow for the largest species";
        let allowed = "a lower density, or a start from a file: relaxation knows no walls";
        return Err(scene.invalid("system.density", found, allowed).into());
    }
    place_between_walls(scene, &start.cell, &mut start.positions)?;
    Ok(start)
}

/// Refuses positions at which pair forces would blow any step up. Atoms on a lattice have the distance of the lattice.
fn pairs(scene: &Scene, origin: &Origin, start: &Start) -> Result<(), EngineError> {
    let (key, within, or) = match &scene.molecule {
        _ if scene.longest_cutoff() == 0.0 => return Ok(()),
        _ if origin.is_given => (origin.key, SMALLEST_START_DISTANCE, ""),
        Some(molecule) => (
            molecule.key_of_size(),
            SMALLEST_OF_MOLECULES,
            ": a lower density, shorter bonds, or start.lattice = \"sc\" for chains",
        ),
        None => return Ok(()),
    };
    let Some(pair) = start.closest(scene, within) else {
        return Ok(());
    };
    let found = format!(
        "particles {} and {} of {} at a distance of {:.4} σ (counted from 1)",
        pair.i + 1,
        pair.j + 1,
        origin.name,
        pair.distance
    );
    let least = (within * pair.sigma * 1e4).round() / 1e4;
    let allowed = format!("no pair nearer than {least} σ{or}");
    Err(scene.invalid(key, found, allowed).into())
}

/// Refuses bodies that overlap by more than contacts bear.
fn contacts(scene: &Scene, origin: &Origin, start: &Start) -> Result<(), EngineError> {
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
    let Some(pair) = start.closest(scene, share * table.diameter) else {
        return Ok(());
    };
    let found = format!(
        "particles {} and {} at a distance of {:.6} σ, and they touch at {:.6} σ (counted from 1)",
        pair.i + 1,
        pair.j + 1,
        pair.distance,
        table.diameter * pair.sigma
    );
    Err(scene.invalid(origin.key, found, format!("positions apart: {what}")).into())
}

/// Puts positions into the box along walled axes, and refuses those outside the walls.
fn place_between_walls(
    scene: &Scene,
    cell: &PeriodicBox,
    positions: &mut [DVec3],
) -> Result<(), EngineError> {
    for (i, slit) in scene.slits(cell).into_iter().enumerate() {
        for r in &mut *positions {
            r[slit.axis] = cell.wrap(*r)[slit.axis];
        }
        let is_outside = |r: &DVec3| !(slit.lower..=slit.upper).contains(&r[slit.axis]);
        let outside = positions.iter().filter(|r| is_outside(r)).count();
        let Some(first) = positions.iter().position(is_outside) else {
            continue;
        };
        let axis = scene.walls[i].axis.name();
        return Err(scene.invalid(
                &format!("wall.{i}.thickness"),
                format!(
                    "{outside} particles outside the walls across {axis}, the first is particle {} at {:.4} σ (counted from 1)",
                    first + 1,
                    positions[first][slit.axis]
                ),
                format!(
                    "positions from {:.4} to {:.4} σ: half the thickness from the ends of the box",
                    slit.lower, slit.upper
                ),
            )
            .into());
    }
    Ok(())
}
