//! The command line of `lennard-mpi` on ranks that are threads: the files of `lennard`, and one exit code for all.

use std::ffi::OsString;

use lennard_core::team_of_threads;

use crate::program::common::*;

/// The exit codes of all ranks.
fn on_ranks(ranks: usize, line: &str) -> Vec<u8> {
    team_of_threads(ranks, |team| {
        let all = ["lennard-mpi"].into_iter().chain(words(line));
        lennard::program::main_on_ranks(all.map(OsString::from), &team)
    })
}

const FILES: &[&str] = &["final.xyz", "thermo.csv", "scene.toml"];

#[test]
fn ranks_write_what_one_process_writes_and_go_on_with_it() {
    let place = Place::with(&[]);
    let path = |name: &str| place.path(name).display().to_string();
    let (alone, team) = (path("alone"), path("team"));
    let quiet = "--quiet --no-report --threads 1";
    let run = format!(
        "run bench/fluid-864 {quiet} --set system.n_atoms=4000 --set checkpoint.every_steps=50 --out"
    );
    place.succeed(&format!("{run} {alone}"));
    assert_eq!(on_ranks(3, &format!("{run} {team}")), [0; 3]);
    place.same("alone", "team", FILES);
    // The folder is taken: rank 0 alone finds it, and all end.
    assert_eq!(on_ranks(2, &format!("{run} {team}")), [2; 2]);
    let more = format!("--steps 40 {quiet}");
    place.succeed(&format!("resume {alone} {more}"));
    assert_eq!(on_ranks(2, &format!("resume {team} {more}")), [0; 2]);
    place.same("alone", "team", FILES);
}

#[test]
fn wrong_input_ends_all_ranks_with_the_same_code() {
    let place = Place::with(&[]);
    let out = format!("--quiet --no-report --out {}", place.path("out").display());
    for wrong in [
        &format!("run bench/fluid-864 {out} --set system.densty=1"),
        &format!("run bench/fluid-864 {out} --threads 0"),
        &format!("run no-such-scene.toml {out}"),
        "resume no-such-folder",
        "sweep bench/fluid-864",
    ] {
        assert_eq!(on_ranks(3, wrong), [2; 3], "{wrong}");
    }
    // Too few particles for ranks, and for so many of them.
    assert_eq!(on_ranks(2, &format!("run bench/fluid-864 {out}")), [2; 2]);
    assert_eq!(
        on_ranks(9, &format!("run bench/fluid-864 {out} --set system.n_atoms=4000")),
        [2; 9]
    );
    assert!(!place.has("out"));
}
