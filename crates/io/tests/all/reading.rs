//! What readers take and what they refuse, with the whole message.

use glam::DVec3;
use lennard_io::{FileUnits, FoundSpecies, Frames, read_configuration_bytes};

use crate::common::{frames_of, refused};

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
    let frames = frames_of(text.as_bytes()).unwrap();
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

#[test]
fn bytes_that_are_not_text_are_refused_without_panic() {
    let mut header = xyz(BOX, &["Ar 1 2 3"]).into_bytes();
    let at = header.iter().position(|&b| b == b'4').unwrap();
    header[at] = 0xff;
    refused(read_configuration_bytes(&header), &["UTF-8"]);
    let mut species = xyz(BOX, &["Ar 1 2 3"]).into_bytes();
    let at = species.iter().position(|&b| b == b'A').unwrap();
    species[at] = 0xff;
    let error = read_configuration_bytes(&species).unwrap_err();
    assert_eq!(error.line(), Some(3), "{error}");
}

#[test]
fn frames_before_a_truncated_one_are_still_read() {
    let text = xyz(BOX, &["Ar 1 2 3"]) + &xyz(BOX, &["Ar 4 5 6"]);
    let truncated = &text.as_bytes()[..text.len() - 4];
    let mut frames = Frames::of_bytes(truncated, FileUnits::default()).unwrap();
    assert_eq!(frames.next_frame().unwrap().unwrap().positions[0].x, 1.0);
    assert!(frames.next_frame().is_err());
    assert!(matches!(frames.next_frame(), Ok(None)), "after an error it ends");
}

#[test]
fn a_start_is_the_last_frame_whatever_the_columns_of_frames_before_it_hold() {
    let xyz = |x: &str| xyz(BOX, &[&format!("Ar {x} 2 3"), "Ar 0 0 0"]);
    let dump = |x: &str| {
        format!(
            "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n\
             ITEM: ATOMS x y z\n{x} 2 3\n0 0 0\n"
        )
    };
    let gro = |x: &str| {
        let row = |n: u32, x: &str| format!("    1Ar      Ar{n:5}{x:>8}   2.000   3.000\n");
        format!("reduced units\n2\n{}{}   9.0   9.0   9.0\n", row(1, x), row(2, "0.000"))
    };
    let kinds: [&dyn Fn(&str) -> String; 3] = [&xyz, &dump, &gro];
    for (frame, lines_of_a_frame) in kinds.into_iter().zip([4, 11, 5]) {
        let [first, damaged, last] = ["1.000", "nowhere", "4.000"].map(frame);
        let read = |text: &str| read_configuration_bytes(text.as_bytes());
        let start = read(&format!("{first}{damaged}{last}")).unwrap();
        assert_eq!((start.positions[0].x, start.frames), (4.0, 3));
        // Damage in the last frame, and a last frame that is cut, are refused with their line.
        let line_of = |text: &str| read(text).unwrap_err().line().unwrap();
        let in_last = 2 * lines_of_a_frame + 1..=3 * lines_of_a_frame;
        assert!(in_last.contains(&line_of(&format!("{first}{last}{damaged}"))));
        let cut = &last[..last.trim_end().rfind('\n').unwrap()];
        assert_eq!(line_of(&format!("{first}{damaged}{cut}")), 3 * lines_of_a_frame);
    }
}
