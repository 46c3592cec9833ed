//! LAMMPS' data files of atoms, written.
//!
//! Source: LAMMPS documentation, "read_data command".

use std::path::Path;

use lennard_core::{SpeciesTable, State};

use crate::atomic::write_bytes_atomically;
use crate::formats::columns::{Column, Layout};
use crate::formats::lines::push_float;
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
    let columns = |names: &[Column]| {
        let named: Vec<_> = names.iter().map(|column| (*column, "")).collect();
        Layout::new(&style, 1.0, &named)
    };
    let atoms = columns(&[Column::Id, Column::Type, Column::Position, Column::Image]);
    atoms.push_lines_of(&mut text, path, state, 0..state.len())?;
    text.extend_from_slice(b"\nVelocities\n\n");
    columns(&[Column::Id, Column::Velocity]).push_lines_of(
        &mut text,
        path,
        state,
        0..state.len(),
    )?;
    write_bytes_atomically(path, &text)
}
