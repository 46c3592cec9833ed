//! A start from a file, or from a configuration in memory in its place.

use std::path::Path;

use lennard_core::{DVec3, PeriodicBox, State};
use lennard_io::{
    Beside, FoundSpecies, Frame, FrameStyle, LARGEST, StartConfiguration, WriteError,
};
use lennard_scene::{Arrangement, Geometry, Scene};

use crate::confinement::Confinement;
use crate::error::StartError;
use crate::files::style;
use crate::start::value::{Origin, Start};
use crate::start::velocities::remark_on_drift;
use crate::start::{check, molecules, species};
use crate::{EngineError, Simulation};

/// The start that the scene's file has, or that is `given` in its place.
///
/// # Panics
/// Where the scene names no file.
pub(super) fn start(
    scene: &Scene,
    given: Option<StartConfiguration>,
) -> Result<Start, EngineError> {
    let Arrangement::File { path, geometry, units } = &scene.system.start else {
        unreachable!("other starts have a placement");
    };
    let refuse = |key: &str, found: String, allowed: String| -> EngineError {
        scene.invalid(key, found, allowed).into()
    };
    let mut read = match given {
        Some(given) => given,
        None => {
            let own = match geometry {
                Some(Geometry::Box(sides)) => PeriodicBox::new(DVec3::from_array(*sides))
                    .map(Some)
                    .map_err(|e| scene.invalid("system.box", e, "finite positive lengths"))?,
                Some(Geometry::Density(_)) | None => None,
            };
            let read =
                lennard_io::read_configuration_in(path, Beside { cell: own, units: *units })?;
            if let Some(own) = own.filter(|own| !lennard_io::is_same_box(own, &read.cell)) {
                let [own, other] = [&own, &read.cell].map(|cell| cell.lengths().to_array());
                let found = format!("{own:?}, where {} has {other:?}", path.display());
                let allowed = "the box of the file, or no `box` at all".to_owned();
                return Err(refuse("system.box", found, allowed));
            }
            read
        }
    };
    let (frames, n) = (read.frames, read.positions.len());
    let file = path.display();
    let origin = Origin::given("start.file", &file);
    scene.held_are_among(n)?;
    scene.contact_fits(&read.cell)?;
    if let Some(topology) = scene.molecules().topology() {
        let sites = topology.sites();
        if !n.is_multiple_of(sites) {
            let found = format!("{n} particles in {file}");
            return Err(refuse(
                origin.key,
                found,
                format!("a multiple of molecule.sites = {sites}"),
            ));
        }
        molecules::unfold(&read.cell, topology, &mut read.positions);
    }
    let species = species::of_file(scene, path, &read.species, n)?;
    let mass = |i: usize| species.species(species.of(i)).mass;
    read.take_momenta(mass)
        .map_err(|(found, allowed)| refuse(origin.key, format!("{found} of {file}"), allowed))?;
    let StartConfiguration { cell, positions, velocities, .. } = read;
    let start = Start { cell, positions, velocities, species, relax: false, remarks: Vec::new() };
    let mut start = check::checked(scene, &origin, start)?;
    if frames > 1 {
        start.remarks.push(format!("the start is frame {frames} of {frames} of {file}"));
    }
    let drift = start.velocities.as_deref().and_then(|velocities| {
        let (system, _) = Confinement::with_system(scene, &cell, start.species.clone());
        remark_on_drift(&system, velocities, &origin.name)
    });
    start.remarks.extend(drift);
    Ok(start)
}

/// A start from arrays: box sides and unwrapped positions in σ, velocities in σ/τ. Without velocities they are drawn for the
/// temperature of the scene.
///
/// # Errors
/// [`StartError`] where lengths differ, a number is out of bounds, or the sides make no box.
pub fn start_from_arrays(
    sides: DVec3,
    positions: Vec<DVec3>,
    velocities: Option<Vec<DVec3>>,
) -> Result<StartConfiguration, StartError> {
    let given = velocities.as_ref().map_or(positions.len(), Vec::len);
    if given != positions.len() {
        return Err(StartError::OneVelocityEach);
    }
    let mut all = positions.iter().chain(velocities.iter().flatten());
    if !all.all(|v| v.abs().cmple(DVec3::splat(LARGEST)).all()) {
        return Err(StartError::OutOfBounds);
    }
    Ok(StartConfiguration {
        cell: PeriodicBox::new(sides)?,
        positions,
        velocities,
        momenta: None,
        species: FoundSpecies::default(),
        step: None,
        time: None,
        frames: 1,
    })
}

/// Writes a start that came from memory as a file that a scene can name, to the bit.
///
/// # Errors
/// [`WriteError`] where it cannot be written.
pub fn write_start(
    path: &Path,
    simulation: &Simulation,
    start: &StartConfiguration,
) -> Result<(), WriteError> {
    let n = start.positions.len();
    let velocities = start.velocities.clone();
    let style = FrameStyle {
        velocities: velocities.is_some(),
        forces: false,
        wrapped: false,
        length_scale: 1.0,
        ..style(simulation)
    };
    let state = State::new(
        start.cell,
        start.positions.clone(),
        velocities.unwrap_or_else(|| vec![DVec3::ZERO; n]),
    );
    let frame = Frame { state: &state, extra: &[] };
    lennard_io::write_frame(path, &style, &frame)
}
