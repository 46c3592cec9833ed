//! Checkpoints whose checksum fits and whose content does not, through the whole way of a resumed run.

use std::fs;
use std::path::Path;

use lennard_core::{Array, DVec3, Want};
use lennard_engine::{Action, Operation, ResumeOptions, Schedule, StopAt, Trigger, resume};
use lennard_io::{Checkpoint, FileMark, checkpoint_bytes, read_checkpoint};

use crate::common;

/// Takes a few steps, with everything evaluated at each.
fn a_few(from: u64) -> StopAt {
    let each = Operation::new(Action::Call, Trigger::Always).wanting(Want::ENERGY_AND_VIRIAL);
    StopAt::following(Schedule::empty().with(each), from + 4)
}

/// The checkpoints that fuzzing starts from, as if this version had written them.
fn corpus() -> Vec<(String, Checkpoint)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/restart");
    let mut all: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| {
            let path = entry.unwrap().path();
            let mut checkpoint = read_checkpoint(&path).unwrap();
            checkpoint.metadata.program_version = env!("CARGO_PKG_VERSION").into();
            (path.display().to_string(), checkpoint)
        })
        .collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    assert!(all.len() >= 5, "{}", all.len());
    all
}

struct Bench(tempfile::TempDir);

impl Bench {
    /// Brings a run back and lets it go on for some steps; an error is returned as its text.
    fn restart(&self, checkpoint: &Checkpoint) -> Result<(), String> {
        let path = self.0.path().join("checkpoint-000000000010.lennard");
        // Not synced: hundreds of them need not outlive a power cut.
        fs::write(&path, checkpoint_bytes(checkpoint)).unwrap();
        let mut resumed =
            resume(self.0.path(), &ResumeOptions::default()).map_err(|e| e.to_string())?;
        let mut a_few = a_few(resumed.simulation.state.step);
        resumed.simulation.follow(&mut a_few).map_err(|e| {
            assert!([2, 3].contains(&e.exit_code()), "{e}");
            e.to_string()
        })?;
        drop(resumed.simulation.findings());
        Ok(())
    }
}

/// Every array of every kind of run is taken away, emptied, cut, made longer, given another type, and filled with
/// impossible numbers. The run is brought back or refused by name; it never panics.
#[test]
fn arrays_that_cannot_be_are_refused_by_name_or_harmless() {
    let bench = Bench(common::folder());
    let mut said = Vec::new();
    let mut met = std::collections::HashSet::new();
    for (file, whole) in corpus() {
        assert_eq!(bench.restart(&whole), Ok(()), "{file}");
        for (name, array) in &whole.archive.arrays {
            // One reader takes these from every file: the first that has them shows what it does.
            let is_of_one_reader = !name.starts_with("method/") && !name.starts_with("forces/");
            if is_of_one_reader && !met.insert(name.clone()) {
                continue;
            }
            for (what, changed) in distortions(array) {
                let mut checkpoint = whole.clone();
                match changed {
                    Some(array) => drop(checkpoint.archive.arrays.insert(name.clone(), array)),
                    None => drop(checkpoint.archive.arrays.remove(name)),
                }
                if let Err(message) = bench.restart(&checkpoint) {
                    said.push(message);
                } else {
                    // What a run needs at every step must never be missing, whoever seals the file.
                    let needed =
                        ["state/positions", "state/velocities", "method/half_step_velocities"];
                    let harmless = !needed.contains(&name.as_str()) || what == "one number changed";
                    assert!(harmless, "{file}: {name}, {what} was taken");
                }
            }
        }
    }
    for wanted in [
        "the saved state has no entry `state/velocities`",
        "the saved entry `state/step` has another type",
        "the saved entry `state/velocities` does not fit: 31 particles, wanted 32",
        "`run/seconds` does not fit: 3 values, wanted 4",
        "`method/half_step_velocities` does not fit: 31 particles, wanted 32",
        "particle 0 has a number that is not finite",
        "vectors for 2 origins of 3",
        " vectors, wanted ",
        " columns, wanted ",
        " blocks of ",
        "2 boxes, wanted 1",
        "it has no particles",
    ] {
        assert!(
            said.iter().any(|m| m.contains(wanted)),
            "nothing said `{wanted}`:\n{}",
            said.join("\n")
        );
    }
}

fn distortions(array: &Array) -> Vec<(&'static str, Option<Array>)> {
    let absurd = [f64::NAN, 1e308, 0.0];
    let counts = [0, 1 << 40, u64::MAX];
    let other = match array {
        Array::F64(_) => Array::U64(vec![1]),
        _ => Array::F64(vec![1.0]),
    };
    let mut all = vec![("missing", None), ("of another type", Some(other))];
    let mut add = |what, array| all.push((what, Some(array)));
    match array {
        Array::F64(v) => {
            lengths(v, &mut |what, v| add(what, Array::F64(v)));
            absurd.iter().for_each(|&x| add("one number changed", Array::F64(first(v, x))));
        }
        Array::U64(v) => {
            lengths(v, &mut |what, v| add(what, Array::U64(v)));
            for at in 0..v.len().min(3) {
                for &n in &counts {
                    let mut v = v.clone();
                    v[at] = n;
                    add("one number changed", Array::U64(v));
                }
            }
        }
        Array::Vec3(v) => {
            lengths(v, &mut |what, v| add(what, Array::Vec3(v)));
            absurd
                .iter()
                .for_each(|&x| add("one number changed", Array::Vec3(first(v, DVec3::splat(x)))));
        }
    }
    all
}

fn lengths<T: Clone>(values: &[T], add: &mut dyn FnMut(&'static str, Vec<T>)) {
    add("empty", vec![]);
    if let [shorter @ .., last] = values {
        add("shorter", shorter.to_vec());
        add("longer", [values, std::slice::from_ref(last)].concat());
    }
}

fn first<T: Clone>(values: &[T], value: T) -> Vec<T> {
    let mut changed = values.to_vec();
    if let Some(one) = changed.first_mut() {
        *one = value;
    }
    changed
}

#[test]
fn metadata_that_does_not_fit_is_refused() {
    let bench = Bench(common::folder());
    let (_, whole) = corpus().swap_remove(0);
    let refused = |change: &dyn Fn(&mut Checkpoint), wanted: &str| {
        let mut checkpoint = whole.clone();
        change(&mut checkpoint);
        let message = bench.restart(&checkpoint).unwrap_err();
        assert!(message.contains(wanted), "wanted `{wanted}` in\n{message}");
    };
    let with = |name: &'static str, counts: &'static [u64]| {
        move |c: &mut Checkpoint| {
            let counts = Array::U64(counts.to_vec());
            c.archive.arrays.insert(name.into(), counts);
        }
    };
    refused(&|c| c.metadata.step = u64::MAX, "its state belongs to another step");
    refused(
        &|c| {
            let mark = FileMark::default();
            c.metadata.files.insert("trajectory.xyz".into(), mark);
        },
        "scene and checkpoint disagree whether there is a",
    );
    refused(&|c| c.metadata.files.clear(), "it does not say how long thermo.csv was");
    refused(&|c| c.scene.push_str("[[stage]]\n"), "does not fit its own scene");
    refused(&with("stage", &[0, 7]), "steps after ");
    refused(&with("stage", &[9, 1]), "stage 9 of 2");
    refused(&with("measured_steps", &[1 << 50]), "`measured_steps` does not fit: ");
    refused(&with("measured_steps", &[u64::MAX]), "a count of 18446744073709551615");
}
