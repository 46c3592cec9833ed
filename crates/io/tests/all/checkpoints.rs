//! Checkpoints: exact, and refused when they are not.

use crate::common::{mutate, noise, scratch};
use glam::DVec3;
use lennard_core::{Array, Own, StateArchive};
use lennard_io::{
    Checkpoint, CheckpointFolder, CheckpointMetadata, CheckpointProblem, FileMark, read_checkpoint,
    read_checkpoint_bytes, write_checkpoint,
};
use proptest::prelude::*;
use rand::RngExt;

pub fn checkpoint(step: u64) -> Checkpoint {
    let mut archive = StateArchive::default();
    let mut writer = archive.writer();
    writer.put_f64("time", &[0.1, f64::NAN, -0.0, f64::MIN_POSITIVE / 2.0]);
    writer.put_u64("images", &[0, 1, 2, 3]);
    writer.put_u64("step", &[step, u64::MAX]);
    let many: Vec<DVec3> = (0..9000).map(|i| DVec3::splat(f64::from(i)).sqrt()).collect();
    writer.section("integrator").put_vec3("previous", &many);
    writer.put_vec3("none", &[]);
    Checkpoint {
        metadata: CheckpointMetadata {
            program_version: "0.1.0".into(),
            scene_name: "triple-point".into(),
            isa: "avx2".into(),
            precision: "double".into(),
            step,
            files: [("thermo.csv".to_string(), FileMark { bytes: 77, records: 3 })].into(),
            ..CheckpointMetadata::default()
        },
        scene: "[system]\nτ = \"ε\"\n".into(),
        archive,
    }
}

fn bytes_of(checkpoint: &Checkpoint) -> Vec<u8> {
    let (_folder, path) = scratch("c");
    write_checkpoint(&path, checkpoint).unwrap();
    std::fs::read(path).unwrap()
}

/// Bits, since NaN differs from itself.
fn bits(array: &Array) -> (u8, Vec<u64>) {
    match array {
        Array::F64(v) => (0, v.iter().map(|x| x.to_bits()).collect()),
        Array::U64(v) => (2, v.clone()),
        Array::Vec3(v) => (3, v.iter().flat_map(|r| r.to_array().map(f64::to_bits)).collect()),
    }
}

