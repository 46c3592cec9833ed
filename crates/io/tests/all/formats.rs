//! Every format of a trajectory, written and read back.

use std::fs;
use std::path::Path;

use glam::DVec3;
use lennard_core::{Species, SpeciesTable, State};
use lennard_io::{
    FileMark, Frame, FrameStyle, StartConfiguration, TrajectoryFormat, TrajectoryWriter,
    WriteError, read_configuration, read_configuration_bytes,
};
use molly::XTCReader;

use crate::common::{cell, refused, scratch, system};

const N: usize = 400;

fn style(format: TrajectoryFormat) -> FrameStyle {
    FrameStyle { velocities: format.spec().holds_vectors, ..FrameStyle::default() }
}

fn states() -> Vec<State> {
    let state = |k: u64| State { step: 100 * k, time: 0.4 * k as f64, ..system(N, 2.0, 7 + k) };
    (1..=3).map(state).collect()
}

fn frame(state: &State) -> Frame<'_> {
    Frame { state, extra: &[] }
}

/// Writes these frames and gives the marks behind each.
fn write(
    path: &Path,
    format: TrajectoryFormat,
    style: &FrameStyle,
    states: &[State],
) -> Vec<FileMark> {
    let mut writer = TrajectoryWriter::create(path, format, style).unwrap();
    let marks = states.iter().map(|state| {
        writer.write(&frame(state)).unwrap();
        writer.mark()
    });
    let marks = marks.collect();
    writer.sync().unwrap();
    marks
}

fn read(path: &Path) -> StartConfiguration {
    read_configuration(path).unwrap()
}

#[test]
fn every_format_goes_on_after_a_mark_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let states = states();
    for &format in TrajectoryFormat::ALL {
        let style = style(format);
        let (whole, split) = (folder.path().join("whole"), folder.path().join("split"));
        let marks = write(&whole, format, &style, &states);
        write(&split, format, &style, &states[..2]);
        let mut bytes = fs::read(&split).unwrap();
        // A process killed in the middle of a frame.
        bytes.truncate(bytes.len() - 5);
        fs::write(&split, bytes).unwrap();
        let mut writer = TrajectoryWriter::resume_at(&split, format, &style, marks[0]).unwrap();
        for state in &states[1..] {
            writer.write(&frame(state)).unwrap();
        }
        assert_eq!(writer.mark(), marks[2]);
        assert!(fs::read(&whole).unwrap() == fs::read(&split).unwrap(), "{format:?}");
        let cut = FileMark { bytes: marks[2].bytes + 1, records: 3 };
        let error = TrajectoryWriter::resume_at(&split, format, &style, cut).unwrap_err();
        assert!(matches!(error, WriteError::NotResumable { .. }), "{error}");
    }
}

/// Formats of text have every digit: what is read is what was written, but for positions that were folded.
#[test]
fn text_formats_read_back_to_the_bit() {
    let (_folder, path) = scratch("trajectory");
    let states = states();
    let last = &states[2];
    for format in [TrajectoryFormat::Xyz, TrajectoryFormat::XyzGz, TrajectoryFormat::LammpsDump] {
        for wrapped in [false, true] {
            let style = FrameStyle { wrapped, forces: true, ..style(format) };
            write(&path, format, &style, &states);
            let start = read(&path);
            assert_eq!((start.cell, start.frames), (cell(), 3));
            assert_eq!(start.step, Some(300));
            assert_eq!(start.velocities.as_ref().unwrap(), &last.velocities);
            assert_eq!(start.species.names, ["Ar"]);
            for (read, written) in start.positions.iter().zip(&last.positions) {
                let most = if wrapped { 1e-14 * 12.25 } else { 0.0 };
                assert!((*read - *written).abs().max_element() <= most, "{format:?}");
            }
        }
    }
}

#[test]
fn gzip_has_the_text_of_extended_xyz_and_takes_half_the_space() {
    let folder = tempfile::tempdir().unwrap();
    let (text, gzip) = (folder.path().join("a"), folder.path().join("b"));
    // More than one member.
    let states = [system(12_000, 0.5, 3)];
    write(&text, TrajectoryFormat::Xyz, &style(TrajectoryFormat::Xyz), &states);
    write(&gzip, TrajectoryFormat::XyzGz, &style(TrajectoryFormat::XyzGz), &states);
    let text = fs::read(&text).unwrap();
    let mut inflated = Vec::new();
    let compressed = fs::read(&gzip).unwrap();
    let mut decoder = flate2::read::MultiGzDecoder::new(compressed.as_slice());
    std::io::Read::read_to_end(&mut decoder, &mut inflated).unwrap();
    assert!(text.len() > 1 << 20 && inflated == text);
    assert!(2 * compressed.len() < text.len() + text.len() / 5);
    refused(read_configuration_bytes(&compressed[..compressed.len() / 2]), &["truncated"]);
}

#[test]
fn xtc_has_positions_within_half_its_precision_and_the_box_in_single_precision() {
    let (_folder, path) = scratch("trajectory.xtc");
    let states = states();
    for (precision, length_scale, wrapped) in
        [(1e4, 1.0, true), (1e5, 0.3405, true), (1e3, 2.0, false)]
    {
        let style = FrameStyle { precision, length_scale, wrapped, ..style(TrajectoryFormat::Xtc) };
        let marks = write(&path, TrajectoryFormat::Xtc, &style, &states);
        let frames = XTCReader::open(&path).unwrap().read_all_frames().unwrap();
        assert_eq!(frames.len(), 3);
        for (frame, state) in frames.iter().zip(&states) {
            assert_eq!((u64::from(frame.step), frame.time), (state.step, state.time as f32));
            let sides = state.cell.lengths() * length_scale;
            let diagonal = [frame.boxvec[0], frame.boxvec[4], frame.boxvec[8]];
            assert_eq!(diagonal, sides.as_vec3().to_array());
            for (read, position) in frame.coords().zip(&state.positions) {
                let written = match wrapped {
                    true => state.cell.split(*position).0,
                    false => *position,
                };
                let read = glam::Vec3::from(read).as_dvec3() / length_scale;
                // Half a multiple, and the rounding of single precision.
                let most = 0.5 / precision + 25.0 * f64::from(f32::EPSILON);
                assert!((read - written).abs().max_element() <= most, "{read} {written}");
            }
        }
        assert!(marks[2].bytes < 3 * 9 * N as u64, "{} bytes", marks[2].bytes);
    }
}

