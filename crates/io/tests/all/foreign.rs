//! Units, free text, and the formats of other programs: what is read, and what is named when it is refused.

use std::fmt::Write as _;

use glam::DVec3;
use lennard_io::{Beside, FileUnits, FormatError, StartConfiguration, read_configuration_bytes};

use crate::columns::{LATTICE, data, dump};
use crate::common::{read_beside, refused};

/// A GRO file of two particles with velocities.
fn gro(title: &str, velocities: bool) -> String {
    let mut text = format!("{title}\n    2\n");
    for (i, x) in [1.0, 2.0].into_iter().enumerate() {
        let number = i + 1;
        write!(text, "{number:5}{:<5}{:>5}{number:5}{x:8.3}{:8.3}{:8.3}", "AR", "Ar", 1.5, 2.0)
            .unwrap();
        if velocities {
            write!(text, "{:8.4}{:8.4}{:8.4}", 0.5, 0.0, -0.25).unwrap();
        }
        text.push('\n');
    }
    text + "   5.00000   6.00000   7.00000\n"
}

fn read(
    text: &str,
    length: Option<f64>,
    time: Option<f64>,
) -> Result<StartConfiguration, FormatError> {
    read_beside(text, Beside { cell: None, units: FileUnits::new(length, time, None) })
}

#[test]
fn units_are_taken_out_where_the_scene_names_them_and_refused_elsewhere() {
    let row = ["1 2 3", "2 3 4"];
    let real = data("written by LAMMPS, units = real", row, "Velocities\n\n1 0.5 0 0\n2 0 0 0\n");
    let metal = dump("vx vy vz", ["0.5 0 0", "0 0 0"]);
    let metal = format!("ITEM: UNITS\nmetal\n{metal}");
    let header = format!(
        "2\n{LATTICE} Properties=pos:R:3:velo:R:3 length_unit=angstrom\n1 2 3 0.5 0 0\n2 3 4 0 0 0\n"
    );
    for text in [&real, &metal, &header] {
        refused(
            read(text, None, None),
            &["found units `", "units lj (reduced units), or `start.length_scale`"],
        );
        let start = read(text, Some(2.0), Some(8.0)).unwrap();
        assert_eq!(start.cell.lengths(), DVec3::new(2.0, 2.5, 3.0));
        assert_eq!(start.positions[1], DVec3::new(1.0, 1.5, 2.0));
        assert_eq!(start.velocities.unwrap()[0], DVec3::new(2.0, 0.0, 0.0));
        refused(
            read(text, Some(2.0), None),
            &["velocities in units of the file; allowed: `start.time_scale`"],
        );
    }
    let header = |entry: &str| format!("2\n{LATTICE} {entry}\nAr 1 2 3\nAr 2 3 4\n");
    for (text, found) in [
        (data("units = lj", row, ""), "units `lj` beside `start.length_scale` in the scene"),
        (header("units=lj"), "units `lj` beside `start.length_scale` in the scene"),
        (header("length_scale=2"), "length_scale beside `start.length_scale` in the scene"),
    ] {
        read(&text, None, None).unwrap();
        refused(read(&text, Some(2.0), None), &[found, "one of them"]);
    }
    // A comment anywhere in a data file.
    refused(
        read(&data("two", row, "# in metal units\n"), None, None),
        &[":14: found units `metal`"],
    );
    let momenta =
        format!("2\n{LATTICE} Properties=pos:R:3:momenta:R:3\n1 2 3 0.5 0 0\n2 3 4 0 0 0\n");
    refused(
        read(&momenta, Some(2.0), Some(8.0)),
        &["momenta without masses", "a column with the masses beside them"],
    );
}

