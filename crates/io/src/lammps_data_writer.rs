//! LAMMPS' data files of atoms, written.
//!
//! Source: LAMMPS documentation, "read_data command".

use std::path::Path;

use lennard_core::{SpeciesTable, State};

use crate::atomic::write_bytes_atomically;
use crate::formats::lines::{push_float, push_integer};
use crate::frame::finite;
use crate::{Frame, FrameStyle, WriteError};

/// Writes a state as a data file for `units lj` and `atom_style atomic`; `title` is its first line.
///
/// Types are the species in their order, and each mass has the element as a comment. Positions (σ) are folded into the box,
/// with image flags; velocities are in σ/τ. All numbers are the shortest text that reads back to the same bits.
///
/// # Errors
/// Where a number is not finite or the operating system refuses; what stood at `path` before is then still there.
pub fn write_lammps_data(
    path: &Path,
    title: &str,
    species: &SpeciesTable,
    state: &State,
) -> Result<(), WriteError> {
    let style = FrameStyle { species: species.clone(), ..FrameStyle::default() };
    let frame = Frame { state, extra: &[] };
    style.check(path)?;
    style.check_frame(path, &frame)?;
    let mut text =
        format!("{title}\n\n{} atoms\n{} atom types\n\n", state.len(), species.n_species())
            .into_bytes();
    let sides = state.cell.lengths().to_array();
    for (side, axis) in sides.into_iter().zip(["x", "y", "z"]) {
        text.extend_from_slice(b"0.0 ");
        push_float(&mut text, side);
        text.extend_from_slice(format!(" {axis}lo {axis}hi\n").as_bytes());
    }
    text.extend_from_slice(b"\nMasses\n\n");
    for (a, one) in (1..).zip(species.all()) {
        let line = format!("{a} {:?} # {}\n", one.mass, one.element);
        text.extend_from_slice(line.as_bytes());
    }
    text.extend_from_slice(b"\nAtoms # atomic\n\n");
    for i in 0..state.len() {
        let (position, image) =
            style.place(&state.cell, &state.positions, i).map_err(|bad| bad.in_file(path))?;
        push_integer(&mut text, i + 1);
        text.push(b' ');
        push_integer(&mut text, species.of(i) + 1);
        push_numbers(&mut text, position.to_array(), push_float);
        let flags = image.unwrap_or_default().to_array();
        push_numbers(&mut text, flags, push_integer);
        text.push(b'\n');
    }
    text.extend_from_slice(b"\nVelocities\n\n");
    for (i, velocity) in state.velocities.iter().enumerate() {
        let velocity = finite("velocity", i, *velocity).map_err(|bad| bad.in_file(path))?;
        push_integer(&mut text, i + 1);
        push_numbers(&mut text, velocity.to_array(), push_float);
        text.push(b'\n');
    }
    write_bytes_atomically(path, &text)
}

/// Appends numbers, each with a blank before it.
fn push_numbers<T>(to: &mut Vec<u8>, numbers: [T; 3], push: impl Fn(&mut Vec<u8>, T)) {
    for number in numbers {
        to.push(b' ');
        push(to, number);
    }
}
