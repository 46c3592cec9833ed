//! What readers and writers say when they refuse, in whole sentences.

use std::fs;

use lennard_core::{State, Table};
use lennard_io::{
    Checkpoint, Existing, Frame, FrameStyle, TableWriter, TrajectoryFormat, TrajectoryWriter,
    create_named_folder, read_checkpoint, read_checkpoint_bytes, read_configuration_bytes,
    read_table_csv_bytes, write_checkpoint, write_frame, write_table_csv, write_text_atomically,
};

const BOX: &str = "Lattice=\"4 0 0 0 5 0 0 0 6\"";

#[test]
fn readers_say_what_they_would_take() {
    let two = "Ar 1 2 3\nAr 2 3 4";
    let frame = |header: &str, rows: &str| format!("2\n{header}\n{rows}\n");
    for (text, wanted) in [
        (
            "two words\n".into(),
            "the number of particles (extended XYZ), three box sides (NIST columns), `ITEM: TIMESTEP` (LAMMPS dump), \
             or a title before `N atoms` (LAMMPS data) or before the number of particles (GRO)",
        ),
        (
            "4\n1 10 9 8 0 0 0\n".into(),
            "allowed: an orthorhombic box; triclinic boxes are not there yet",
        ),
        (
            format!("1\n{BOX} {}\n", "x".repeat(1 << 20)),
            "found a line of more than 1048576 bytes; allowed: shorter lines",
        ),
        (
            "1000\nx\n".into(),
            "at most what the 2 bytes left in the file can hold, 6 bytes per particle",
        ),
        (
            frame(&format!("{BOX} Properties=pos:R:3:velo:R:3:forces:R:3"), two),
            "can hold, 18 bytes per particle: the count is wrong or the frame is truncated",
        ),
        (
            frame(&format!("{BOX} length_scale=1e-320"), two),
            "allowed: a box that its length scale allows",
        ),
        (
            frame(&format!("{BOX} Properties=pos:R:3:mass:R:1"), "1 2 3 1\n2 3 4 2"),
            "found mass 2; allowed: 1, like the particles before: the file names no species",
        ),
        (
            frame(
                &format!("{BOX} length_scale=1e3 Properties=pos:R:3:forces:R:3"),
                "1 2 3 1e306 0 0\n1 2 3 0 0 0",
            ),
            "allowed: numbers that stay finite when the length scale is taken out",
        ),
        (
            frame(&format!("{BOX} units=metal"), two),
            "units lj (reduced units), or `system.length_scale` and `system.time_scale` in the scene: one σ and one τ in units of the file",
        ),
        (frame("Lattice=\"4 0 0", two), "allowed: a value that ends with \""),
        (
            frame(&format!("{BOX} Properties=pos:R"), two),
            "allowed: name:type:width triples joined by colons",
        ),
        (
            frame(&format!("{BOX} Properties=velo:R:3"), two),
            "allowed: positions among them, pos:R:3",
        ),
        (
            frame("Lattice=\"4 1 0 0 5 0 0 0 6\"", two),
            "an orthorhombic box, \"Lx 0.0 0.0 0.0 Ly 0.0 0.0 0.0 Lz\", to 1e-10 of a side; triclinic boxes are not there yet",
        ),
    ] {
        let message = read_configuration_bytes(text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains(wanted), "wanted `{wanted}` in\n{message}");
    }
    let message = read_table_csv_bytes(b"").unwrap_err().to_string();
    assert!(message.ends_with("found no heading; allowed: one heading line"), "{message}");
    let folder = tempfile::tempdir().unwrap();
    let absent = folder.path().join("absent");
    let message = lennard_io::read_configuration(&absent).unwrap_err().to_string();
    assert!(message.contains("absent: cannot be read: "), "{message}");
    let message = read_checkpoint(&absent).unwrap_err().to_string();
    assert!(message.contains("absent: it cannot be read: "), "{message}");
    let message =
        lennard_io::CheckpointFolder::new(folder.path()).load_newest().unwrap_err().to_string();
    assert!(message.ends_with("there is no checkpoint in this folder"), "{message}");
}