/// Proves that files in real units are read where a substance is named, in every format that states units. Units that come too
/// late, or twice, are refused.
#[test]
fn a_substance_takes_out_units_that_a_file_states() {
    // σ = 2 Å, τ = 8 fs, m = 4 u.
    let substance = Some([2e-10, 8e-15, 4.0 * 1.660_539_069e-27]);
    let units = FileUnits::new(None, None, substance);
    let read = |text: &str| read_beside(text, Beside { cell: None, units });
    let row = ["1 2 3", "2 3 4"];
    let real = data("written by LAMMPS, units = real", row, "Velocities\n\n1 0.5 0 0\n2 0 0 0\n");
    let frame = dump("vx vy vz", ["0.5 0 0", "0 0 0"]);
    // LAMMPS states the units before the first frame alone.
    let real_dump = format!("ITEM: UNITS\nreal\n{frame}{frame}");
    let momenta = format!(
        "2\n{LATTICE} units=real Properties=pos:R:3:momenta:R:3\n1 2 3 2 0 0\n2 3 4 0 0 0\n"
    );
    for text in [&real, &real_dump, &momenta] {
        let start = read(text).unwrap();
        assert!((start.cell.lengths() - DVec3::new(2.0, 2.5, 3.0)).length() < 1e-12);
        assert!((start.positions[1] - DVec3::new(1.0, 1.5, 2.0)).length() < 1e-12);
        let motion = start.velocities.or(start.momenta).unwrap()[0];
        assert!((motion - DVec3::new(2.0, 0.0, 0.0)).length() < 1e-9, "{motion}");
    }
    let start = read(&gro("argon", true)).unwrap();
    assert!((start.cell.lengths() - DVec3::new(25.0, 30.0, 35.0)).length() < 1e-12);
    for (text, found) in [
        (data("two", row, "# in metal units\n"), "units `metal` behind the particles"),
        (data("real units", row, "# in metal units\n"), "units `metal` after units `real`"),
        (data("units = furlong", row, ""), "units `furlong`"),
    ] {
        refused(read(&text), &[found]);
    }
    // What states no units is reduced.
    assert_eq!(read(&frame).unwrap().positions[1], DVec3::new(2.0, 3.0, 4.0));
}

#[test]
fn the_comment_of_a_plain_file_is_free_text_but_for_units() {
    let cell = Some(lennard_core::PeriodicBox::new(DVec3::splat(8.0)).unwrap());
    let beside = Beside { cell, units: FileUnits::default() };
    let read = |comment: &str| read_beside(format!("2\n{comment}\nAr 1 2 3\nAr 2 3 4\n"), beside);
    for comment in [
        "",
        " i =        5, time =        2.500, E =       -31.0000000000",
        "Atoms. Timestep: 1000",
        "snapshot of the \"melt",
        "= a = a = {",
        "a=1 a=2 Time=soon Step=1.5 pbc=\"F F F\"",
        "lattice = fcc, generated by VMD",
        "caf\u{e9}, units=lj",
    ] {
        let start = read(comment).unwrap_or_else(|e| panic!("{comment}: {e}"));
        assert_eq!(start.positions[1], DVec3::new(2.0, 3.0, 4.0), "{comment}");
    }
    assert_eq!(read("length_scale=2").unwrap().positions[1], DVec3::new(1.0, 1.5, 2.0));
    for comment in
        ["units = real", "positions in Angstrom", "# CELL(abcABC): 5 positions{angstrom}"]
    {
        refused(read(comment), &[":2: found units"]);
    }
    read_beside(b"1\ncaf\xe9\nAr 1 2 3\n", beside).unwrap();
}

