//! The compression of XTC, read back by another program's reader.

use std::path::Path;

use glam::DVec3;
use lennard_core::State;
use lennard_io::{FileUnits, Frame, FrameStyle, Frames, TrajectoryFormat, TrajectoryWriter};
use molly::{Magic, XTCReader, XTCWriter};
use proptest::prelude::*;

use crate::common::{cell, refused, scratch};

/// A power of two: readers multiply by its inverse in single precision, which is exact then.
const PRECISION: f64 = 8192.0;
const BOX: [f32; 9] = [9.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 9.0];

fn style() -> FrameStyle {
    FrameStyle { precision: PRECISION, wrapped: false, velocities: false, ..FrameStyle::default() }
}

fn write(path: &Path, positions: &[[i32; 3]]) -> u64 {
    let place = |p: &[i32; 3]| DVec3::from_array(p.map(|x| f64::from(x) / PRECISION));
    let positions: Vec<DVec3> = positions.iter().map(place).collect();
    let velocities = vec![DVec3::ZERO; positions.len()];
    let state = State::new(cell(), positions, velocities);
    let mut writer = TrajectoryWriter::create(path, TrajectoryFormat::Xtc, &style()).unwrap();
    let extra = &[];
    writer.write(&Frame { state: &state, extra }).unwrap();
    writer.mark().bytes
}

/// Writes multiples of 1/precision, has them read back, and gives the bytes of the file.
fn round_trip(positions: &[[i32; 3]]) -> u64 {
    let (_folder, path) = scratch("t.xtc");
    let bytes = write(&path, positions);
    let frames = XTCReader::open(&path).unwrap().read_all_frames().unwrap();
    assert_eq!(frames.len(), 1);
    let whole = |x: f32| (f64::from(x) * PRECISION).round() as i32;
    let read: Vec<[i32; 3]> =
        frames[0].coords().map(|p| glam::Vec3::from(p).to_array().map(whole)).collect();
    assert_eq!(read, positions);
    assert_eq!(read_back(&path), positions);
    bytes
}

/// The multiples that our reader finds in the first frame of a file.
fn read_back(path: &Path) -> Vec<[i32; 3]> {
    let mut frames = Frames::open(path, FileUnits::default()).unwrap();
    let frame = frames.next_frame().unwrap().unwrap();
    assert_eq!(
        frame.rounding,
        if frame.positions.len() > 9 { 1.0 / PRECISION } else { frame.rounding }
    );
    assert!(frames.next_frame().unwrap().is_none());
    frame.positions.iter().map(|r| (*r * PRECISION).to_array().map(|x| x.round() as i32)).collect()
}

/// Steps of a walk, as large as 2^`octave` at most on each axis, from a corner.
fn walk(n: usize, octave: u32, corner: i32, mut random: impl FnMut() -> u32) -> Vec<[i32; 3]> {
    let mut at = [corner; 3];
    let mut step = || {
        at = at.map(|x| {
            let by = (random() % (2 << octave)) as i32 - (1 << octave);
            (x + by).clamp(-16_000_000, 16_000_000)
        });
        at
    };
    (0..n).map(|_| step()).collect()
}

/// Numbers that look random.
fn generator(seed: u64) -> impl FnMut() -> u32 {
    let mut state = seed;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as u32
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn every_walk_reads_back_to_the_last_multiple(
        n in 1_usize..200,
        octave in 0_u32..25,
        corner in -1_000_000_i32..1_000_000,
        seed in any::<u64>(),
    ) {
        round_trip(&walk(n, octave, corner, generator(seed)));
    }
}

#[test]
fn particles_at_one_place_and_in_two_clusters_read_back() {
    for n in [9, 10, 11, 18, 19, 20, 400] {
        round_trip(&vec![[7, -7, 0]; n]);
        let two = |k: usize| [[0, 1, 2], [16_000_000, -16_000_000, 5]][k / 3 % 2];
        round_trip(&(0..n).map(two).collect::<Vec<_>>());
    }
    // An axis with more multiples than three axes together may have.
    round_trip(&walk(200, 24, 0, generator(1)));
}

#[test]
fn a_fluid_takes_no_more_bytes_than_with_the_usual_choice_of_reach() {
    for octave in [3, 10, 13, 20] {
        let positions = walk(3000, octave, 0, generator(2));
        let ours = round_trip(&positions);
        let places = positions.iter().map(|p| p.map(|x| (f64::from(x) / PRECISION) as f32));
        let places: Vec<[f32; 3]> = places.collect();
        let mut theirs = Vec::new();
        XTCWriter::new_with_magic(&mut theirs, Magic::Xtc1995)
            .write_frame_parts(1, 0.0, BOX, places.iter(), PRECISION as f32)
            .unwrap();
        // Their writer changes the reach within a frame, and ours does not.
        let (_folder, path) = scratch("theirs.xtc");
        std::fs::write(&path, &theirs).unwrap();
        assert_eq!(read_back(&path), positions);
        assert!(ours <= theirs.len() as u64, "{ours} {}", theirs.len());
    }
}

#[test]
fn a_damaged_file_is_refused_by_its_frame_and_never_stops_the_program() {
    let (folder, path) = scratch("t.xtc");
    write(&path, &walk(40, 6, 0, generator(3)));
    let whole = std::fs::read(&path).unwrap();
    let two = [whole.clone(), whole.clone()].concat();
    let damaged = folder.path().join("damaged.xtc");
    let read = |bytes: &[u8]| {
        std::fs::write(&damaged, bytes).unwrap();
        let mut frames = Frames::open(&damaged, FileUnits::default())?;
        let mut found = 0;
        while frames.next_frame()?.is_some() {
            found += 1;
        }
        Ok::<_, lennard_io::FormatError>(found)
    };
    assert_eq!(read(&two).unwrap(), 2);
    for cut in whole.len() + 1..two.len() {
        refused(
            read(&two[..cut]),
            &["frame 2: found the end of the file", "the frame is truncated"],
        );
    }
    let mut random = generator(4);
    for _ in 0..4000 {
        let mut bytes = two.clone();
        for _ in 0..1 + random() % 3 {
            let at = 4 + random() as usize % (bytes.len() - 4);
            bytes[at] ^= 1 << (random() % 8);
        }
        if let Err(error) = read(&bytes) {
            assert!(error.to_string().contains("allowed: "), "{error}");
        }
    }
    let mut other = whole.clone();
    other[4..8].copy_from_slice(&41_u32.to_be_bytes());
    refused(read(&other), &["frame 1: found bytes that begin no frame"]);
}
