//! The compressed positions of GROMACS, by the library molly.
//!
//! Source: GROMACS reference manual, "xtc file format". One unit of length is 1 nm for readers; here it is σ·`length_scale`.

use std::path::Path;

use molly::{Magic, XTC_1995_MAX_NATOMS, XTCWriter};

use super::{FormatSpec, Limits};
use crate::frame::unwritable;
use crate::{Frame, FrameStyle, WriteError};

pub(super) const SPEC: FormatSpec = FormatSpec {
    file: "trajectory.xtc",
    summary: "GROMACS' compressed positions: small files, rounded positions and box; no velocities, forces or energies.",
    readers: "mdtraj, MDAnalysis and OVITO, with `topology.gro` for the names",
    holds_vectors: false,
    names_scale: true,
    holds_ase: false,
    limits: Some(&LIMITS),
    nanometers: 1.0,
    ends_with_line: false,
    push,
};

/// Steps have 31 bits. Single precision has every whole number up to 2²⁴; beyond, positions would be worse than the
/// precision says.
static LIMITS: Limits = Limits {
    last_step: i32::MAX as u64,
    multiples: 16_777_216.0,
};

fn push(
    to: &mut Vec<u8>,
    path: &Path,
    style: &FrameStyle,
    frame: &Frame<'_>,
) -> Result<(), WriteError> {
    let state = frame.state;
    let step = u32::try_from(state.step)
        .ok()
        .filter(|step| u64::from(*step) <= LIMITS.last_step)
        .ok_or_else(|| {
            let found = state.step.to_string();
            unwritable(
                path,
                "step",
                found,
                format!("at most {} in XTC", LIMITS.last_step),
            )
        })?;
    let mut positions = Vec::with_capacity(state.len());
    for i in 0..state.len() {
        let (position, _) = style.place(frame, i).map_err(|bad| bad.in_file(path))?;
        if position.abs().max_element() * style.precision >= LIMITS.multiples {
            return Err(unwritable(
                path,
                "position",
                format!(
                    "{position} of particle {i}, at precision {}",
                    style.precision
                ),
                format!("coordinates below {}/precision in XTC", LIMITS.multiples),
            ));
        }
        positions.push((position * style.length_scale).as_vec3().to_array());
    }
    let sides = (state.cell.lengths() * style.length_scale).as_vec3();
    let vectors = [sides.x, 0.0, 0.0, 0.0, sides.y, 0.0, 0.0, 0.0, sides.z];
    let magic = if state.len() > XTC_1995_MAX_NATOMS {
        Magic::Xtc2023
    } else {
        Magic::Xtc1995
    };
    let precision = (style.precision / style.length_scale) as f32;
    XTCWriter::new_with_magic(to, magic)
        .write_frame_parts(
            step,
            state.time as f32,
            vectors,
            positions.iter(),
            precision,
        )
        .map_err(|e| WriteError::io(path, "compress", e))
}
