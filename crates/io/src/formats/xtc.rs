//! The compressed positions of GROMACS.
//!
//! Source: GROMACS reference manual, "xtc file format". One unit of length is 1 nm for readers; here it is σ·`length_scale`.

mod compression;
mod reader;

use std::ops::Range;
use std::path::Path;

use glam::{DVec3, Mat3};

use super::{FormatSpec, Limits};
use crate::frame::{NotFinite, unwritable};
use crate::{Frame, FrameStyle, WriteError};

pub(crate) use reader::XtcReader;

pub(super) const SPEC: FormatSpec = FormatSpec {
    file: "trajectory.xtc",
    summary: "GROMACS' compressed positions: small files, rounded positions and box; no velocities, forces or energies.",
    readers: "mdtraj, MDAnalysis and OVITO, with `topology.gro` for the names",
    holds_vectors: false,
    names_scale: true,
    holds_ase: false,
    limits: Some(&LIMITS),
    nanometers: 1.0,
    by_parts: false,
    ends_with_line: false,
    push,
};

/// The magic number of files, and of files whose lengths have 64 bits.
const MAGIC: u32 = 1995;
const LONG_MAGIC: u32 = 2023;
/// More particles may need more than 32 bits for the length of a frame.
const MOST_WITHOUT_LONG: usize = 298_261_617;
/// The positions of so few particles are in single precision, and no multiples of the precision.
const MOST_UNCOMPRESSED: usize = 9;
/// Added to a number below 2³¹ it leaves the nearest whole number in the lowest bits, ties to even.
const TO_WHOLE: f64 = 6_755_399_441_055_744.0;

/// Steps have 31 bits. Single precision has every whole number up to 2²⁴; beyond, positions would be worse than the
/// precision says.
static LIMITS: Limits = Limits { last_step: i32::MAX as u64, multiples: 16_777_216.0 };

fn push(
    to: &mut Vec<u8>,
    path: &Path,
    style: &FrameStyle,
    frame: &Frame<'_>,
    _: Range<usize>,
) -> Result<Option<f64>, WriteError> {
    let state = frame.state;
    let step = u32::try_from(state.step)
        .ok()
        .filter(|step| u64::from(*step) <= LIMITS.last_step)
        .ok_or_else(|| {
        let found = state.step.to_string();
        unwritable(path, "step", found, format!("at most {} in XTC", LIMITS.last_step))
    })?;
    let places: Result<Vec<DVec3>, NotFinite> =
        (0..state.len()).map(|i| Ok(style.place(&state.cell, &state.positions, i)?.0)).collect();
    let places = places.map_err(|bad| bad.in_file(path))?;
    let reach = places.iter().fold(DVec3::ZERO, |far, r| far.max(r.abs()));
    let kept = LIMITS.precision_for(style.precision, reach.max_element());
    let long = state.len() > MOST_WITHOUT_LONG;
    let particles = (state.len() as u32).to_be_bytes();
    to.extend(if long { LONG_MAGIC } else { MAGIC }.to_be_bytes());
    to.extend(particles);
    to.extend(step.to_be_bytes());
    to.extend((state.time as f32).to_be_bytes());
    let sides = (state.cell.lengths() * style.length_scale).as_vec3();
    for number in Mat3::from_diagonal(sides).to_cols_array() {
        to.extend(number.to_be_bytes());
    }
    to.extend(particles);
    if state.len() > MOST_UNCOMPRESSED {
        let precision = (kept / style.length_scale) as f32;
        to.extend(precision.to_be_bytes());
        // Readers divide by the precision as the file has it.
        let scale = style.length_scale * f64::from(precision);
        let multiples: Vec<[i32; 3]> = (places.iter())
            .map(|r| (*r * scale + TO_WHOLE).to_array().map(|x| x.to_bits() as i32))
            .collect();
        compression::push(to, &multiples, long);
    } else {
        for position in places {
            for x in (position * style.length_scale).as_vec3().to_array() {
                to.extend(x.to_be_bytes());
            }
        }
    }
    Ok(Some(kept))
}
