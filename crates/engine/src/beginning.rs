//! Where the particles are before the first step: on a lattice, at random, or as a file says.

use std::path::Path;

use lennard_core::random::Streams;
use lennard_core::{DVec3, PeriodicBox, SpeciesTable};
use lennard_io::{Beside, StartConfiguration};
use lennard_scene::{Geometry, Placement, Scene, Start};

use crate::EngineError;
use crate::confinement::{Confinement, place_between_walls};
use crate::starting_molecules::Origin;
use crate::{
    initial, overlaps, room, species, starting_crystal, starting_molecules, starting_slab,
};

/// Where the particles are, and how fast, before the first step.
pub struct Beginning {
    /// The box.
    pub cell: PeriodicBox,
    /// Positions, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, if the start has any.
    pub velocities: Option<Vec<DVec3>>,
    /// The species of the particles.
    pub species: SpeciesTable,
    /// Whether the positions must be relaxed first.
    pub relax: bool,
}

/// Places the particles as the scene says.
///
/// # Errors
/// [`EngineError`] where a configuration cannot be read, does not fit the box, or overlaps.
pub fn begin(scene: &Scene) -> Result<Beginning, EngineError> {
    Ok(begin_with_remarks(scene)?.0)
}

/// The same with what is to be known of it: which frame of a file it is, and what its velocities lose.
pub(crate) fn begin_with_remarks(scene: &Scene) -> Result<(Beginning, Vec<String>), EngineError> {
    if let Some((n, cell)) = size(scene)? {
        room::is_there(scene, &cell, n)?;
    }
    match &scene.system.start {
        Start::Lattice { lattice, n_atoms, .. } => {
            let placement = scene.placement()?.expect("a lattice start has a placement");
            let cell = placement.cell;
            let Some(lattice) = lattice else {
                let filled = PeriodicBox::new(placement.filled).map_err(|e| {
                    scene.source.invalid("system.box", e, "finite positive lengths")
                })?;
                let streams = Streams::new(scene.system.seed);
                let points = initial::random_points(&filled, *n_atoms, streams)
                    .ok_or_else(|| initial::too_dense(scene, "system.density"))?;
                let positions = points.into_iter().map(|r| r + placement.corner).collect();
                let beginning = Beginning {
                    cell,
                    positions,
                    velocities: None,
                    species: species::mixed(scene, *n_atoms)?,
                    relax: true,
                };
                return Ok((beginning, Vec::new()));
            };
            let cells = placement.cells.expect("a lattice has cells");
            let centers =
                initial::lattice_sites(placement.corner, placement.filled, cells, lattice.basis());
            let mut positions = starting_molecules::on_a_lattice(scene, &cell, centers)?;
            if scene.molecule.is_some() {
                place_between_walls(scene, &cell, &mut positions)?;
            }
            Ok((placed(scene, cell, positions)?, Vec::new()))
        }
        Start::Slab(slab) => {
            let placement = scene.placement()?.expect("a slab has a placement");
            let positions = starting_slab::positions(scene, slab, &placement)?;
            Ok((placed(scene, placement.cell, positions)?, Vec::new()))
        }
        Start::HalfCrystal(start) => {
            let placement = scene.placement()?.expect("a half crystal has a placement");
            let positions = starting_crystal::positions(scene, start, &placement)?;
            let beginning = Beginning {
                // The liquid is at random.
                relax: true,
                ..placed(scene, placement.cell, positions)?
            };
            Ok((beginning, Vec::new()))
        }
        Start::Listed { positions, velocities, .. } => {
            let placement = scene.placement()?.expect("listed particles have a box");
            let beginning = as_listed(scene, placement, positions, velocities.clone())?;
            Ok((beginning, Vec::new()))
        }
        Start::File { path, geometry, units } => {
            let given = match geometry {
                Some(Geometry::Box(sides)) => {
                    Some(PeriodicBox::new(DVec3::from_array(*sides)).map_err(|e| {
                        scene.source.invalid("system.box", e, "finite positive lengths")
                    })?)
                }
                Some(Geometry::Density(_)) | None => None,
            };
            // Read without the scene's box first: where both name one and they differ, the scene is to blame.
            let in_box = |cell| {
                let beside = Beside { cell, units: *units };
                lennard_io::read_configuration_in(path, beside)
            };
            let read = match in_box(None) {
                Err(_) if given.is_some() => in_box(given)?,
                read => read?,
            };
            begin_at(scene, path, read, given)
        }
    }
}

/// The start from particles in their places, with species mixed at random.
fn placed(
    scene: &Scene,
    cell: PeriodicBox,
    positions: Vec<DVec3>,
) -> Result<Beginning, EngineError> {
    let species = species::mixed(scene, positions.len())?;
    let relax = species::overlap(scene, &cell, &positions, &species);
    if !scene.system.held.is_empty() {
        let origin = Origin { key: "system.held", name: "the start".to_owned() };
        starting_molecules::check(scene, &origin, &cell, &positions)?;
    }
    overlaps::contacts(scene, "system", &cell, &positions, &species)?;
    if relax && !scene.walls.is_empty() {
        return Err(scene
            .source
            .invalid(
                "system.density",
                "a lattice between walls that is too narrow for the largest species",
                "a lower density, or a start from a file: relaxation knows no walls",
            )
            .into());
    }
    Ok(Beginning { cell, positions, velocities: None, species, relax })
}

