//! What readers take and what they refuse, with the whole message.

use glam::DVec3;
use lennard_io::{FoundSpecies, read_configuration_bytes, read_trajectory_bytes};

/// A frame with this header line and these particle lines.
fn xyz(header: &str, particles: &[&str]) -> String {
    format!("{}\n{header}\n{}\n", particles.len(), particles.join("\n"))
}

const BOX: &str = "Lattice=\"4 0 0 0 5 0 0 0 6\"";

#[test]
fn columns_may_stand_in_any_order_and_others_are_passed_over() {
    let text = xyz(
        &format!(
            "note=\"two words = \\\"quoted\\\"\" Properties=id:I:1:map_shift:I:3:vel:R:3:tags:R:2:pos:R:3:species:S:1 \
             {BOX} time=2 step=7 converged"
        ),
        &["1 0 -1 2  1 2 3  0.5 nan  0.5 0.25 1e0 Kr", "2\t0 0 0  4 5 6  0.5 nan  1 2 3 Kr"],
    );
    let frames = read_trajectory_bytes(text.as_bytes()).unwrap();
    assert_eq!(frames.len(), 1);
    let frame = &frames[0];
    assert_eq!(frame.positions, [DVec3::new(0.5, -4.75, 13.0), DVec3::new(1.0, 2.0, 3.0)]);
    assert_eq!(
        frame.velocities.as_deref().unwrap(),
        [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)]
    );
    assert_eq!((frame.step, frame.time), (Some(7), Some(2.0)));
    assert_eq!(frame.species.names, ["Kr"]);
    assert_eq!(frame.info["note"], "two words = \"quoted\"");
    assert_eq!(frame.info["converged"], "T");
}

#[test]
fn both_kinds_of_line_ends_and_blank_lines_at_the_end_are_read() {
    let text = xyz(BOX, &["Ar 1 2 3", "Ar 2 3 4"]);
    let plain = read_configuration_bytes(text.as_bytes()).unwrap();
    let windows = text.replace('\n', "\r\n");
    assert_eq!(read_configuration_bytes(windows.as_bytes()).unwrap(), plain);
    let blank = format!("{text}\n  \n");
    assert_eq!(read_configuration_bytes(blank.as_bytes()).unwrap(), plain);
    let unended = text.trim_end();
    assert_eq!(read_configuration_bytes(unended.as_bytes()).unwrap(), plain);
}

#[test]
fn nist_columns_are_told_by_their_content() {
    let text = "10.0 11.0 12.0\n2\n    1  -1.5E+00  2.0 3\n 2 0 0 1\n";
    let start = read_configuration_bytes(text.as_bytes()).unwrap();
    assert_eq!(start.cell.lengths(), DVec3::new(10.0, 11.0, 12.0));
    assert_eq!(start.positions, [DVec3::new(-1.5, 2.0, 3.0), DVec3::new(0.0, 0.0, 1.0)]);
    assert_eq!(start.velocities, None);
    assert_eq!(start.species, FoundSpecies::default());
}

