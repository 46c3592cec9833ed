//! The command line of `lennard-mpi` on ranks that are threads: the files of `lennard`, and one exit code for all.

use std::ffi::OsString;
use std::fs;
use std::path::Path;

use lennard_core::team_of_threads;

use crate::program::common::{root, succeed};

/// The exit codes of all ranks.
fn on_ranks(ranks: usize, arguments: &[&str]) -> Vec<u8> {
    team_of_threads(ranks, |team| {
        let words = ["lennard-mpi"].into_iter().chain(arguments.iter().copied());
        lennard::program::main_on_ranks(words.map(OsString::from), &team)
    })
}

fn same(one: &Path, other: &Path) {
    for name in ["final.xyz", "thermo.csv", "scene.toml"] {
        let [a, b] = [one, other].map(|folder| fs::read(folder.join(name)).unwrap());
        assert!(a == b, "{name}");
    }
}

#[test]
fn ranks_write_what_one_process_writes_and_go_on_with_it() {
    let root = root();
    let scene = root.join("inputs/bench/fluid-864.toml");
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (alone, team) = (path("alone"), path("team"));
    let scene = scene.display().to_string();
    let quiet = ["--quiet", "--no-report", "--threads", "1"];
    let stages = ["--set", "checkpoint.every_steps=50"];
    let run = |out: &'_ str| -> Vec<String> {
        let words = ["run", &scene, "--out", out].into_iter();
        words.chain(quiet).chain(stages).map(str::to_owned).collect()
    };
    let words = run(&alone);
    succeed(&words.iter().map(String::as_str).collect::<Vec<_>>());
    let words = run(&team);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    assert_eq!(on_ranks(3, &words), [0; 3]);
    same(alone.as_ref(), team.as_ref());
    // The folder is taken: rank 0 alone finds it, and all end.
    assert_eq!(on_ranks(2, &words), [2; 2]);
    let longer = |folder: &str| -> Vec<String> {
        let words = ["resume", folder, "--steps", "40"].into_iter();
        words.chain(quiet).map(str::to_owned).collect()
    };
    let words = longer(&alone);
    succeed(&words.iter().map(String::as_str).collect::<Vec<_>>());
    let words = longer(&team);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    assert_eq!(on_ranks(2, &words), [0; 2]);
    same(alone.as_ref(), team.as_ref());
}

#[test]
fn wrong_input_ends_all_ranks_with_the_same_code() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").display().to_string();
    let scene = root().join("inputs/bench/fluid-864.toml").display().to_string();
    let quiet = ["--quiet", "--no-report", "--out", &out];
    for wrong in [
        &["run", &scene, "--set", "system.densty=1"][..],
        &["run", &scene, "--threads", "0"],
        &["run", "no-such-scene.toml"],
        &["resume", "no-such-folder"],
        &["sweep", &scene],
    ] {
        let out = if wrong[0] == "run" { &quiet[..] } else { &[] };
        assert_eq!(on_ranks(3, &[wrong, out].concat()), [2; 3], "{wrong:?}");
    }
    // 864 particles are 18 parts.
    let words = [&["run", &scene][..], &quiet].concat();
    assert_eq!(on_ranks(19, &words), [2; 19]);
    assert!(!folder.path().join("out").exists());
}
