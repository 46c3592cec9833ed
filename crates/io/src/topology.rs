//! The sidecar file that gives readers of trajectories what those lack: names, residues and the box.

use std::ops::Range;
use std::path::Path;

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::atomic::write_parts_atomically;
use crate::formats::PARTICLES_A_PIECE;
use crate::formats::lines::{push_float, push_integer};
use crate::{FrameStyle, TrajectoryFormat, WriteError};

/// Residue and atom numbers have five columns and start over from 0 there.
const NUMBERS_START_OVER: usize = 100_000;

/// Coordinates have eight columns, three of them behind the point: from here on they take more.
const COORDINATES_END: f64 = 9999.9995;

/// Writes `topology.gro` for particles at `positions` (σ), named by the elements of the species; each molecule is a residue.
///
/// Lengths are in nm, as readers understand the trajectory beside it: `length_scale·L/10` beside text, whose unit they
/// take for Å, and `length_scale·L` beside XTC. Positions are folded into the box, as `whole` of the style
/// says, and have the three decimals of the format. The box has all digits. mdtraj then has the right names for
/// `mdtraj.load("trajectory.xyz", top="topology.gro")`, but no unit cell; take its lengths from
/// `mdtraj.load("topology.gro").unitcell_lengths`. In a box too long for the columns, positions are zeros.
///
/// # Errors
/// Where the style holds an impossible value or the operating system refuses.
pub fn write_topology_gro(
    path: &Path,
    positions: &[DVec3],
    cell: &PeriodicBox,
    format: TrajectoryFormat,
    style: &FrameStyle,
) -> Result<(), WriteError> {
    style.check(path)?;
    write_parts_atomically(path, |take| pass_lines(path, positions, cell, format, style, take))
}

/// Gives rank 0 the lines of the particles of this rank, while it calls [`write_topology_gro`].
///
/// # Errors
/// Where a position is not finite, here or on another rank.
pub fn give_topology_gro(
    positions: &[DVec3],
    cell: &PeriodicBox,
    format: TrajectoryFormat,
    style: &FrameStyle,
) -> Result<(), WriteError> {
    let path = Path::new("topology.gro");
    pass_lines(path, positions, cell, format, style, |_| {})
}

/// Makes the lines of all ranks piece by piece, and lets rank 0 take them.
fn pass_lines(
    path: &Path,
    positions: &[DVec3],
    cell: &PeriodicBox,
    format: TrajectoryFormat,
    style: &FrameStyle,
    take: impl FnMut(&[u8]),
) -> Result<(), WriteError> {
    let folded = FrameStyle { wrapped: true, ..style.clone() };
    let given = (positions, cell, format, &folded);
    let push = |to: &mut Vec<u8>, particles| push_lines(to, path, given, particles);
    style.pass(path, Ok(()), (positions.len(), PARTICLES_A_PIECE), &mut Vec::new(), push, take)
}

fn push_lines(
    text: &mut Vec<u8>,
    path: &Path,
    (positions, cell, format, style): (&[DVec3], &PeriodicBox, TrajectoryFormat, &FrameStyle),
    particles: Range<usize>,
) -> Result<(), WriteError> {
    let to_nm = style.length_scale * format.spec().nanometers;
    let sides = cell.lengths() * to_nm;
    let fits = sides.max_element() < COORDINATES_END;
    if style.begins() && particles.start == 0 {
        text.extend_from_slice(match fits {
            true => b"Lennard: names, box, and rounded positions of the start\n".as_slice(),
            false => b"Lennard: names and box; positions are too long for this format\n",
        });
        push_integer(text, style.all(positions.len()));
        text.push(b'\n');
    }
    for i in particles.clone() {
        let number = (style.number(i) + 1) % NUMBERS_START_OVER;
        let element = &style.species_of(i).element;
        let residue = (style.number(i) / style.sites_per_molecule + 1) % NUMBERS_START_OVER;
        let [x, y, z] = match fits {
            true => {
                let place = style.place(cell, positions, i);
                (place.map_err(|bad| bad.in_file(path))?.0 * to_nm).to_array()
            }
            false => [0.0; 3],
        };
        let line = format!("{residue:5}{element:<5}{element:>5}{number:5}{x:8.3}{y:8.3}{z:8.3}\n");
        text.extend_from_slice(line.as_bytes());
    }
    if style.ends() && particles.end == positions.len() {
        for side in sides.to_array() {
            text.push(b' ');
            push_float(text, side);
        }
        text.push(b'\n');
    }
    Ok(())
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
        let style = FrameStyle { length_scale: 2.0, ..FrameStyle::default() };
        let positions = [DVec3::new(1.5, 2.0, 3.0), DVec3::new(-1.0, 20.5, 29.999)];
        write_topology_gro(&path, &positions, &cell, TrajectoryFormat::Xyz, &style).unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "Lennard: names, box, and rounded positions of the start\n2\n\
             \x20   1Ar      Ar    1   0.300   0.400   0.600\n\
             \x20   2Ar      Ar    2   1.800   0.100   6.000\n 2.0 4.0 6.0\n"
        );
        write_topology_gro(&path, &positions, &cell, TrajectoryFormat::Xtc, &style).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("   3.000   4.000   6.000\n"), "{text}");
        assert!(text.ends_with(" 20.0 40.0 60.0\n"), "{text}");
    }

    #[test]
    fn positions_too_long_for_their_columns_are_zeros_and_the_title_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("topology.gro");
        let cell = PeriodicBox::new(DVec3::splat(2e5)).unwrap();
        let positions = [DVec3::splat(1e5)];
        write_topology_gro(&path, &positions, &cell, TrajectoryFormat::Xyz, &FrameStyle::default())
            .unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("too long"), "{text}");
        assert!(text.contains("    1   0.000   0.000   0.000\n"), "{text}");
    }

    #[test]
    fn the_sites_of_a_molecule_are_one_residue() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("topology.gro");
        let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
        let style = FrameStyle { sites_per_molecule: 2, ..FrameStyle::default() };
        write_topology_gro(&path, &[DVec3::ZERO; 4], &cell, TrajectoryFormat::Xyz, &style).unwrap();
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
        write_topology_gro(
            &path,
            &[DVec3::ONE; 100_001],
            &cell,
            TrajectoryFormat::Xyz,
            &FrameStyle::default(),
        )
        .unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let rows: Vec<&str> = text.lines().skip(2).collect();
        assert!(rows[..100_001].iter().all(|row| row.len() == rows[0].len()));
        assert!(rows[100_000].starts_with("    1Ar"));
    }
}
