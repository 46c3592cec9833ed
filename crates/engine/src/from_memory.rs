//! A start that came from memory, in the place of the file that the scene names.

use std::path::Path;

use lennard_core::{DVec3, State};
use lennard_io::{Frame, FrameStyle, StartConfiguration, WriteError};
use lennard_scene::Scene;

use crate::beginning::begin_in_memory;
use crate::build::prepare_from;
use crate::files::style;
use crate::{EngineError, Simulation};

/// Builds the simulation around a start in memory.
///
/// # Errors
/// As [`crate::prepare`].
pub fn prepare_with(scene: Scene, start: StartConfiguration) -> Result<Simulation, EngineError> {
    let (beginning, remarks) = begin_in_memory(&scene, start)?;
    let mut simulation = prepare_from(scene, beginning)?;
    simulation.remarks.splice(0..0, remarks);
    Ok(simulation)
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
    let frame = Frame {
        state: &state,
        extra: &[],
    };
    lennard_io::write_frame(path, &style, &frame)
}
