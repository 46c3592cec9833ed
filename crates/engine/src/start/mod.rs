//! Where the particles are before the first step: one value, made by each kind of start and checked once.

mod check;
mod file;
mod molecules;
mod places;
mod species;
mod value;
mod velocities;

pub use check::SMALLEST_START_DISTANCE;
pub use file::{start_from_arrays, write_start};
pub use value::Start;
pub use velocities::thermal_velocities;
pub(crate) use velocities::{make_suit, remove_drift};

use lennard_core::{PeriodicBox, Team};
use lennard_io::StartConfiguration;
use lennard_scene::{Arrangement, Placement, Scene};
use value::Origin;

use crate::{EngineError, room};

/// Places the particles as the scene says.
///
/// # Errors
/// [`EngineError`] where a configuration cannot be read, does not fit the box, or overlaps.
pub fn start(scene: &Scene) -> Result<Start, EngineError> {
    start_with(scene, None, None)
}

/// The same, with a configuration in memory in the place of the file that the scene names. On a rank, the start may have the particles
/// alone that the rank keeps.
pub(crate) fn start_with(
    scene: &Scene,
    given: Option<StartConfiguration>,
    team: Option<&Team>,
) -> Result<Start, EngineError> {
    if let Some((n, cell)) = size(scene)? {
        room::is_there(scene, &cell, n, team.map_or(1, Team::ranks))?;
    }
    match (scene.placement()?, given) {
        (None, given) => file::start(scene, given),
        (Some(placement), None) => placed(scene, &placement, team),
        (Some(_), Some(_)) => {
            let found = "positions beside a start that the scene has";
            Err(scene.invalid("start.kind", found, "\"file\"").into())
        }
    }
}

/// The start of particles whose places the scene lists, or that the program places.
fn placed(scene: &Scene, placement: &Placement, team: Option<&Team>) -> Result<Start, EngineError> {
    let cell = placement.cell;
    // Distances of species on a lattice are looked at, whoever keeps the particles.
    let team = team.filter(|_| scene.mixture.is_none());
    let mut origin = Origin { key: "system", name: "the lattice".to_owned(), is_given: false };
    let (mut relax, mut velocities) = (false, None);
    let positions = match &scene.system.start {
        Arrangement::Lattice { lattice: Some(lattice), .. } => {
            let numbers = scene.n_particles().zip(team).map(|(n, team)| team.numbers(n));
            let sites = places::on_lattice(placement, lattice.basis(), numbers);
            if team.is_some() { sites } else { molecules::about(scene, sites) }
        }
        Arrangement::Lattice { lattice: None, n_atoms, .. } => {
            relax = true;
            let Placement { corner, filled, .. } = *placement;
            places::at_random(scene, &cell, (corner, filled), *n_atoms, "system.density")?
        }
        Arrangement::Slab(slab) => places::slab(scene, slab, placement)?,
        Arrangement::HalfCrystal(start) => {
            // The liquid is at random.
            relax = true;
            places::half_crystal(scene, start, placement)?
        }
        Arrangement::Listed { positions, velocities: listed, .. } => {
            origin = Origin::given("start.positions", &"the scene");
            velocities = listed.clone();
            positions.iter().map(|r| *r + placement.corner).collect()
        }
        Arrangement::File { .. } => unreachable!("a file has no placement"),
    };
    let species = match origin.is_given {
        true => scene.species_in_order(&scene.counts(positions.len())?),
        false => species::mixed(scene, scene.n_particles().unwrap_or(positions.len()))?,
    };
    let start = Start { cell, positions, velocities, species, relax, remarks: Vec::new() };
    check::checked(scene, &origin, start)
}

/// Number of particles and their density in σ⁻³, as the scene's start has them; reads the file of a start from one.
///
/// # Errors
/// [`EngineError`] where the start cannot be made.
pub fn size_and_density(scene: &Scene) -> Result<(usize, f64), EngineError> {
    let (n, cell) = match size(scene)? {
        Some(size) => size,
        None => {
            let start = start(scene)?;
            (start.positions.len(), start.cell)
        }
    };
    Ok((n, n as f64 / cell.volume()))
}

/// Number of particles and their box, where the scene alone says them.
fn size(scene: &Scene) -> Result<Option<(usize, PeriodicBox)>, EngineError> {
    let cell = scene.placement()?.map(|placement| placement.cell);
    Ok(scene.n_particles().zip(cell))
}
