//! Extended XYZ: one header line and one line a particle.

use std::path::Path;

use super::FormatSpec;
use super::lines::{push_field, push_lines, push_vector};
use crate::formats::lines::{push_float, push_integer};
use crate::frame::{NotFinite, finite, unwritable};
use crate::{Frame, FrameStyle, WriteError};

pub(super) const SPEC: FormatSpec = FormatSpec {
    file: "trajectory.xyz",
    summary: "Extended XYZ: text with every digit, box, velocities, image flags, energies.",
    readers: "ASE (all of it), OVITO (all of it), mdtraj and MDAnalysis (positions alone)",
    holds_vectors: true,
    names_scale: true,
    holds_ase: true,
    limits: None,
    nanometers: 0.1,
    ends_with_line: true,
    push,
};

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
) -> Result<Option<f64>, WriteError> {
    push_header(to, path, style, frame)?;
    let vectors = [style.velocities, style.forces, style.for_ase];
    let vectors = 1 + vectors.into_iter().filter(|there| *there).count();
    push_lines(to, path, frame.state.len(), vectors, |text, i| {
        push_particle(text, style, frame, i)
    })?;
    Ok(None)
}

fn push_header(
    to: &mut Vec<u8>,
    path: &Path,
    style: &FrameStyle,
    frame: &Frame<'_>,
) -> Result<(), WriteError> {
    push_integer(to, frame.state.len());
    to.extend_from_slice(b"\nLattice=\"");
    let sides = frame.state.cell.lengths() * style.length_scale;
    push_float(to, sides.x);
    to.extend_from_slice(b" 0.0 0.0 0.0 ");
    push_float(to, sides.y);
    to.extend_from_slice(b" 0.0 0.0 0.0 ");
    push_float(to, sides.z);
    to.extend_from_slice(b"\" Properties=species:S:1:pos:R:3");
    if style.velocities {
        to.extend_from_slice(b":velo:R:3");
    }
    if style.forces {
        to.extend_from_slice(b":forces:R:3");
    }
    if style.wrapped {
        to.extend_from_slice(b":map_shift:I:3");
    }
    if style.sites_per_molecule > 1 {
        to.extend_from_slice(b":molecule:I:1");
    }
    if style.has_masses() {
        to.extend_from_slice(b":masses:R:1");
    }
    if style.for_ase {
        to.extend_from_slice(b":momenta:R:3");
    }
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

fn push_particle(
    to: &mut Vec<u8>,
    style: &FrameStyle,
    frame: &Frame<'_>,
    i: usize,
) -> Result<(), NotFinite> {
    let state = frame.state;
    let (written, image) = style.place(&state.cell, &state.positions, i)?;
    let species = style.species_of(i);
    to.extend_from_slice(species.element.as_bytes());
    push_vector(to, finite("position", i, written * style.length_scale)?);
    if style.velocities {
        let velocity = state.velocities[i] * style.length_scale;
        push_vector(to, finite("velocity", i, velocity)?);
    }
    if style.forces {
        let force = state.forces[i] / style.length_scale;
        push_vector(to, finite("force", i, force)?);
    }
    if let Some(image) = image {
        for flag in image.to_array() {
            push_field(to, flag);
        }
    }
    if style.sites_per_molecule > 1 {
        push_field(to, i / style.sites_per_molecule + 1);
    }
    if style.has_masses() {
        to.push(b' ');
        push_float(to, species.mass);
    }
    if style.for_ase {
        let momentum = species.mass * state.velocities[i] * style.length_scale;
        push_vector(to, finite("momentum", i, momentum)?);
    }
    to.push(b'\n');
    Ok(())
}