/// The start from a configuration that was read, in the box that the scene gives, if it gives one.
fn begin_at(
    scene: &Scene,
    path: &Path,
    read: StartConfiguration,
    given: Option<PeriodicBox>,
) -> Result<(Beginning, Vec<String>), EngineError> {
    let frames = read.frames;
    let mut beginning = from_configuration(scene, path, read, given)?;
    place_between_walls(scene, &beginning.cell, &mut beginning.positions)?;
    let remarks = remarks(scene, path, frames, &beginning);
    Ok((beginning, remarks))
}

/// The start from a configuration in memory, as if the scene's file held it.
pub(crate) fn begin_in_memory(
    scene: &Scene,
    start: StartConfiguration,
) -> Result<(Beginning, Vec<String>), EngineError> {
    match &scene.system.start {
        Start::File { path, .. } => begin_at(scene, path, start, None),
        Start::Lattice { .. } | Start::Slab(_) | Start::HalfCrystal(_) | Start::Listed { .. } => {
            let found = match scene.system.start {
                Start::Listed { .. } => "positions beside those that the scene lists",
                _ => "positions beside a start that the scene makes",
            };
            let allowed = "\"file\"";
            Err(scene.source.invalid("start.kind", found, allowed).into())
        }
    }
}

/// Number of particles and their density in σ⁻³, as the scene's start has them; reads the file of a start from one.
///
/// # Errors
/// [`EngineError`] where the start cannot be made.
pub fn size_and_density(scene: &Scene) -> Result<(usize, f64), EngineError> {
    let (n, cell) = match size(scene)? {
        Some(size) => size,
        None => {
            let beginning = begin(scene)?;
            (beginning.positions.len(), beginning.cell)
        }
    };
    Ok((n, n as f64 / cell.volume()))
}

/// Number of particles and their box, where the scene alone says them.
fn size(scene: &Scene) -> Result<Option<(usize, PeriodicBox)>, EngineError> {
    let cell = scene.placement()?.map(|placement| placement.cell);
    Ok(scene.n_particles().zip(cell))
}

/// What is to be known of a start that was read from a file.
fn remarks(scene: &Scene, path: &Path, frames: u64, beginning: &Beginning) -> Vec<String> {
    let file = path.display();
    let frame = (frames > 1).then(|| format!("the start is frame {frames} of {frames} of {file}"));
    let drift = beginning.velocities.as_deref().and_then(|velocities| {
        let species = beginning.species.clone();
        let (system, _) = Confinement::with_system(scene, &beginning.cell, species);
        initial::Drift::of(&system, velocities).map(|drift| drift.in_words(&file.to_string()))
    });
    frame.into_iter().chain(drift).collect()
}

/// The start of particles that the scene lists. Along walled axes their positions count from the lower wall.
fn as_listed(
    scene: &Scene,
    placement: Placement,
    positions: &[DVec3],
    velocities: Option<Vec<DVec3>>,
) -> Result<Beginning, EngineError> {
    let cell = placement.cell;
    let mut positions: Vec<DVec3> = positions.iter().map(|r| *r + placement.corner).collect();
    let origin = Origin { key: "start.positions", name: "the scene".to_owned() };
    starting_molecules::check(scene, &origin, &cell, &positions)?;
    let species = scene.species_in_order(&scene.counts(positions.len())?);
    overlaps::pairs(scene, &origin, &cell, &positions, &species)?;
    overlaps::contacts(scene, origin.key, &cell, &positions, &species)?;
    place_between_walls(scene, &cell, &mut positions)?;
    Ok(Beginning { cell, positions, velocities, species, relax: false })
}

fn from_configuration(
    scene: &Scene,
    path: &Path,
    read: StartConfiguration,
    given: Option<PeriodicBox>,
) -> Result<Beginning, EngineError> {
    if let Some(given) = given
        && !lennard_io::is_same_box(&given, &read.cell)
    {
        let sides = given.lengths().to_array();
        let found =
            format!("{sides:?}, where {} has {:?}", path.display(), read.cell.lengths().to_array());
        return Err(scene
            .source
            .invalid("system.box", found, "the box of the file, or no `box` at all")
            .into());
    }
    let mut read = read;
    let origin = Origin { key: "start.file", name: path.display().to_string() };
    scene.held_are_among(read.positions.len())?;
    scene.contact_fits(&read.cell)?;
    starting_molecules::unfold(scene, path, &read.cell, &mut read.positions)?;
    starting_molecules::check(scene, &origin, &read.cell, &read.positions)?;
    let species = species::of_file(scene, path, &read.species, read.positions.len())?;
    let mass = |i: usize| species.species(species.of(i)).mass;
    read.take_momenta(mass).map_err(|(found, allowed)| {
        let found = format!("{found} of {}", path.display());
        scene.source.invalid(origin.key, found, allowed)
    })?;
    overlaps::pairs(scene, &origin, &read.cell, &read.positions, &species)?;
    overlaps::contacts(scene, origin.key, &read.cell, &read.positions, &species)?;
    Ok(Beginning {
        cell: read.cell,
        positions: read.positions,
        velocities: read.velocities,
        species,
        relax: false,
    })
}