/// A checkpoint whose metadata, scene and arrays are these bytes, with a right length and checksum.
fn sealed(body: &[&[u8]]) -> Vec<u8> {
    let body = body.concat();
    let mut bytes = b"LENNARD\x1a\x01\0\0\0\0\0\0\0".to_vec();
    bytes.extend(((24 + body.len() + 4) as u64).to_le_bytes());
    bytes.extend(body);
    let sum = crc32fast::hash(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

fn text(text: &[u8]) -> Vec<u8> {
    [&(text.len() as u64).to_le_bytes(), text].concat()
}

#[test]
fn a_checkpoint_with_a_right_checksum_and_senseless_content_says_what_makes_no_sense() {
    let metadata = text(&serde_json::to_vec(&lennard_io::CheckpointMetadata::default()).unwrap());
    let word = |n: u64| n.to_le_bytes().to_vec();
    let array = |name: &[u8], kind, values: u64| {
        [text(name), word(kind), word(values), vec![0; 8 * values as usize]].concat()
    };
    let whole =
        sealed(&[&metadata, &text(b"scene"), &word(2), &array(b"a", 1, 2), &array(b"b", 3, 1)]);
    assert!(read_checkpoint_bytes(&whole).is_ok());
    let start = [metadata.clone(), text(b"scene")].concat();
    for (bytes, wanted) in [
        (sealed(&[&word(1 << 40), b"{}"]), "the metadata of 1099511627776 bytes, where 2 are left"),
        (sealed(&[&metadata, &text(b"\xff\xfe")]), "the scene is not UTF-8"),
        (
            sealed(&[&text(b"{}"), &text(b"")]),
            "its content makes no sense: the metadata: missing field",
        ),
        (
            sealed(&[&start, &word(2), &array(b"b", 1, 1), &array(b"a", 1, 1)]),
            "its content makes no sense: `a` is not in order",
        ),
        (sealed(&[&start, &word(1), &array(b"a", 9, 1)]), "`a` has the unknown type 9"),
        (sealed(&[&start, &word(0), b"more"]), "4 bytes after the last array"),
        (
            sealed(&[&start, &word(1), &text(b"a"), &word(4), &word(u64::MAX)]),
            "`a` holds 18446744073709551615 values",
        ),
    ] {
        let message = read_checkpoint_bytes(&bytes).unwrap_err().to_string();
        assert!(message.contains(wanted), "wanted `{wanted}` in\n{message}");
    }
    let mut other = whole.clone();
    other[8] = 9;
    let mut damaged = whole;
    damaged[30] ^= 1;
    for (bytes, wanted) in [
        (other, "it has version 9 of the format; this program reads version 1"),
        (damaged, "it is damaged: its content does not fit its checksum"),
    ] {
        let message = read_checkpoint_bytes(&bytes).unwrap_err().to_string();
        assert!(message.ends_with(wanted), "{message}");
    }
}

#[test]
fn writers_say_what_they_do_not_write() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out");
    let state = crate::common::system(3, 0.4, 1);
    let write = |style: &FrameStyle, state: &State, extra: &[(&str, f64)]| {
        let frame = Frame { state, extra };
        write_frame(&path, style, &frame).unwrap_err().to_string()
    };
    let style = FrameStyle::default();
    let changed = |change: &dyn Fn(&mut State)| {
        let mut state = state.clone();
        change(&mut state);
        state
    };
    let scaled = FrameStyle { length_scale: 0.0, ..style.clone() };
    let with_forces = FrameStyle { forces: true, ..style.clone() };
    let table = Table::new("t", "ragged").with("a", "", vec![1.0]).with("b", "", vec![]);
    for (message, wanted) in [
        (
            write(&scaled, &state, &[]),
            "out: length scale: found 0; allowed: a finite positive number",
        ),
        (
            write(&with_forces, &changed(&|s| s.forces.clear()), &[]),
            "arrays of the state: found 3 positions, 3 velocities, 0 forces; allowed: one of each for every particle",
        ),
        (
            write(&style, &changed(&|s| s.forces.truncate(2)), &[]),
            "arrays of the state: found 3 positions, 3 velocities, 2 forces; allowed: one of each for every particle",
        ),
        (
            write(&style, &changed(&|s| s.time = f64::NAN), &[]),
            "number in the header: found Time=NaN; allowed: a finite number",
        ),
        (
            write(&style, &state, &[("a b", 1.0)]),
            "key in the header: found `a b`; allowed: letters, digits and _, but none of",
        ),
        (
            write(&style, &changed(&|s| s.velocities[2].y = f64::INFINITY), &[]),
            "velocity of particle 2 is inf: such a number is not written",
        ),
        (
            write_table_csv(&path, &table).unwrap_err().to_string(),
            "lengths of the columns: found [1, 0]; allowed: at least one column, all of the same length",
        ),
        (
            write_text_atomically(folder.path().join("..").as_path(), "x").unwrap_err().to_string(),
            "cannot create the file: the path names no file",
        ),
    ] {
        assert!(message.contains(wanted), "wanted `{wanted}` in\n{message}");
    }
    assert!(!path.exists(), "nothing is left behind");
}

#[test]
fn files_that_were_changed_are_not_gone_on_with_and_the_reason_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    let columns = [("step", ""), ("time", "τ")];
    let mut table = TableWriter::create(&path, &columns).unwrap();
    table.write(&[1_u64.into(), 0.5.into()]).unwrap();
    let mark = table.mark();
    let other = [("step", ""), ("energy", "ε")];
    let message = TableWriter::resume_at(&path, &other, mark).unwrap_err().to_string();
    let wanted = format!("t.csv: cannot go on after byte {}: it begins with `step,", mark.bytes);
    assert!(
        message.contains(&wanted) && message.contains(", not with the heading `step,ener"),
        "{message}"
    );
    fs::write(&path, "step,time [τ]\n").unwrap();
    let message = TableWriter::resume_at(&path, &columns, mark).unwrap_err().to_string();
    assert!(message.ends_with("the file has only 15 bytes"), "{message}");

    let path = folder.path().join("t.xyz");
    let state = crate::common::system(2, 0.4, 1);
    let frame = Frame { state: &state, extra: &[] };
    let mut trajectory =
        TrajectoryWriter::create(&path, TrajectoryFormat::Xyz, &FrameStyle::default()).unwrap();
    fs::remove_file(&path).unwrap();
    let message = trajectory.write(&frame).unwrap_err().to_string();
    assert!(
        message.ends_with("t.xyz: the file was removed or replaced while the run was writing it"),
        "{message}"
    );
    let message = trajectory.write(&frame).unwrap_err().to_string();
    assert!(
        message.ends_with("t.xyz: not written, since an earlier write to it failed"),
        "{message}"
    );
}

#[test]
fn an_output_folder_that_is_not_free_says_what_would_be() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let message = create_named_folder(folder.path(), Existing::Refuse).unwrap_err().to_string();
    let wanted = "exists and is not empty; allowed: a folder that is not there yet or is empty, or --force to replace the run in it";
    assert!(message.contains(wanted), "{message}");
    let message = create_named_folder(&folder.path().join("file"), Existing::Replace)
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("file is a file; allowed: a folder that is not there yet"),
        "{message}"
    );
    let checkpoint = Checkpoint {
        metadata: lennard_io::CheckpointMetadata::default(),
        scene: String::new(),
        archive: lennard_core::StateArchive::default(),
    };
    let message =
        write_checkpoint(&folder.path().join("file/in/it"), &checkpoint).unwrap_err().to_string();
    assert!(message.contains("cannot create the file: "), "{message}");
}