fn assert_same(a: &Checkpoint, b: &Checkpoint) {
    assert_eq!(a.metadata, b.metadata);
    assert_eq!(a.scene, b.scene);
    assert!(a.archive.arrays.keys().eq(b.archive.arrays.keys()));
    for (name, array) in &a.archive.arrays {
        assert!(bits(array) == bits(&b.archive.arrays[name]), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn any_arrays_come_back_to_the_bit(
        numbers in proptest::collection::vec(any::<u64>(), 0..300),
        names in proptest::collection::btree_set("[a-zé/_]{0,12}", 0..8),
        step in any::<u64>(), scene in "\\PC{0,80}",
    ) {
        let mut written = checkpoint(step);
        written.scene = scene;
        written.archive = StateArchive::default();
        for (i, name) in names.into_iter().enumerate() {
            let floats = || numbers.iter().map(|&w| f64::from_bits(w));
            let array = match i % 3 {
                0 => Array::F64(floats().collect()),
                1 => Array::U64(numbers.clone()),
                _ => Array::Vec3(floats().map(|x| DVec3::new(x, -x, 1.0)).collect()),
            };
            written.archive.arrays.insert(name, array);
        }
        let bytes = bytes_of(&written);
        assert_same(&written, &read_checkpoint_bytes(&bytes).unwrap());
        prop_assert!(bytes == bytes_of(&written), "the same state gives the same bytes");
    }
}

#[test]
fn a_flipped_bit_anywhere_is_noticed() {
    let bytes = bytes_of(&checkpoint(12));
    let mut noise = noise(5);
    let near_both_ends = (0..600).chain(bytes.len() - 600..bytes.len());
    let inside = (0..2000).map(|_| noise.random_range(0..bytes.len()));
    for at in near_both_ends.chain(inside.collect::<Vec<_>>()) {
        for bit in [0, 3, 7] {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << bit;
            assert!(read_checkpoint_bytes(&damaged).is_err(), "byte {at}, bit {bit}");
        }
    }
}

/// Puts length and checksum right again, as someone would who wants to be believed.
pub fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.truncate(bytes.len().saturating_sub(4));
    bytes.resize(bytes.len().max(24), 0);
    let length = bytes.len() as u64 + 4;
    bytes[16..24].copy_from_slice(&length.to_le_bytes());
    let sum = crc32fast::hash(&bytes);
    bytes.extend_from_slice(&sum.to_le_bytes());
    bytes
}

#[test]
fn absurd_counts_are_refused_before_memory_is_taken_though_the_checksum_fits() {
    let bytes = bytes_of(&checkpoint(12));
    assert!(read_checkpoint_bytes(&sealed(bytes.clone())).is_ok());
    let metadata = u64::from_le_bytes(bytes[24..32].try_into().unwrap()) as usize;
    let scene = checkpoint(12).scene.len();
    let arrays = 24 + 8 + metadata + 8 + scene;
    let first_count = arrays + 8 + 8 + "images".len() + 8;
    let places = [24, 24 + 8 + metadata, arrays, arrays + 8, first_count];
    for at in places {
        for absurd in [u64::MAX, u64::MAX / 8, 1 << 61, 1 << 40, 1 << 20] {
            let mut bytes = bytes.clone();
            bytes[at..at + 8].copy_from_slice(&absurd.to_le_bytes());
            let problem = read_checkpoint_bytes(&sealed(bytes)).unwrap_err().problem;
            assert!(
                matches!(problem, CheckpointProblem::Malformed(_)),
                "{absurd} at {at}: {problem}"
            );
        }
    }
}

#[test]
fn seeded_mutations_never_panic_with_or_without_a_right_checksum() {
    let mut small = checkpoint(12);
    small.archive.arrays.remove("integrator/previous");
    let bytes = bytes_of(&small);
    let mut noise = noise(20_261);
    let mut taken = 0;
    for _ in 0..20_000 {
        let mutated = mutate(&bytes, &mut noise);
        if mutated != bytes {
            assert!(read_checkpoint_bytes(&mutated).is_err());
        }
        taken += u32::from(read_checkpoint_bytes(&sealed(mutated)).is_ok());
    }
    // Else the mutations would all die early and test nothing behind the checksum.
    assert!(taken > 100, "{taken}");
}

#[test]
fn the_last_two_are_kept_and_an_abandoned_future_is_not() {
    let root = tempfile::tempdir().unwrap();
    let folder = CheckpointFolder::new(root.path());
    assert!(matches!(folder.load_newest(None).unwrap_err().problem, CheckpointProblem::None));
    for step in [5, 10, 100, 1_000_000_000_000] {
        folder.write(&checkpoint(step), &Own::all_of(0)).unwrap();
    }
    let steps = || -> Vec<u64> { folder.list().unwrap().iter().map(|(s, _)| *s).collect() };
    assert_eq!(steps(), [1_000_000_000_000, 100]);
    // Gone on from step 100, since the newer one was damaged.
    folder.write(&checkpoint(150), &Own::all_of(0)).unwrap();
    assert_eq!(steps(), [150, 100]);
    assert_eq!(folder.load_newest(None).unwrap().1.metadata.step, 150);
    folder.write(&checkpoint(150), &Own::all_of(0)).unwrap();
    assert_eq!(steps(), [150, 100], "the same step again replaces itself");
}

#[test]
fn a_failed_write_leaves_the_older_checkpoints_untouched() {
    let root = tempfile::tempdir().unwrap();
    let folder = CheckpointFolder::new(root.path());
    for step in [5, 10] {
        folder.write(&checkpoint(step), &Own::all_of(0)).unwrap();
    }
    // A folder stands where the new file should go: renaming must fail.
    std::fs::create_dir_all(folder.path(15).join("in the way")).unwrap();
    assert!(folder.write(&checkpoint(15), &Own::all_of(0)).is_err());
    assert_same(&read_checkpoint(&folder.path(5)).unwrap(), &checkpoint(5));
    assert_same(&read_checkpoint(&folder.path(10)).unwrap(), &checkpoint(10));
}