#[test]
fn gro_is_read_in_nanometers_and_picoseconds() {
    let text = gro("argon t= 1.0 step= 500", true);
    refused(read(&text, None, None), &["found a GRO file, in nm and ps", "`start.length_scale`"]);
    refused(read(&text, Some(0.5), None), &[":3: found velocities", "`start.time_scale`"]);
    let start = read(&text, Some(0.5), Some(2.0)).unwrap();
    assert_eq!(start.cell.lengths(), DVec3::new(10.0, 12.0, 14.0));
    assert_eq!(start.positions, [DVec3::new(2.0, 3.0, 4.0), DVec3::new(4.0, 3.0, 4.0)]);
    assert_eq!(start.velocities.unwrap()[1], DVec3::new(2.0, 0.0, -1.0));
    assert_eq!(start.species.names, ["Ar"]);
    // The last of several frames, with a number for a title, and no velocities.
    let frames = gro("first", false) + &gro("64", false);
    let start = read(&frames, Some(1.0), None).unwrap();
    assert_eq!((start.frames, start.velocities), (2, None));
    assert_eq!(start.cell.lengths(), DVec3::new(5.0, 6.0, 7.0));
    let reduced = gro("a liquid in reduced units", true);
    assert_eq!(
        read(&reduced, None, None).unwrap().velocities.unwrap()[1],
        DVec3::new(0.5, 0.0, -0.25)
    );
    refused(
        read(&gro("far", false), Some(1e-10), None),
        &[":3: found the position", "from -1e9 to 1e9 σ"],
    );
    // More decimals have wider columns.
    let fine =
        "fine\n1\n    1AR      Ar    1   1.250000   1.500000   2.000000\n 5 6 7 0 0 0 0 0 0\n";
    assert_eq!(read(fine, Some(1.0), None).unwrap().positions, [DVec3::new(1.25, 1.5, 2.0)]);
    let own = gro("Lennard: names, box, and rounded positions of the start", false);
    refused(read(&own, None, None), &["a topology of this program", "the `final.xyz` beside it"]);
    for (from, to, line, found, allowed) in [
        ("   2.000   1.500", "   2.00x   1.500", 4, "`2.00x`", "a finite number"),
        (
            "  0.5000  0.0000 -0.2500\n   5",
            "  0.5000  0.0000\n   5",
            4,
            "60 characters",
            "68 characters, as in the first line of a particle",
        ),
        ("   5.00000", "   0.00000", 5, "`   0.00000", "sides that are positive"),
        ("   7.00000", "", 5, "`   5.00000   6.00000`", "three or nine finite numbers"),
        ("   7.00000", "   7.00000 0 0 1 0 0 0", 5, "a triclinic box", "orthorhombic"),
        ("   5.00000   6.00000   7.00000\n", "", 5, "the end of the file", "the sides of the box"),
        ("   5.00000   6.00000   7.00000", "0 0 0", 2, "no box", "a box in the scene"),
    ] {
        let damaged = read(&text.replace(from, to), Some(1.0), Some(1.0));
        refused(damaged, &[&format!(":{line}: found"), found, allowed]);
    }
}

#[test]
fn formats_that_are_not_read_are_named_with_the_way_out() {
    let poscar = "argon\n1.0\n5.2 0 0\n0 5.2 0\n0 0 5.2\nAr\n1\nCartesian\n0 0 0\n";
    let pdb = "REMARK made by hand\nATOM      1 AR    AR A   1       0.650   0.650   0.650\n";
    for (bytes, name, way) in [
        (b"\0\0\x07\xc9rest".as_slice(), "a TRR trajectory", "MDAnalysis"),
        (b"\x54\0\0\0CORDrest", "a DCD trajectory", "MDAnalysis"),
        (b"\0\0\0\0\0\0\0\x54CORD", "a DCD trajectory", "MDAnalysis"),
        (b"CDF\x02rest", "a NetCDF trajectory", "MDAnalysis"),
        (b"\x89HDF\r\n\x1a\nrest", "a file of HDF5", "MDAnalysis"),
        (b"\xfd7zXZ\0rest", "a file compressed by xz", "compressed by gzip"),
        (b"BZh91AY", "a file compressed by bzip2", "compressed by gzip"),
        (b"PK\x03\x04", "a zip archive", "compressed by gzip"),
        (b"LENNARD\x1a", "a checkpoint of this program", "`lennard resume`"),
        (b"LammpS RestartT", "a restart file of LAMMPS", "`write_data`"),
        (b"data_argon\n_cell_length_a 5\n", "a CIF file", "ase convert"),
        (poscar.as_bytes(), "a POSCAR file", "ase convert"),
        (pdb.as_bytes(), "a PDB file", "ase convert"),
    ] {
        refused(read_configuration_bytes(bytes), &[&format!(":1: found {name}"), way]);
    }
}

#[test]
fn a_dump_has_types_beside_its_elements() {
    let text = dump("element", ["C", "C"]).replace("\n2 1 2", "\n2 2 2");
    let found = read_configuration_bytes(text.as_bytes()).unwrap().species;
    assert_eq!(
        (found.names.as_slice(), found.types.as_slice()),
        (["C".to_owned(), "C".into()].as_slice(), ["1".to_owned(), "2".into()].as_slice())
    );
    assert!(!found.elements_tell_apart());
    assert_eq!(found.of_particle, [0, 1]);
    let text = text.replace(" 4 C", " 4 Kr");
    assert!(read_configuration_bytes(text.as_bytes()).unwrap().species.elements_tell_apart());
}
