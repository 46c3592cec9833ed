//! Seeded mutations and random bytes through every reader: an answer or an error, never a panic, and
//! what is taken can be taken again.

use crate::common::{frames_of, mutate, noise, scratch, system};
use crate::lammps::{DATA, DUMP};
use lennard_io::{
    FormatError, Frame, FrameStyle, read_configuration_bytes, read_run_record_bytes,
    read_table_csv_bytes, write_frame,
};
use proptest::prelude::*;

const CASES: usize = 30_000;
const RECORD: &[u8] = include_bytes!("../data/run.json");

fn trajectory_text() -> Vec<u8> {
    let (_folder, path) = scratch("f.xyz");
    let mut text = Vec::new();
    for (seed, wrapped) in [(1, true), (2, false)] {
        let style = FrameStyle {
            wrapped,
            forces: !wrapped,
            length_scale: if wrapped { 1.0 } else { 3.405 },
            ..FrameStyle::default()
        };
        let frame = Frame { state: &system(4, 2.0, seed), extra: &[("potential_energy", -5.5)] };
        write_frame(&path, &style, &frame).unwrap();
        text.extend(std::fs::read(&path).unwrap());
    }
    text
}

#[test]
fn mutated_trajectories_are_read_or_refused() {
    let text = trajectory_text();
    assert_eq!(frames_of(&text).unwrap().len(), 2);
    let mut noise = noise(11);
    let (mut read, mut refused) = (0, 0);
    for _ in 0..CASES {
        let mutated = mutate(&text, &mut noise);
        match frames_of(&mutated) {
            Ok(frames) => {
                read += 1;
                for frame in frames {
                    assert!(!frame.positions.is_empty());
                    assert!(frame.positions.iter().all(|r| r.is_finite()));
                    let velocities = frame.velocities.iter().chain(&frame.forces).flatten();
                    assert!(velocities.clone().all(|v| v.is_finite()));
                }
            }
            Err(error) => {
                refused += 1;
                let of_frame = matches!(error, FormatError::Frame { .. });
                assert!(of_frame || error.line().is_some_and(|line| line >= 1));
                assert!(error.to_string().len() < 2000, "{error}");
            }
        }
        let _ = read_configuration_bytes(&mutated);
    }
    // Both ways must be walked for the test to mean anything.
    assert!(read > CASES / 100 && refused > CASES / 2, "{read} {refused}");
}

/// Whether a start is read, which is finite then.
fn finite_start(bytes: &[u8]) -> bool {
    let Ok(start) = read_configuration_bytes(bytes) else { return false };
    let velocities = start.velocities.iter().flatten();
    assert!(start.positions.iter().chain(velocities).all(|v| v.is_finite()));
    assert!(start.cell.volume() > 0.0);
    true
}

/// Whether a reader takes these bytes.
type IsRead = fn(&[u8]) -> bool;

#[test]
fn mutated_starts_tables_and_records_are_read_or_refused() {
    let nist = b"10.0 10.0 10.0\n3\n  1  -1.1E-01  1.3E+00 -8.8E-01\n  2  1 2 3\n  3 4 5 6.5\n";
    let table = "step,time,pressure\n# time [τ]\n# pressure [ε/σ³]: P\n1,0.5,nan\n2,1.0,-3.5e-3\n";
    let all: [(&[u8], IsRead); 5] = [
        (nist, finite_start),
        (DUMP.as_bytes(), finite_start),
        (DATA.as_bytes(), finite_start),
        (table.as_bytes(), |bytes| read_table_csv_bytes(bytes).is_ok()),
        (RECORD, |bytes| read_run_record_bytes(bytes).is_ok()),
    ];
    let mut noise = noise(12);
    for (text, read) in all {
        assert!(read(text));
        let taken = (0..CASES).filter(|_| read(&mutate(text, &mut noise))).count();
        assert!(taken > 100, "{taken} of {}", String::from_utf8_lossy(text));
    }
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = frames_of(&bytes);
        let _ = read_configuration_bytes(&bytes);
        let _ = read_table_csv_bytes(&bytes);
        let _ = read_run_record_bytes(&bytes);
    }

    #[test]
    fn random_headers_never_panic(header in "(Lattice|Properties|pbc|a)?[ =\"{}\\\\:A-Za-z0-9.\u{e9}]{0,60}") {
        let text = format!("1\n{header}\nAr 0.5 0.5 0.5\n");
        let _ = frames_of(text.as_bytes());
    }
}
