//! The sidecar file that gives mdtraj what extended XYZ does not: names, residues and the box.

use std::path::Path;

use lennard_core::PeriodicBox;

use crate::atomic::write_bytes_atomically;
use crate::text::{push_float, push_integer};
use crate::{FrameStyle, WriteError};

/// Readers take the lengths of an XYZ file for Å and hold them in nm: 1 nm = 10 Å.
const ANGSTROM_A_NANOMETER: f64 = 10.0;

/// Residue and atom numbers have five columns and start over from 0 there.
const NUMBERS_START_OVER: usize = 100_000;

/// Writes `topology.gro` for `n` particles, named by the elements of the species; each molecule is a residue.
///
/// Lengths in a .gro file are nm. The box is written as `length_scale·L/10`, the value that mdtraj gives
/// the lengths of the trajectory beside it, with all digits. The positions are zeros: they are in the
/// trajectory. `mdtraj.load("trajectory.xyz", top="topology.gro")` then has the right names but no
/// unit cell; take its lengths from `mdtraj.load("topology.gro").unitcell_lengths`.
///
/// # Errors
/// Where the style holds an impossible value or the operating system refuses.
pub fn write_topology_gro(
    path: &Path,
    n: usize,
    cell: &PeriodicBox,
    style: &FrameStyle,
) -> Result<(), WriteError> {
    style.check(path)?;
    let mut text = Vec::new();
    text.extend_from_slice(b"Lennard: names and box only, positions are in the trajectory\n");
    push_integer(&mut text, n);
    text.push(b'\n');
    for i in 1..=n {
        let number = i % NUMBERS_START_OVER;
        let element = &style.species.species(style.species.of(i - 1)).element;
        let residue = ((i - 1) / style.sites_per_molecule.max(1) + 1) % NUMBERS_START_OVER;
        let line =
            format!("{residue:5}{element:<5}{element:>5}{number:5}   0.000   0.000   0.000\n");
        text.extend_from_slice(line.as_bytes());
    }
    let sides = cell.lengths() * style.length_scale / ANGSTROM_A_NANOMETER;
    for side in sides.to_array() {
        text.push(b' ');
        push_float(&mut text, side);
    }
    text.push(b'\n');
    write_bytes_atomically(path, &text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn the_topology_has_one_residue_an_atom_and_the_box_in_nanometers() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("topology.gro");
        let cell = PeriodicBox::new(DVec3::new(10.0, 20.0, 30.0)).unwrap();
        let style = FrameStyle {
            length_scale: 2.0,
            ..FrameStyle::default()
        };
        write_topology_gro(&path, 2, &cell, &style).unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "Lennard: names and box only, positions are in the trajectory\n2\n\
             \x20   1Ar      Ar    1   0.000   0.000   0.000\n\
             \x20   2Ar      Ar    2   0.000   0.000   0.000\n 2.0 4.0 6.0\n"
        );
    }

    #[test]
    fn the_sites_of_a_molecule_are_one_residue() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("topology.gro");
        let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
        let style = FrameStyle {
            sites_per_molecule: 2,
            ..FrameStyle::default()
        };
        write_topology_gro(&path, 4, &cell, &style).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let rows: Vec<&str> = text.lines().skip(2).take(4).collect();
        let residues: Vec<&str> = rows.iter().map(|row| row[..5].trim()).collect();
        assert_eq!(residues, ["1", "1", "2", "2"]);
        assert_eq!(rows[3][15..20].trim(), "4");
    }

    #[test]
    fn numbers_keep_their_five_columns_in_large_systems() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("topology.gro");
        let cell = PeriodicBox::new(DVec3::splat(50.0)).unwrap();
        write_topology_gro(&path, 100_001, &cell, &FrameStyle::default()).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let rows: Vec<&str> = text.lines().skip(2).collect();
        assert!(rows[..100_001].iter().all(|row| row.len() == rows[0].len()));
        assert!(rows[100_000].starts_with("    1Ar"));
    }
}