/// Each kind of bad file, the line at fault, what the message says was found and what is allowed.
#[test]
fn every_bad_file_is_refused_with_line_found_and_allowed() {
    let good = ["Ar 1 2 3", "Ar 2 3 4"];
    let with = |header: &str| xyz(&format!("{BOX} {header}"), &good);
    let lattice = |sides: &str| xyz(&format!("Lattice=\"{sides}\""), &good);
    let row = |row: &str| xyz(BOX, &["Ar 1 2 3", row]);
    let table: Vec<(String, u64, &str, &str)> = vec![
        (
            String::new(),
            1,
            "the end of the file",
            "extended XYZ, LAMMPS dump or data, GRO, or NIST columns",
        ),
        ("hello world\n".into(), 1, "`hello world`", "the number of particles"),
        ("two\n\n".into(), 1, "`two`", "an integer of at least 1"),
        ("-2\n\n".into(), 1, "`-2`", "an integer of at least 1"),
        ("2.0\n\n".into(), 1, "`2.0`", "an integer of at least 1"),
        ("0\n\n".into(), 1, "0 particles", "an integer of at least 1"),
        (
            "99999999999\n\nAr 1 2 3\n".into(),
            1,
            "`99999999999` particles",
            "left in the file can hold",
        ),
        (
            "99999999999999999999999\n\nAr 1 2 3\n".into(),
            1,
            "particles",
            "left in the file can hold",
        ),
        ("5\n".into(), 1, "`5` particles", "left in the file can hold"),
        // Enough bytes for four short particles, yet only two lines.
        (
            xyz(BOX, &["Argonaut 1.0 2.0 3.0", "Argonaut 1.0 2.0 3.0"]).replacen('2', "4", 1),
            5,
            "the end of the file",
            "particle 3 of 4: the frame is truncated",
        ),
        (xyz("", &good), 2, "no box", "a Lattice="),
        (with("Properties=species:S:1"), 2, "Properties=`species:S:1`", "pos:R:3"),
        (with("Properties=species:S:1:pos:R:2"), 2, "Properties=", "pos:R:3"),
        (with("Properties=species:S:1:pos:R:3:x:Q:1"), 2, "Properties=", "a type of S, R, I or L"),
        (with("Properties=species:S:1:pos:R:3:x:R:0"), 2, "Properties=", "a width of at least 1"),
        (
            with("Properties=species:S:1:pos:R:3:x:R:99999999999"),
            2,
            "Properties=",
            "at most 256 columns",
        ),
        (with("Properties=species:S:1:pos"), 2, "Properties=", "triples"),
        (
            with("Properties=species:S:1:pos:R:3:velo:R:3:vel:R:3"),
            2,
            "Properties=",
            "each quantity once",
        ),
        (
            xyz("Properties=species:S:1:pos:R:3:map_shift:I:3", &good),
            2,
            "image flags (map_shift) without a box",
            "a Lattice=\"…\" entry beside them",
        ),
        (
            lattice("4 0 0 0 5 0 0 0"),
            2,
            "Lattice=`4 0 0 0 5 0 0 0`",
            "nine finite numbers, the box vectors a, b and c",
        ),
        (lattice("4 0 0 0 5 0 0 0 nan"), 2, "nan", "nine finite numbers"),
        (lattice("4 0 0 0 -5 0 0 0 6"), 2, "-5", "positive"),
        (lattice("4 0 0 0 5 0 0.1 0 6"), 2, "a triclinic box", "triclinic boxes are not there yet"),
        (
            with("pbc=\"T T F\""),
            2,
            "pbc=`T T F`",
            "\"T T T\"; boxes that are not periodic in all directions are not there yet",
        ),
        (with("pbc=\"T T\""), 2, "pbc=`T T`", "three of T or F"),
        (with("units=metal"), 2, "units `metal`", "units lj"),
        (with("Time=soon"), 2, "Time=`soon`", "a finite number"),
        (with("Step=1.5"), 2, "Step=`1.5`", "an integer of at least 0"),
        (with("length_scale=0"), 2, "length_scale=`0`", "a finite positive number"),
        (with("a=1 a=2"), 2, "`a` twice", "each key once"),
        (with("a=\"open"), 2, "`\\\"open`, which is not closed", "ends with \""),
        (with("=1"), 2, "`=1`", "key=value pairs"),
        (row("Ar 1 2"), 4, "3 columns in `Ar 1 2`", "4 columns, as the header says"),
        (row("Ar 1 2 3 4"), 4, "5 columns in `Ar 1 2 3 4`", "4 columns, as the header says"),
        (row("Ar 1 x 3"), 4, "`x`", "a finite number"),
        (row("Ar 1 NaN 3"), 4, "`NaN`", "a finite number"),
        (row("Ar 1 1e999 3"), 4, "`1e999`", "a finite number"),
        (
            row("Ar 1 1e30 3"),
            4,
            "the position (1e0, 1e30, 3e0) σ",
            "coordinates from -1e9 to 1e9 σ",
        ),
        (
            xyz(
                &format!("{BOX} Properties=species:S:1:pos:R:3:masses:R:1"),
                &["Kr 1 2 3 1", "Kr 2 2 3 2"],
            ),
            4,
            "mass 2",
            "1, like the `Kr` before",
        ),
        (
            xyz(&format!("{BOX} Properties=pos:R:3:masses:R:1"), &["1 2 3 1", "1 2 3 2"]),
            4,
            "mass 2",
            "like the particles before: the file names no species",
        ),
        (
            xyz(&format!("{BOX} Properties=pos:R:3:map_shift:I:3"), &["1 2 3 0 0 0.5"]),
            3,
            "`0.5`",
            "an image flag",
        ),
        (
            xyz(BOX, &good) + "\n" + &xyz(BOX, &good),
            5,
            "a blank line",
            "the number of particles of the next frame",
        ),
        (xyz(BOX, &good) + "Ar 1 2 3\n", 5, "`Ar 1 2 3`", "the number of particles"),
        (
            "300\n1 10.0 9.8 9.6 1.7 2.5 0.4\n1 0 0 0\n".into(),
            2,
            "a triclinic NIST box",
            "triclinic boxes are not there yet",
        ),
        (
            "10 10 0\n1\n1 0 0 0\n".into(),
            1,
            "`10 10 0`",
            "three box sides, finite positive numbers",
        ),
        ("10 10 10\n".into(), 2, "the end of the file", "the number of particles"),
        ("10 10 10\n0\n".into(), 2, "0 particles", "an integer of at least 1"),
        ("10 10 10\n4000000000\n1 0 0 0\n".into(), 2, "particles", "left in the file can hold"),
        (
            "10 10 10\n2\n1 0.0000 0.0000 0.0000\n".into(),
            4,
            "the end of the file",
            "particle 2 of 2: the file is truncated",
        ),
        ("10 10 10\n2\n1 0 0 0\n3 0 0 0\n".into(), 4, "`3 0 0 0`", "`2 x y z`"),
        ("10 10 10\n2\n1 0 0 0\n2 0.0 0.0\n".into(), 4, "`2 0.0 0.0`", "three finite coordinates"),
        ("10 10 10\n2\n1 0 0 0\n2 0 nan 0\n".into(), 4, "`2 0 nan 0`", "three finite coordinates"),
        (
            "10 10 10\n1\n1 0 0 0\n2 0 0 0\n".into(),
            4,
            "`2 0 0 0`",
            "the end of the file after 1 particles",
        ),
    ];
    for (text, line, found, allowed) in table {
        let error = read_configuration_bytes(text.as_bytes()).expect_err(&text);
        let message = error.to_string();
        assert_eq!(error.line(), Some(line), "{text}\n{message}");
        let (found_part, allowed_part) = message.split_once("; allowed: ").expect("both parts");
        assert!(found_part.contains(found), "{text}\n{message}");
        assert!(allowed_part.contains(allowed), "{text}\n{message}");
    }
}

