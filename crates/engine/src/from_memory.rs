//! The file of a start that came from memory.

use std::path::Path;

use lennard_core::{DVec3, State};
use lennard_io::{Frame, FrameStyle, StartConfiguration, WriteError};

use crate::Simulation;
use crate::files::style;

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
