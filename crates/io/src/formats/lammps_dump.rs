//! The text of LAMMPS' `dump custom`, in its units `lj`.
//!
//! Source: LAMMPS documentation, "dump command"; the line `ITEM: UNITS` is left out, since some readers refuse it.

use std::ops::Range;
use std::path::Path;

use super::FormatSpec;
use super::columns::{Column, Layout};
use super::lines::{push_float, push_integer};
use crate::{Frame, FrameStyle, WriteError};

pub(super) const SPEC: FormatSpec = FormatSpec {
    file: "trajectory.lammpstrj",
    summary: "LAMMPS' dump as text: every digit, box, velocities, forces, image flags; no times and no energies.",
    readers: "MDAnalysis (with box and velocities), mdtraj (with box), OVITO, and ASE (which takes velocities for Å/ps)",
    holds_vectors: true,
    names_scale: false,
    by_parts: true,
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
    particles: Range<usize>,
) -> Result<Option<f64>, WriteError> {
    let positions = if style.wrapped { " x y z" } else { " xu yu zu" };
    let layout = Layout::new(
        style,
        1.0,
        &[
            (Column::Id, " id"),
            (Column::Type, " type"),
            (Column::Element, " element"),
            (Column::Molecule, " mol"),
            (Column::Mass, " mass"),
            (Column::Position, positions),
            (Column::Image, " ix iy iz"),
            (Column::Velocity, " vx vy vz"),
            (Column::Force, " fx fy fz"),
        ],
    );
    if style.begins() && particles.start == 0 {
        to.extend_from_slice(b"ITEM: TIMESTEP\n");
        push_integer(to, frame.state.step);
        to.extend_from_slice(b"\nITEM: NUMBER OF ATOMS\n");
        push_integer(to, style.all(frame.state.len()));
        to.extend_from_slice(b"\nITEM: BOX BOUNDS pp pp pp\n");
        for side in frame.state.cell.lengths().to_array() {
            to.extend_from_slice(b"0.0 ");
            push_float(to, side);
            to.push(b'\n');
        }
        to.extend_from_slice(format!("ITEM: ATOMS{}\n", layout.names).as_bytes());
    }
    layout.push_lines_of(to, path, frame.state, particles)?;
    Ok(None)
}
