//! Tiers of checks, as lists of command lines, and the table at their end.

use std::error::Error;
use std::fs::{self, File};
use std::process::{Child, Command, ExitCode};
use std::time::{Duration, Instant};

use crate::workspace::{Workspace, cargo};
use crate::{book, ledger, python, tidy};

/// A group of checks: its name, and its work.
type Tier = (&'static str, Work);

/// The work of a tier.
enum Work {
    /// A command line of the shell, in the root of the workspace. `{packages}` stands for the chosen crates.
    /// `{apart}` stands for a target folder of their own for commands that run while others compile tests.
    /// `{pytest}` stands for the Python tests with a worker per processor; tests of a file stay in one worker.
    Line(&'static str),
    /// A command line beside which the next tiers run: a test program ends on one processor while others wait.
    Beside(&'static str),
    /// A check of this program.
    Own(fn(&Workspace) -> Result<(), Box<dyn Error>>),
}

use Work::{Beside, Line, Own};

/// By file, since cargo does not see modules that a macro declares.
const FORMAT: &str = "git ls-files -z --cached --others --exclude-standard '*.rs' | xargs -0 rustfmt --check --edition 2024";
const LINTS: Tier =
    ("lints", Line("cargo clippy --quiet {apart} --all-targets {packages} -- -D warnings"));
const RUST_TESTS: &str = "cargo test --no-fail-fast {packages} -- --quiet";
const BUILD: Tier = ("build", Line("cargo build --package lennard"));
const TIDINESS: Tier = ("tidiness", Own(tidy::check));
const NAMES: Tier = ("names", Own(ledger::names_alone));
const BOOK: Tier = ("book", Own(book::build));
const ENVIRONMENT: Tier = ("Python environment", Own(python::prepare));
const PACKAGE: Tier = ("Python package", Own(python::install_package));
const PACKAGE_TESTS: Tier = ("Python tests", Line("{pytest} python/tests -m 'not physics'"));

/// Names of commands that run tiers, whether they look at the release program in place of the tested one, and the tiers.
const COMMANDS: &[(&str, bool, &[Tier])] = &[
    (
        "test",
        false,
        &[
            ("format", Line(FORMAT)),
            // First, since the pair loops take one processor for minutes to compile.
            ("Rust tests", Beside(RUST_TESTS)),
            LINTS,
            (
                "documentation",
                Line("RUSTDOCFLAGS='-D warnings' cargo doc --quiet {apart} --workspace --no-deps"),
            ),
            TIDINESS,
            ENVIRONMENT,
            // Waits until the tests are compiled.
            ("builds", Line("cargo test --quiet --workspace --no-run")),
            NAMES,
            BOOK,
            PACKAGE,
            PACKAGE_TESTS,
            (
                "validation",
                Line("{pytest} validation -m 'not physics and not cluster and not mpi'"),
            ),
        ],
    ),
    ("check", false, &[LINTS, ("Rust tests", Line(RUST_TESTS))]),
    (
        "physics",
        true,
        &[
            ("release build", Line("cargo build --release --package lennard")),
            ENVIRONMENT,
            ("physics", Line("{pytest} validation -m physics")),
            ("long Rust tests", Line("cargo test --quiet --workspace --no-fail-fast -- --ignored")),
        ],
    ),
    ("cluster", false, &[BUILD, ENVIRONMENT, ("cluster", Line("{pytest} validation -m cluster"))]),
    // The tests build the release program themselves, in one go with the one on ranks.
    ("mpi", true, &[ENVIRONMENT, ("ranks of MPI", Line("{pytest} validation -m mpi"))]),
    ("tidy", false, &[BUILD, TIDINESS, NAMES]),
    (
        "docs",
        false,
        &[("documents", Line("cargo test --package lennard --test all documents")), BOOK],
    ),
    ("python", false, &[BUILD, ENVIRONMENT, PACKAGE, PACKAGE_TESTS]),
];

/// What `cargo xtask test` leaves out.
const LEFT_OUT: &[&str] = &[
    "physics: U and P at eight state points, error bars over ten seeds, Rust tests marked as ignored (cargo xtask physics)",
    "cluster: sweeps by Slurm, GNU parallel and dask (cargo xtask cluster)",
    "mpi: one run on several ranks (cargo xtask mpi)",
    "soak: runs killed at random times and resumed (cargo xtask soak)",
    "coverage: printed errors against 2,700 runs of many seeds (lennard sweep studies/coverage)",
    "ledger: bits of every shipped scene (cargo xtask ledger)",
    "fuzz: mutated files through every reader (cargo xtask fuzz)",
    "bench: speed (lennard study bench)",
];

/// Runs all tiers of a command, whatever fails, and sums up; `None` where there is no such command.
pub fn run(workspace: Workspace, name: &str) -> Option<ExitCode> {
    let (_, is_release, tiers) = COMMANDS.iter().find(|(command, ..)| *command == name)?;
    let workspace = if *is_release { workspace } else { workspace.with_tested_binary() };
    let results = in_turn(&workspace, tiers);
    let left_out = if name == "test" { LEFT_OUT } else { &["everything else (cargo xtask test)"] };
    println!("\n{}", summary(&results, left_out));
    Some(ExitCode::from(exit_code(&results)))
}

/// 0 where all tiers passed.
fn exit_code(results: &[Outcome]) -> u8 {
    u8::from(results.iter().any(|(_, passed, _)| !passed))
}

/// A tier with whether it passed, and its time.
type Outcome = (&'static str, bool, Duration);

/// Runs the tiers in the order of the list; the ones beside others show their output at the end.
fn in_turn(workspace: &Workspace, tiers: &[Tier]) -> Vec<Outcome> {
    let mut results = Vec::new();
    let mut asides = Vec::new();
    for (name, work) in tiers {
        let start = Instant::now();
        println!("\n── {name} ──");
        let done = match work {
            Line(line) => shell(workspace, line).status().map(|status| status.success()),
            Beside(line) => aside(workspace, name, line).map(|(child, log)| {
                println!("beside the next tiers, into {}", log.display());
                asides.push((*name, child, log, start));
                true
            }),
            Own(check) => Ok(check(workspace).inspect_err(|error| println!("{error}")).is_ok()),
        };
        let passed = done.unwrap_or_else(|error| {
            println!("{error}");
            false
        });
        results.push((*name, passed, start.elapsed()));
    }
    for (name, mut child, log, start) in asides {
        let passed = child.wait().is_ok_and(|status| status.success());
        println!("\n── {name} ──\n{}", fs::read_to_string(log).unwrap_or_default());
        let started = results.iter_mut().find(|(tier, ..)| *tier == name);
        started.into_iter().for_each(|result| *result = (name, passed, start.elapsed()));
    }
    results
}

fn shell(workspace: &Workspace, line: &str) -> Command {
    let python = python::Environment::validation(workspace).program("python");
    let pytest = format!(
        "OPENBLAS_NUM_THREADS=1 '{}' -m pytest -rs -n auto --dist loadfile",
        python.display()
    );
    let line = line
        .replace("{packages}", &workspace.package_arguments().join(" "))
        .replace("{pytest}", &pytest)
        .replace(
            "{apart}",
            &format!("--target-dir '{}'", workspace.target.join("lints").display()),
        );
    let mut command = workspace.command("sh");
    command.args(["-e", "-c", &line]);
    command.env("LENNARD_BINARY", workspace.binary()).env("CARGO", cargo());
    command.envs(folder_in_memory().map(|folder| ("TMPDIR", folder)));
    command
}

/// Where short runs may write so that thousands of them wait for no disk: in memory, where a gigabyte is left for files.
fn folder_in_memory() -> Option<&'static str> {
    let left = Command::new("df").args(["-k", "--output=avail", "/dev/shm"]).output().ok()?;
    let kilobytes: u64 =
        String::from_utf8(left.stdout).ok()?.lines().last()?.trim().parse().ok()?;
    (kilobytes >= 1 << 20).then_some("/dev/shm")
}

/// A command line that runs on, with both outputs in a file.
fn aside(
    workspace: &Workspace,
    name: &str,
    line: &str,
) -> std::io::Result<(Child, std::path::PathBuf)> {
    let log = workspace.target.join(format!("{}.log", name.replace(' ', "-")));
    let file = File::create(&log)?;
    let child = shell(workspace, line).stdout(file.try_clone()?).stderr(file).spawn()?;
    Ok((child, log))
}

/// The closing table; its last line counts.
fn summary(results: &[Outcome], left_out: &[&str]) -> String {
    let mut text = String::new();
    for (name, passed, time) in results {
        let said = if *passed { "passed" } else { "failed" };
        text += &format!("{name:<20}{said:>8}{:>8.1} s\n", time.as_secs_f64());
    }
    for tier in left_out {
        text += &format!("left out, {tier}\n");
    }
    let passed = results.iter().filter(|(_, passed, _)| *passed).count();
    text + &format!("{passed} passed, {} failed", results.len() - passed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_is_told_at_its_place_and_the_next_tiers_run() {
        let root = std::env::temp_dir().join(format!("xtask-check-{}", std::process::id()));
        fs::create_dir_all(&root).unwrap();
        let metadata =
            serde_json::json!({"workspace_root": root, "target_directory": root, "packages": []});
        let workspace = Workspace::from_metadata(&metadata).unwrap();
        // The first ends when a later one has made its file.
        let tiers = [
            ("waits", Beside("while ! test -e there; do sleep 0.01; done; echo a fault; exit 1")),
            ("makes", Line("touch there")),
            ("own", Own(|_| Err("a fault".into()))),
            ("lacks", Line("absent-program; true")),
        ];
        let results = in_turn(&workspace, &tiers);
        let passed: Vec<bool> = results.iter().map(|(_, passed, _)| *passed).collect();
        assert_eq!(passed, [false, true, false, false]);
        assert_eq!([exit_code(&results), exit_code(&results[1..2])], [1, 0]);
        assert_eq!(fs::read_to_string(root.join("waits.log")).unwrap(), "a fault\n");
        let text = summary(&results, &["physics"]);
        assert!(text.contains("left out, physics"), "{text}");
        assert_eq!(text.lines().last(), Some("1 passed, 3 failed"));
        fs::remove_dir_all(root).unwrap();
    }

    /// Each `cargo xtask NAME` of a document is a command of the help.
    #[test]
    fn commands_in_documents_are_commands_of_the_help() {
        let root = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        for folder in [".", "docs", "docs/tutorials", "validation"] {
            for page in fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path())
            {
                if page.extension().is_none_or(|e| e != "md") {
                    continue;
                }
                for words in fs::read_to_string(&page).unwrap().split("cargo xtask ").skip(1) {
                    let name: String = words.chars().take_while(char::is_ascii_lowercase).collect();
                    let is_known =
                        name.is_empty() || crate::help::HELP.contains(&format!("\n  {name} "));
                    assert!(is_known, "{}: cargo xtask {name}", page.display());
                }
            }
        }
    }
}
