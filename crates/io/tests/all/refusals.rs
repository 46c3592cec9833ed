//! What readers and writers refuse. `bad_files.toml` has the words for files, and `inputs/bad.toml` has them for scenes.

use std::collections::BTreeMap;
use std::fs;

use crate::common::scratch;
use lennard_core::State;
use lennard_io::{
    CheckpointProblem, Existing, FolderError, FormatError, Frame, FrameStyle, TableWriter,
    TrajectoryFormat, TrajectoryWriter, WriteError, create_named_folder, read_checkpoint,
    read_checkpoint_bytes, read_configuration_bytes, read_table_csv_bytes, write_checkpoint,
    write_frame, write_table_csv, write_text_atomically,
};
use lennard_observables::Table;

/// `bad_files.toml`, whose head explains it.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct BadFiles {
    bases: BTreeMap<String, String>,
    file: Vec<BadFile>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct BadFile {
    text: Option<String>,
    base: Option<String>,
    change: Option<[String; 2]>,
    answer: String,
}

#[test]
fn every_bad_file_is_refused_with_line_found_and_allowed() {
    let all: BadFiles = toml::from_str(include_str!("../bad_files.toml")).unwrap();
    for file in &all.file {
        let text = match (&file.text, &file.base, &file.change) {
            (Some(text), None, None) => text.clone(),
            (None, Some(base), Some([piece, other])) => {
                assert!(all.bases[base].contains(piece), "{base} has no {piece:?}");
                all.bases[base].replacen(piece, other, 1)
            }
            _ => panic!("{}: a text, or a base with a change", file.answer),
        };
        let error = read_configuration_bytes(text.as_bytes()).expect_err(&text);
        let message = error.to_string();
        assert_eq!(message.split_once(':').unwrap().1, file.answer, "{text}");
        let (line, _) = file.answer.split_once(": found ").expect("what was found");
        assert_eq!(error.line(), line.parse().ok());
    }
    assert!(all.file.len() > 100);
}

#[test]
fn files_that_are_not_there_and_lines_without_end_are_refused() {
    let long = format!("1\nLattice=\"4 0 0 0 5 0 0 0 6\" {}\n", "x".repeat(1 << 20));
    assert_eq!(read_configuration_bytes(long.as_bytes()).unwrap_err().line(), Some(2));
    assert!(read_table_csv_bytes(b"").is_err());
    let folder = tempfile::tempdir().unwrap();
    let absent = folder.path().join("absent");
    let error = lennard_io::read_configuration(&absent).unwrap_err();
    assert!(matches!(error, FormatError::Io { .. }) && error.file() == absent, "{error}");
    let error = read_checkpoint(&absent).unwrap_err();
    assert!(matches!(error.problem, CheckpointProblem::Io(_)) && error.file == absent);
    let newest = lennard_io::CheckpointFolder::new(folder.path()).load_newest(None);
    assert!(matches!(newest.unwrap_err().problem, CheckpointProblem::None));
}

/// A checkpoint whose metadata, scene and arrays are these bytes, with a right length and checksum.
fn sealed(body: &[&[u8]]) -> Vec<u8> {
    let head = b"LENNARD\x1a\x01\0\0\0\0\0\0\0a length";
    crate::checkpoints::sealed([head, &body.concat()[..], b"sum."].concat())
}

fn text(text: &[u8]) -> Vec<u8> {
    [&(text.len() as u64).to_le_bytes(), text].concat()
}

#[test]
fn a_checkpoint_with_a_right_checksum_and_senseless_content_is_refused() {
    let metadata = text(&serde_json::to_vec(&lennard_io::CheckpointMetadata::default()).unwrap());
    let word = |n: u64| n.to_le_bytes().to_vec();
    let array = |name: &[u8], kind, values: u64| {
        [text(name), word(kind), word(values), vec![0; 8 * values as usize]].concat()
    };
    let whole =
        sealed(&[&metadata, &text(b"scene"), &word(2), &array(b"a", 1, 2), &array(b"b", 3, 1)]);
    assert!(read_checkpoint_bytes(&whole).is_ok());
    let start = [metadata.clone(), text(b"scene")].concat();
    let problem = |bytes: &[u8]| read_checkpoint_bytes(bytes).unwrap_err().problem;
    for bytes in [
        sealed(&[&word(1 << 40), b"{}"]),
        sealed(&[&metadata, &text(b"\xff\xfe")]),
        sealed(&[&text(b"{}"), &text(b"")]),
        sealed(&[&start, &word(2), &array(b"b", 1, 1), &array(b"a", 1, 1)]),
        sealed(&[&start, &word(1), &array(b"a", 9, 1)]),
        sealed(&[&start, &word(0), b"more"]),
        sealed(&[&start, &word(1), &text(b"a"), &word(4), &word(u64::MAX)]),
    ] {
        assert!(matches!(problem(&bytes), CheckpointProblem::Malformed(_)), "{}", problem(&bytes));
    }
    let mut other = whole.clone();
    other[8] = 9;
    assert!(matches!(problem(&other), CheckpointProblem::OtherVersion { .. }));
    let mut damaged = whole;
    damaged[30] ^= 1;
    assert!(matches!(problem(&damaged), CheckpointProblem::Damaged));
}

