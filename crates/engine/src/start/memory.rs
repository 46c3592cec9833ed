//! A start that comes from memory, and the file that can stand for it.

use std::path::Path;

use lennard_core::{DVec3, PeriodicBox, State};
use lennard_io::{FoundSpecies, Frame, FrameStyle, LARGEST, StartConfiguration, WriteError};

use crate::Simulation;
use crate::error::StartError;
use crate::files::style;

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
