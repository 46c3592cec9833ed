//! Trajectories of any program, frame by frame, and what is refused of them.

use std::path::Path;

use glam::DVec3;
use lennard_io::{FileUnits, Frames, TrajectoryFrame};

use crate::common::{refused, scratch};

fn read(text: &str, units: FileUnits) -> Result<Vec<TrajectoryFrame>, String> {
    let (_folder, path) = scratch("t.dat");
    std::fs::write(&path, text).unwrap();
    let mut frames = Frames::open(&path, units).map_err(|e| e.to_string())?;
    let mut all = Vec::new();
    while let Some(frame) = frames.next_frame().map_err(|e| e.to_string())? {
        all.push(frame);
    }
    assert_eq!(frames.part_read(), 1.0);
    Ok(all)
}

fn plain(text: &str) -> Result<Vec<TrajectoryFrame>, String> {
    read(text, FileUnits::default())
}

fn xyz(n: usize, lattice: &str, x: &str) -> String {
    let rows = format!("Ar {x} 2.25 3.125\n").repeat(n);
    format!("{n}\n{lattice} Time=0.5 Properties=species:S:1:pos:R:3\n{rows}")
}

const LATTICE: &str = "Lattice=\"9 0 0 0 9 0 0 0 9\"";

fn dump(columns: &str, row: &str) -> String {
    let bounds = "0.0 9.0\n".repeat(3);
    format!(
        "ITEM: TIMESTEP\n40\nITEM: TIME\n0.25\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n{bounds}ITEM: ATOMS {columns}\n{row}\n"
    )
}

#[test]
fn times_rounding_and_images_are_what_each_format_says() {
    let frames = plain(&xyz(2, LATTICE, "1.5").repeat(3)).unwrap();
    assert_eq!(frames.len(), 3);
    assert_eq!((frames[0].time, frames[0].unwrapped), (Some(0.5), false));
    // Four digits of a coordinate of one digit before the point.
    assert!((frames[0].rounding - 1e-3).abs() < 1e-15, "{}", frames[0].rounding);

    let folded = &plain(&dump("id x y z", "1 1.25 12.3456 0.5")).unwrap()[0];
    assert_eq!((folded.step, folded.time, folded.unwrapped), (Some(40), Some(0.25), false));
    assert!((folded.rounding - 1e-4).abs() < 1e-16, "{}", folded.rounding);
    let scaled = &plain(&dump("id xs ys zs", "1 0.5 0.25 0.123456")).unwrap()[0];
    assert!((scaled.rounding - 9e-6).abs() < 1e-15, "{}", scaled.rounding);
    assert_eq!(scaled.positions[0], DVec3::new(4.5, 2.25, 9.0 * 0.123_456));
    assert!(plain(&dump("id xu yu zu", "1 11.25 2.5 0.5")).unwrap()[0].unwrapped);
    assert!(plain(&dump("id x y z ix iy iz", "1 1 2 3 0 0 1")).unwrap()[0].unwrapped);

    let gro = "water t=   4.31200 step= 2\n    1\n    1AR      AR    1   1.000   2.000   0.500\n   3.0   3.0   3.0\n";
    let units = FileUnits::new(Some(0.5), Some(2.156), None);
    let frame = &read(gro, units).unwrap()[0];
    assert_eq!(frame.positions[0], DVec3::new(2.0, 4.0, 1.0));
    assert!((frame.time.unwrap() - 2.0).abs() < 1e-12);
}

#[test]
fn frames_that_do_not_go_together_are_refused_by_their_number() {
    let first = xyz(2, LATTICE, "1.5");
    for (second, wanted) in [
        (xyz(3, LATTICE, "1.5"), "frame 2: found 3 particles; allowed: 2, as in frame 1"),
        (xyz(2, "", "1.5"), "frame 2: found no box"),
        (first.replace("Ar", "Kr"), "frame 2: found other species"),
        (first[..first.len() - 20].to_owned(), "t.dat:8: found "),
        (first.replace("1.5", "nan"), "t.dat:7: found `nan`; allowed: a finite number"),
    ] {
        let message = plain(&format!("{first}{second}")).unwrap_err();
        assert!(message.contains(wanted), "{message}\n{wanted}");
    }
    let cut = dump("id x y z", "1 1 2 3");
    refused(plain(&format!("{cut}{}", &cut[..30])), &["the end of the file"]);
    refused(
        plain("LAMMPS data file\n\n1 atoms\n1 atom types\n"),
        &["one configuration; allowed: a trajectory"],
    );
    assert!(Frames::open(Path::new("nowhere.xtc"), FileUnits::default()).is_err());
}
