//! Extended XYZ: one header line and one line a particle.

use std::ops::Range;
use std::path::Path;

use super::FormatSpec;
use super::columns::{Column, Layout};
use super::lines::{push_float, push_integer};
use crate::frame::unwritable;
use crate::{Frame, FrameStyle, WriteError};

pub(super) const SPEC: FormatSpec = FormatSpec {
    file: "trajectory.xyz",
    summary: "Extended XYZ: text with every digit, box, velocities, image flags, energies.",
    readers: "ASE (all of it), OVITO (all of it), mdtraj and MDAnalysis (positions alone)",
    holds_vectors: true,
    names_scale: true,
    holds_ase: true,
    by_parts: true,
    limits: None,
    nanometers: 0.1,
    ends_with_line: true,
    push,
};

/// Columns with their names, types and widths.
const COLUMNS: &[(Column, &str)] = &[
    (Column::Element, ":species:S:1"),
    (Column::Position, ":pos:R:3"),
    (Column::Velocity, ":velo:R:3"),
    (Column::Force, ":forces:R:3"),
    (Column::Image, ":map_shift:I:3"),
    (Column::Molecule, ":molecule:I:1"),
    (Column::Mass, ":masses:R:1"),
    (Column::Momentum, ":momenta:R:3"),
];

/// Keys of the header that the dialect itself uses or that readers take for something else.
const TAKEN_KEYS: [&str; 12] = [
    "species_names",
    "Lattice",
    "Properties",
    "pbc",
    "Time",
    "Step",
    "units",
    "length_scale",
    "energy",
    "free_energy",
    "stress",
    "virial",
];

fn is_plain_key(key: &str) -> bool {
    key.starts_with(|c: char| c.is_ascii_alphabetic())
        && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && !TAKEN_KEYS.contains(&key)
}

/// The key under which headers hold the potential energy of the whole system.
const POTENTIAL_ENERGY: &str = "total_potential_energy";

/// Appends the frame to `to`; `path` is for messages.
pub(super) fn push(
    to: &mut Vec<u8>,
    path: &Path,
    style: &FrameStyle,
    frame: &Frame<'_>,
    particles: Range<usize>,
) -> Result<Option<f64>, WriteError> {
    let layout = Layout::new(style, style.length_scale, COLUMNS);
    if style.begins() && particles.start == 0 {
        push_header(to, path, style, &layout.names, frame)?;
    }
    layout.push_lines_of(to, path, frame.state, particles)?;
    Ok(None)
}

fn push_header(
    to: &mut Vec<u8>,
    path: &Path,
    style: &FrameStyle,
    columns: &str,
    frame: &Frame<'_>,
) -> Result<(), WriteError> {
    push_integer(to, style.all(frame.state.len()));
    to.extend_from_slice(b"\nLattice=\"");
    let sides = frame.state.cell.lengths() * style.length_scale;
    push_float(to, sides.x);
    to.extend_from_slice(b" 0.0 0.0 0.0 ");
    push_float(to, sides.y);
    to.extend_from_slice(b" 0.0 0.0 0.0 ");
    push_float(to, sides.z);
    // Names stand between colons.
    to.extend_from_slice(format!("\" Properties={}", &columns[1..]).as_bytes());
    to.extend_from_slice(b" pbc=\"T T T\"");
    let number = |to: &mut Vec<u8>, key: &str, value: f64| {
        if !value.is_finite() {
            let found = format!("{key}={value}");
            return Err(unwritable(path, "number in the header", found, "a finite number"));
        }
        to.push(b' ');
        to.extend_from_slice(key.as_bytes());
        to.push(b'=');
        push_float(to, value);
        Ok(())
    };
    number(to, "Time", frame.state.time)?;
    to.extend_from_slice(b" Step=");
    push_integer(to, frame.state.step);
    for &(key, value) in frame.extra {
        if !is_plain_key(key) {
            let found = format!("`{}`", key.escape_debug());
            let allowed = format!("letters, digits and _, but none of {}", TAKEN_KEYS.join(", "));
            return Err(unwritable(path, "key in the header", found, allowed));
        }
        number(to, key, value)?;
        if style.for_ase && key == POTENTIAL_ENERGY {
            number(to, "energy", value)?;
        }
    }
    if style.species.is_mixture() {
        let all = style.species.all().iter();
        let names: Vec<String> = all.map(|s| format!("{}={}", s.element, s.name)).collect();
        to.extend_from_slice(format!(" species_names=\"{}\"", names.join(" ")).as_bytes());
    }
    to.extend_from_slice(b" units=lj");
    if style.length_scale != 1.0 {
        number(to, "length_scale", style.length_scale)?;
    }
    to.push(b'\n');
    Ok(())
}