#[test]
fn writers_refuse_what_a_format_cannot_hold() {
    let (folder, path) = scratch("out");
    let state = crate::common::system(3, 0.4, 1);
    let write = |style: &FrameStyle, state: &State, extra: &[(&str, f64)]| {
        write_frame(&path, style, &Frame { state, extra }).unwrap_err()
    };
    let style = FrameStyle::default();
    let changed = |change: &dyn Fn(&mut State)| {
        let mut state = state.clone();
        change(&mut state);
        state
    };
    let scaled = FrameStyle { length_scale: 0.0, ..style.clone() };
    let with_forces = FrameStyle { forces: true, ..style.clone() };
    let ragged = Table::new("t", "ragged").with("a", "", vec![1.0]).with("b", "", vec![]);
    for error in [
        write(&scaled, &state, &[]),
        write(&with_forces, &changed(&|s| s.forces.clear()), &[]),
        write(&style, &changed(&|s| s.forces.truncate(2)), &[]),
        write(&style, &changed(&|s| s.time = f64::NAN), &[]),
        write(&style, &state, &[("a b", 1.0)]),
        write_table_csv(&path, &ragged).unwrap_err(),
    ] {
        assert!(matches!(error, WriteError::Unwritable { .. }), "{error}");
    }
    let error = write(&style, &changed(&|s| s.velocities[2].y = f64::INFINITY), &[]);
    assert!(matches!(error, WriteError::NotFinite { particle: 2, .. }), "{error}");
    assert!(write_text_atomically(folder.path().join("..").as_path(), "x").is_err());
    assert!(!path.exists(), "nothing is left behind");
}

#[test]
fn files_that_were_changed_are_not_resumed() {
    let (folder, path) = scratch("t.csv");
    let columns = [("step", ""), ("time", "τ")];
    let mut table = TableWriter::create(&path, &columns).unwrap();
    table.write(&[1_u64.into(), 0.5.into()]).unwrap();
    let mark = table.mark();
    let other = [("step", ""), ("energy", "ε")];
    let error = TableWriter::resume_at(&path, &other, mark).err().unwrap();
    assert!(matches!(error, WriteError::NotResumable { .. }), "{error}");
    fs::write(&path, "step,time\n# time [τ]\n").unwrap();
    let error = TableWriter::resume_at(&path, &columns, mark).err().unwrap();
    assert!(matches!(error, WriteError::NotResumable { .. }), "{error}");

    let path = folder.path().join("t.xyz");
    let state = crate::common::system(2, 0.4, 1);
    let frame = Frame { state: &state, extra: &[] };
    let mut trajectory =
        TrajectoryWriter::create(&path, TrajectoryFormat::Xyz, &FrameStyle::default()).unwrap();
    fs::remove_file(&path).unwrap();
    assert!(matches!(trajectory.write(&frame), Err(WriteError::Vanished { .. })));
    assert!(matches!(trajectory.write(&frame), Err(WriteError::GivenUp { .. })));
}

#[test]
fn an_output_folder_that_is_not_free_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let busy = create_named_folder(folder.path(), Existing::Refuse);
    assert!(matches!(busy, Err(FolderError::Exists { .. })));
    let file = create_named_folder(&folder.path().join("file"), Existing::Replace);
    assert!(matches!(file, Err(FolderError::NotAFolder { .. })));
    let inside = folder.path().join("file/in/it");
    assert!(write_checkpoint(&inside, &crate::checkpoints::checkpoint(1)).is_err());
}