#[test]
fn xtc_has_the_positions_of_few_particles_in_single_precision() {
    let (_folder, path) = scratch("trajectory.xtc");
    let style = FrameStyle {
        precision: 100.0,
        length_scale: 0.3405,
        wrapped: false,
        ..style(TrajectoryFormat::Xtc)
    };
    for n in 1..=10 {
        let few = [system(n, 2.0, 7), system(n, 2.0, 8)];
        write(&path, TrajectoryFormat::Xtc, &style, &few);
        let frames = XTCReader::open(&path).unwrap().read_all_frames().unwrap();
        for (frame, state) in frames.iter().zip(&few) {
            assert_eq!(frame.natoms(), n);
            for (read, position) in frame.coords().zip(&state.positions) {
                let read = glam::Vec3::from(read);
                let single = (*position * style.length_scale).as_vec3();
                // Ten are the fewest that are rounded to the precision.
                assert_eq!(n < 10, read == single, "{n}: {read} {single}");
            }
        }
    }
}

#[test]
fn xtc_has_less_precision_where_a_coordinate_is_too_large_for_it() {
    let (_folder, path) = scratch("trajectory.xtc");
    for (length_scale, far, kept) in [
        (1.0, 1677.7, 1e4),
        (1.0, -1677.8, 1e3),
        (0.3405, 16_777.0, 1e3),
        (0.3405, -16_778.0, 1e2),
        (1.0, 3e12, 1e-6),
    ] {
        let mut states = states();
        states[1].positions[17].y = far;
        let style = FrameStyle { wrapped: false, length_scale, ..style(TrajectoryFormat::Xtc) };
        let mut writer = TrajectoryWriter::create(&path, TrajectoryFormat::Xtc, &style).unwrap();
        let precisions = states.iter().map(|state| writer.write(&frame(state)).unwrap());
        for (precision, wanted) in precisions.zip([1e4, kept, 1e4]) {
            let off: f64 = precision.unwrap() / wanted - 1.0;
            assert!(off.abs() < 1e-12, "{precision:?} at {far}");
        }
        writer.sync().unwrap();
        let frames = XTCReader::open(&path).unwrap().read_all_frames().unwrap();
        for (read, position) in frames[1].coords().zip(&states[1].positions) {
            let apart = glam::Vec3::from(read).as_dvec3() / length_scale - *position;
            // Half a multiple, and the rounding of single precision.
            let most = 0.5 / kept + 2.0 * far.abs() * f64::from(f32::EPSILON);
            assert!(apart.abs().max_element() <= most, "{apart} at {far}");
        }
    }
}

#[test]
fn xtc_refuses_what_it_cannot_hold_and_leaves_whole_frames() {
    let (_folder, path) = scratch("trajectory.xtc");
    let mut states = states();
    states[1].step = 1 << 31;
    let style = style(TrajectoryFormat::Xtc);
    let mut writer = TrajectoryWriter::create(&path, TrajectoryFormat::Xtc, &style).unwrap();
    writer.write(&frame(&states[0])).unwrap();
    let whole = writer.mark();
    let error = writer.write(&frame(&states[1])).unwrap_err().to_string();
    let wanted = "step: found 2147483648; allowed: at most 2147483647 in XTC";
    assert!(error.contains(wanted), "{error}");
    assert_eq!(writer.mark(), whole);
    assert_eq!(fs::metadata(&path).unwrap().len(), whole.bytes);
    refused(read_configuration(&path), &["an XTC trajectory, whose positions are rounded"]);
}

#[test]
fn frames_for_ase_have_momenta_masses_and_the_energy() {
    let species = Species { name: "heavy".into(), mass: 2.0, element: "Kr".into() };
    let style = FrameStyle {
        species: SpeciesTable::one(species, 2),
        for_ase: true,
        velocities: false,
        ..FrameStyle::default()
    };
    let positions = vec![DVec3::ONE, DVec3::splat(2.0)];
    let velocities = vec![DVec3::X, DVec3::new(0.0, -0.5, 3.0)];
    let state = State::new(cell(), positions, velocities);
    let extra = [("total_potential_energy", -5.5), ("temperature", 1.0)];
    let (_folder, path) = scratch("t.xyz");
    let frame = Frame { state: &state, extra: &extra };
    lennard_io::write_frame(&path, &style, &frame).unwrap();
    assert_eq!(
        fs::read_to_string(&path).unwrap(),
        "2\nLattice=\"10.0 0.0 0.0 0.0 11.5 0.0 0.0 0.0 12.25\" \
         Properties=species:S:1:pos:R:3:map_shift:I:3:masses:R:1:momenta:R:3 pbc=\"T T T\" Time=0.0 Step=0 \
         total_potential_energy=-5.5 energy=-5.5 temperature=1.0 units=lj\n\
         Kr 1.0 1.0 1.0 0 0 0 2.0 2.0 0.0 0.0\n\
         Kr 2.0 2.0 2.0 0 0 0 2.0 0.0 -1.0 6.0\n"
    );
}
