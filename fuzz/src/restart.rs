//! Checkpoints with a right checksum and a wrong content, through the whole way of a resumed run.

use std::cell::RefCell;

use lennard_core::{Array, DVec3, Want};
use lennard_engine::{Action, Operation, ResumeOptions, Schedule, StopAt, Trigger, resume};
use lennard_io::{checkpoint_bytes, read_checkpoint_bytes};

use crate::targets::judged;

/// Steps that a run takes which was accepted: what was restored is used, observed and saved again.
const STEPS: u64 = 4;

/// Names of the files that a run leaves.
const CHECKPOINT: &str = "checkpoint-000000000010.lennard";

thread_local! {
    static FOLDER: RefCell<Option<tempfile::TempDir>> = const { RefCell::new(None) };
}

/// Takes a few steps, with everything evaluated at each.
fn a_few(from: u64) -> StopAt {
    let each = Operation::new(Action::Call, Trigger::Always).wanting(Want::ENERGY_AND_VIRIAL);
    StopAt::following(Schedule::empty().with(each), from + STEPS)
}

/// In memory where the system has such a place: a disk would make each input ten times as long.
pub(crate) fn temporary() -> tempfile::TempDir {
    tempfile::tempdir_in("/dev/shm")
        .unwrap_or_else(|_| tempfile::tempdir().expect("a temporary folder can be made"))
}

/// Resumes a run from the bytes for some steps.
/// Bytes without a run must give an error of a known kind, with a message of reasonable length.
///
/// # Panics
/// Where something is wrong with the program.
pub(crate) fn restart(bytes: &[u8]) -> bool {
    FOLDER.with_borrow_mut(|folder| {
        let folder = folder.get_or_insert_with(temporary);
        std::fs::write(folder.path().join(CHECKPOINT), bytes)
            .expect("a temporary file can be written");
        let resumed = resume(folder.path(), &ResumeOptions::default());
        let went_on = resumed.and_then(|mut resumed| {
            let from = resumed.simulation.state.step;
            resumed.simulation.follow(&mut a_few(from))?;
            // What observables make of it must be no panic either.
            drop(resumed.simulation.findings());
            Ok(())
        });
        judged(went_on, drop)
    })
}

/// Numbers that have no business in a saved run.
const ABSURD: [f64; 10] =
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 1e-308, 0.0, -1.0, 1e10, 0.5];
const ABSURD_COUNTS: [u64; 8] = [0, 1, 2, 1000, 1 << 31, 1 << 40, u64::MAX / 2, u64::MAX];

/// Wrong lengths, types and values, missing and foreign arrays, other counts of steps: whatever the checksum, sealed
/// anew, would vouch for.
pub fn reshape(bytes: &mut Vec<u8>, below: &mut dyn FnMut(usize) -> usize) {
    let Ok(mut checkpoint) = read_checkpoint_bytes(bytes) else {
        return;
    };
    let arrays = &mut checkpoint.archive.arrays;
    let names: Vec<String> = arrays.keys().cloned().collect();
    if names.is_empty() {
        return;
    }
    let name = names[below(names.len())].clone();
    let other = names[below(names.len())].clone();
    match below(10) {
        0 => drop(arrays.remove(&name)),
        1 => {
            if let Some(foreign) = arrays.get(&other).cloned() {
                arrays.insert(name, foreign);
            }
        }
        2 => {
            let empty = [Array::F64(vec![]), Array::U64(vec![]), Array::Vec3(vec![])];
            arrays.insert(name, empty[below(empty.len())].clone());
        }
        3 => drop(arrays.insert(format!("{name}/{}", below(9)), Array::F64(vec![0.0]))),
        4 => checkpoint.metadata.step = ABSURD_COUNTS[below(ABSURD_COUNTS.len())],
        _ => {
            if let Some(array) = arrays.get_mut(&name) {
                distort(array, below);
            }
        }
    }
    *bytes = checkpoint_bytes(&checkpoint);
}

fn distort(array: &mut Array, below: &mut dyn FnMut(usize) -> usize) {
    fn of<T: Clone>(values: &mut Vec<T>, below: &mut dyn FnMut(usize) -> usize, value: T) {
        let at = below(values.len());
        match below(4) {
            0 => drop(values.pop()),
            1 => values.push(value),
            2 => values.extend_from_slice(&values.clone()),
            _ => {
                if let Some(one) = values.get_mut(at) {
                    *one = value;
                }
            }
        }
    }
    let number = ABSURD[below(ABSURD.len())];
    let count = ABSURD_COUNTS[below(ABSURD_COUNTS.len())];
    match array {
        Array::F64(values) => of(values, below, number),
        Array::U64(values) => of(values, below, count),
        Array::Vec3(values) => of(values, below, DVec3::splat(number)),
    }
}
