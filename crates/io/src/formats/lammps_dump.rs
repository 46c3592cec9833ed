//! The text of LAMMPS' `dump custom`, in its units `lj`.
//!
//! Source: LAMMPS documentation, "dump command"; the line `ITEM: UNITS` is left out, since some readers refuse it.

use std::path::Path;

use super::FormatSpec;
use super::lines::{push_field, push_lines, push_vector};
use crate::formats::lines::{push_float, push_integer};
use crate::frame::{NotFinite, finite};
use crate::{Frame, FrameStyle, WriteError};

pub(super) const SPEC: FormatSpec = FormatSpec {
    file: "trajectory.lammpstrj",
    summary: "LAMMPS' dump as text: every digit, box, velocities, forces, image flags; no times and no energies.",
    readers: "MDAnalysis (with box and velocities), mdtraj (with box), OVITO, and ASE (which takes velocities for Å/ps)",
    holds_vectors: true,
    names_scale: false,
    holds_ase: false,
    limits: None,
    nanometers: 0.1,
    ends_with_line: true,
    push,
};

fn push(
    to: &mut Vec<u8>,
    path: &Path,
    style: &FrameStyle,
    frame: &Frame<'_>,
) -> Result<Option<f64>, WriteError> {
    push_header(to, style, frame);
    let vectors = 1 + usize::from(style.velocities) + usize::from(style.forces);
    push_lines(to, path, frame.state.len(), vectors, |text, i| {
        push_particle(text, style, frame, i)
    })?;
    Ok(None)
}

fn push_header(to: &mut Vec<u8>, style: &FrameStyle, frame: &Frame<'_>) {
    to.extend_from_slice(b"ITEM: TIMESTEP\n");
    push_integer(to, frame.state.step);
    to.extend_from_slice(b"\nITEM: NUMBER OF ATOMS\n");
    push_integer(to, frame.state.len());
    to.extend_from_slice(b"\nITEM: BOX BOUNDS pp pp pp\n");
    for side in frame.state.cell.lengths().to_array() {
        to.extend_from_slice(b"0.0 ");
        push_float(to, side);
        to.push(b'\n');
    }
    to.extend_from_slice(b"ITEM: ATOMS id type element");
    if style.sites_per_molecule > 1 {
        to.extend_from_slice(b" mol");
    }
    if style.has_masses() {
        to.extend_from_slice(b" mass");
    }
    to.extend_from_slice(if style.wrapped { b" x y z ix iy iz" } else { b" xu yu zu" });
    if style.velocities {
        to.extend_from_slice(b" vx vy vz");
    }
    if style.forces {
        to.extend_from_slice(b" fx fy fz");
    }
    to.push(b'\n');
}

fn push_particle(
    to: &mut Vec<u8>,
    style: &FrameStyle,
    frame: &Frame<'_>,
    i: usize,
) -> Result<(), NotFinite> {
    let state = frame.state;
    let (position, image) = style.place(&state.cell, &state.positions, i)?;
    let species = style.species_of(i);
    push_integer(to, i + 1);
    push_field(to, style.species.of(i) + 1);
    to.push(b' ');
    to.extend_from_slice(species.element.as_bytes());
    if style.sites_per_molecule > 1 {
        push_field(to, i / style.sites_per_molecule + 1);
    }
    if style.has_masses() {
        to.push(b' ');
        push_float(to, species.mass);
    }
    push_vector(to, position);
    for flag in image.into_iter().flat_map(|image| image.to_array()) {
        push_field(to, flag);
    }
    if style.velocities {
        push_vector(to, finite("velocity", i, frame.state.velocities[i])?);
    }
    if style.forces {
        push_vector(to, finite("force", i, frame.state.forces[i])?);
    }
    to.push(b'\n');
    Ok(())
}