#[test]
fn bytes_that_are_not_text_are_refused_without_panic() {
    let mut header = xyz(BOX, &["Ar 1 2 3"]).into_bytes();
    let at = header.iter().position(|&b| b == b'4').unwrap();
    header[at] = 0xff;
    let error = read_configuration_bytes(&header).unwrap_err();
    assert!(error.to_string().contains("UTF-8"), "{error}");
    let mut species = xyz(BOX, &["Ar 1 2 3"]).into_bytes();
    let at = species.iter().position(|&b| b == b'A').unwrap();
    species[at] = 0xff;
    let error = read_configuration_bytes(&species).unwrap_err();
    assert_eq!(error.line(), Some(3), "{error}");
}

#[test]
fn frames_before_a_truncated_one_are_still_read() {
    let text = xyz(BOX, &["Ar 1 2 3"]) + &xyz(BOX, &["Ar 4 5 6"]);
    let reader = lennard_io::TrajectoryReader::over(
        &text.as_bytes()[..text.len() - 4],
        std::path::Path::new("t.xyz"),
    );
    let frames: Vec<_> = reader.collect();
    assert_eq!(frames.len(), 2);
    assert_eq!(frames[0].as_ref().unwrap().positions[0].x, 1.0);
    assert!(frames[1].is_err());
}
