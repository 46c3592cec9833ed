//! Error messages as a user meets them, for what no other test of the command line shows.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::program::common::{lennard, root, stderr, stdout};

const SCENE: &str = "[system]\nn_atoms = 108\ndensity = 0.7\ntemperature = 1.5\n[truncation]\nr_cut = 2.2\n\
                     [[stage]]\nname = \"production\"\nsteps = 100\n";

fn refused(output: &Output, code: i32, words: &[&str]) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{message}{}", stdout(output));
    for word in words {
        assert!(message.contains(word), "wanted `{word}` in\n{message}");
    }
}

fn within(folder: &Path, arguments: &[&str]) -> Output {
    lennard(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn arguments_that_cannot_be_read_come_with_an_example() {
    let (scene, sweep) = ("inputs/fluid/gas.toml", "inputs/sweep/arrhenius.toml");
    for (arguments, wanted) in [
        (
            ["plan", scene, "--set", "system.density"],
            "wanted KEY=VALUE, such as system.density=0.8",
        ),
        (
            ["run", scene, "--max-walltime", "0s"],
            "wanted a time above zero, such as 90s, 10m, 2h or 1h30m",
        ),
        (["run", scene, "--max-walltime", "10x"], "; wanted a time such as 90s, 10m, 2h or 1h30m"),
        (["plan", scene, "--threads", "0"], "allowed: 1 to "),
        (["run", scene, "--threads", "2048"], "allowed: 1 to "),
        (["sweep", sweep, "--threads", "65535"], "allowed: 1 to "),
        (["list", "potentials", "--isa", "avx2"], "unexpected argument"),
    ] {
        refused(&lennard(&arguments).output().unwrap(), 2, &[wanted]);
    }
    let bench = ["study", "bench", scene, "--threads", "1,10000"];
    refused(&lennard(&bench).output().unwrap(), 2, &["allowed: 1 to "]);
}

#[cfg(target_os = "linux")]
#[test]
fn threads_that_the_system_does_not_give_are_no_panic() {
    // Stacks of 400 MB: the third does not fit into one gigabyte. The rest is enough for the small
    // requests of a started thread, at which Rust's runtime would abort.
    for (command, wanted) in [
        ("plan inputs/fluid/gas.toml --threads 16", "starting threads: "),
        ("study bench --quick --threads 16 --out", "starting threads: "),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let out = match command.ends_with("--out") {
            true => folder.path().join("out").display().to_string(),
            false => String::new(),
        };
        let script = format!(
            "ulimit -v 1000000; export RUST_MIN_STACK=400000000; exec '{}' {command} {out}",
            env!("CARGO_BIN_EXE_lennard")
        );
        let output = Command::new("sh").args(["-c", &script]).current_dir(root()).output().unwrap();
        refused(&output, 1, &[wanted]);
    }
}

#[test]
fn a_sweep_says_why_it_cannot_begin_and_how_to_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("base.toml"), SCENE).unwrap();
    fs::write(path.join("sweep.toml"), "base = \"base.toml\"\n[grid]\ndensity = [0.5, 0.6]\n")
        .unwrap();
    fs::write(path.join("file"), "").unwrap();
    refused(
        &within(path, &["sweep", "sweep.toml", "--out", "file/out"]),
        2,
        &["making the output folder: the output folder file/out cannot be made"],
    );
    refused(
        &within(path, &["sweep", "nowhere.toml"]),
        2,
        &["the sweep: nowhere.toml: cannot be read: "],
    );

    let sweep = ["sweep", "sweep.toml", "--out", "out", "--quiet", "--no-report"];
    assert!(within(path, &sweep).status.success());
    let allowed = "allowed: an empty folder, or what this sweep wrote there; give another --out, or --force to replace the runs of this sweep";
    let mut other = sweep.to_vec();
    other.extend(["--set", "truncation.r_cut=2"]);
    refused(&within(path, &other), 2, &["it holds the run of another scene", allowed]);
    for entry in fs::read_dir(path.join("out")).unwrap() {
        let record = entry.unwrap().path().join("run.json");
        if record.exists() {
            fs::write(record, "{}").unwrap();
        }
    }
    refused(&within(path, &sweep), 2, &["its run.json cannot be read: ", allowed]);
}

#[test]
fn a_run_that_cannot_be_compared_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("first.toml"), SCENE).unwrap();
    assert!(
        within(path, &["run", "first.toml", "--out", "first", "--quiet", "--no-report"])
            .status
            .success()
    );
    let next = SCENE.replace(
        "[system]\nn_atoms = 108\ndensity = 0.7",
        "start = { kind = \"file\", file = \"first/final.xyz\" }\n[system]",
    );
    fs::write(path.join("next.toml"), next).unwrap();
    assert!(
        within(path, &["run", "next.toml", "--out", "next", "--quiet", "--no-report"])
            .status
            .success()
    );
    fs::remove_file(path.join("next/final.xyz")).unwrap();
    refused(
        &within(path, &["compare", "next"]),
        2,
        &["next: the box of the run is not known: ", "final.xyz"],
    );
    fs::create_dir(path.join("empty")).unwrap();
    let wanted = [
        "empty holds no run: it has no run.json",
        "allowed: the output folder of a run, such as runs/triple-point-1",
    ];
    refused(&within(path, &["compare", "empty"]), 2, &wanted);

    let shifted = [
        "run",
        "first.toml",
        "--out",
        "shifted",
        "--quiet",
        "--no-report",
        "--set",
        "truncation.kind=force-shift",
    ];
    let more = ["--set", "observable=[{kind=\"msd\"}]"];
    assert!(within(path, &[&shifted[..], &more].concat()).status.success());
    let compared = within(path, &["compare", "shifted"]);
    let said = stdout(&compared).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains("the tables of transport coefficients are for the full Lennard-Jones potential, this model is another: not compared")
            || said.contains("no equation of state for"),
        "{said}"
    );
}
