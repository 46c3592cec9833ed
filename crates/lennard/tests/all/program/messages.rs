//! Error messages as a user meets them, for what no other test of the command line shows.

use std::fs;

use crate::program::common::*;

#[test]
fn arguments_that_cannot_be_read_come_with_an_example() {
    for (line, wanted) in [
        ("plan fluid/gas --set system.density", "wanted KEY=VALUE, such as system.density=0.8"),
        ("plan fluid/gas --threads 0", "allowed: 1 to "),
        ("run fluid/gas --threads 2048", "allowed: 1 to "),
        ("sweep sweep/arrhenius --threads 65535", "allowed: 1 to "),
        ("study bench fluid/gas --threads 1,10000", "allowed: 1 to "),
        ("list potentials --isa avx2", "unexpected argument"),
    ] {
        refused(line, &[wanted]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn threads_that_the_system_does_not_give_are_no_panic() {
    // Stacks of 400 MB: the third does not fit into one gigabyte. The rest is enough for the small
    // requests of a started thread, at which Rust's runtime would abort.
    let place = Place::with(&[]);
    for line in ["plan fluid/gas --threads 16", "study bench --quick --threads 16 --out out"] {
        let limited =
            format!("ulimit -v 1000000; export RUST_MIN_STACK=400000000; exec lennard {line}");
        ended(&place.shell(&limited), 1, &["starting threads: "]);
    }
}

#[test]
fn a_sweep_says_why_it_cannot_begin_and_how_to_go_on() {
    let sweep = "base = \"base.toml\"\n[grid]\ndensity = [0.5, 0.6]\n";
    let place = Place::with(&[("base.toml", FLUID), ("sweep.toml", sweep), ("file", "")]);
    let folder = "making the output folder: the output folder file/out cannot be made";
    place.refused("sweep sweep.toml --out file/out", &[folder]);
    place.refused("sweep nowhere.toml", &["the sweep: nowhere.toml: cannot be read: "]);
    let line = "sweep sweep.toml --out out --quiet --no-report";
    place.succeed(line);
    let allowed = "allowed: an empty folder, or what this sweep wrote there; give another --out, or --force to replace the runs of this sweep";
    let other = format!("{line} --set truncation.r_cut=2");
    place.refused(&other, &["it holds the run of another scene", allowed]);
    for entry in fs::read_dir(place.path("out")).unwrap() {
        let record = entry.unwrap().path().join("run.json");
        if record.exists() {
            fs::write(record, "{}").unwrap();
        }
    }
    place.refused(line, &["its run.json cannot be read: ", allowed]);
}

#[test]
fn a_run_that_cannot_be_compared_says_why() {
    let place =
        Place::with(&[("first.toml", FLUID), ("next.toml", &fluid_from("first/final.xyz"))]);
    for name in ["first", "next"] {
        place.succeed(&format!("run {name}.toml --out {name} --quiet --no-report"));
    }
    fs::remove_file(place.path("next/final.xyz")).unwrap();
    place.refused("compare next", &["next: the box of the run is not known: ", "final.xyz"]);
    fs::create_dir(place.path("empty")).unwrap();
    let words = [
        "empty holds no run: it has no run.json",
        "allowed: the output folder of a run, such as runs/triple-point-1",
    ];
    place.refused("compare empty", &words);
}
