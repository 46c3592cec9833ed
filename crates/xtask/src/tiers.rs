//! The tiers of checks, and running them all.

use std::error::Error;
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use crate::counts::{Counts, Format};
use crate::python::Environment;
use crate::workspace::{Workspace, cargo};
use crate::{book, python, sessions, tidy};

type Outcome = Result<Counts, Box<dyn Error>>;

/// A group of checks.
pub struct Tier {
    name: &'static str,
    run: fn(&Workspace) -> Outcome,
}

/// By file, since cargo does not see modules that a macro declares.
const FORMAT: Tier = Tier {
    name: "format",
    run: |w| {
        let mut command = w.command("rustfmt");
        command.args(["--check", "--edition", "2024"]);
        command.args(w.tracked(&["*.rs"])?);
        by_status(command)
    },
};
const LINTS: Tier = Tier {
    name: "lints",
    run: |w| {
        let mut command = cargo_command(w, &["clippy", "--quiet", "--all-targets"]);
        command.args(w.package_arguments());
        command.args(["--", "-D", "warnings"]);
        by_status(command)
    },
};
const DOCUMENTATION: Tier = Tier {
    name: "documentation",
    run: |w| {
        let mut command = cargo_command(w, &["doc", "--workspace", "--no-deps"]);
        command.env("RUSTDOCFLAGS", "-D warnings");
        by_status(command)
    },
};
/// The Python environment is made while the pair loops compile, which takes minutes of one processor.
const BUILDS: Tier = Tier {
    name: "builds",
    run: |w| {
        std::thread::scope(|scope| {
            let python = scope.spawn(|| {
                let made = Environment::validation(w).prepare(w);
                made.map_err(|error| error.to_string())
            });
            let built = by_status(cargo_command(w, &["test", "--workspace", "--no-run"]));
            python
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            built
        })
    },
};
const RUST_TESTS: Tier = Tier {
    name: "Rust tests",
    run: |w| {
        let mut command = cargo_command(w, &["test", "--no-fail-fast"]);
        command.args(w.package_arguments());
        command.args(["--", "--quiet"]);
        by_counts(command, Format::CargoTest)
    },
};
const LONG_RUST_TESTS: Tier = Tier {
    name: "long Rust tests",
    run: |w| {
        by_counts(
            cargo_command(
                w,
                &[
                    "test",
                    "--quiet",
                    "--workspace",
                    "--no-fail-fast",
                    "--",
                    "--ignored",
                ],
            ),
            Format::CargoTest,
        )
    },
};
const RELEASE_BUILD: Tier = Tier {
    name: "release build",
    run: |w| {
        by_status(cargo_command(
            w,
            &["build", "--release", "--package", "lennard-cli"],
        ))
    },
};
const TESTED_BUILD: Tier = Tier {
    name: "build",
    run: |w| by_status(cargo_command(w, &["build", "--package", "lennard-cli"])),
};
const SOAK: Tier = Tier {
    name: "soak",
    run: |w| crate::soak::quick(w).map(|()| ONE_PASSED),
};
const COVERAGE: Tier = Tier {
    name: "coverage",
    run: |w| {
        crate::coverage::quick(w).map_err(|error| error as Box<dyn Error>)?;
        Ok(ONE_PASSED)
    },
};
const TIDINESS: Tier = Tier {
    name: "tidiness",
    run: |w| {
        let mut counts = Counts::default();
        for (what, faults) in tidy::all(w)? {
            if faults.is_empty() {
                counts.passed += 1;
                println!("{what}: fine");
            } else {
                counts.failed += 1;
                println!("{what}:");
                for fault in faults {
                    println!("  {fault}");
                }
            }
        }
        Ok(counts)
    },
};
const SESSIONS: Tier = Tier {
    name: "documents",
    run: sessions::run,
};
const BOOK: Tier = Tier {
    name: "book",
    run: |w| {
        let pages = book::build(w)?;
        println!("{pages} pages");
        Ok(ONE_PASSED)
    },
};
const PYTHON: Tier = Tier {
    name: "Python environment",
    run: |w| {
        Environment::validation(w).prepare(w)?;
        Ok(ONE_PASSED)
    },
};
const PACKAGE: Tier = Tier {
    name: "Python package",
    run: |w| {
        python::install_package(w)?;
        by_counts(pytest(w, "python/tests", "not physics"), Format::Pytest)
    },
};
const VALIDATION: Tier = Tier {
    name: "validation",
    run: |w| {
        by_counts(
            pytest(w, "validation", "not physics and not cluster and not mpi"),
            Format::Pytest,
        )
    },
};
const CLUSTER: Tier = Tier {
    name: "cluster",
    run: |w| by_counts(pytest(w, "validation", "cluster"), Format::Pytest),
};
const RANKS: Tier = Tier {
    name: "ranks of MPI",
    run: |w| by_counts(pytest(w, "validation", "mpi"), Format::Pytest),
};
const PHYSICS: Tier = Tier {
    name: "physics",
    run: |w| by_counts(pytest(w, "validation", "physics"), Format::Pytest),
};

/// The tiers of `cargo xtask test`, on a workspace [as tested](Workspace::with_tested_binary).
/// A release build for the last tiers would take a fifth of the time.
pub fn test() -> Vec<Tier> {
    vec![
        FORMAT,
        LINTS,
        DOCUMENTATION,
        BUILDS,
        RUST_TESTS,
        SOAK,
        COVERAGE,
        TIDINESS,
        SESSIONS,
        BOOK,
        PACKAGE,
        VALIDATION,
    ]
}

/// What `cargo xtask check CRATE …` runs, on a workspace [with these crates](Workspace::with_crates).
pub fn check() -> Vec<Tier> {
    vec![LINTS, RUST_TESTS]
}

/// What `cargo xtask physics` runs.
pub fn physics() -> Vec<Tier> {
    vec![RELEASE_BUILD, PYTHON, PHYSICS, LONG_RUST_TESTS]
}

/// What `cargo xtask cluster` runs, on a workspace [as tested](Workspace::with_tested_binary): it measures no speed.
pub fn cluster() -> Vec<Tier> {
    vec![TESTED_BUILD, PYTHON, CLUSTER]
}

/// What `cargo xtask mpi` runs. Its tests build the release program themselves, in one go with the one on ranks.
pub fn mpi() -> Vec<Tier> {
    vec![PYTHON, RANKS]
}

/// What `cargo xtask tidy` runs, on a workspace [as tested](Workspace::with_tested_binary).
pub fn tidy() -> Vec<Tier> {
    vec![TESTED_BUILD, TIDINESS]
}

/// What `cargo xtask docs` runs.
pub fn docs() -> Vec<Tier> {
    vec![TESTED_BUILD, SESSIONS, BOOK]
}

/// What `cargo xtask python` runs, on a workspace [as tested](Workspace::with_tested_binary).
pub fn python() -> Vec<Tier> {
    vec![TESTED_BUILD, PYTHON, PACKAGE]
}

const ONE_PASSED: Counts = Counts {
    passed: 1,
    failed: 0,
    skipped: 0,
};
const ONE_FAILED: Counts = Counts {
    passed: 0,
    failed: 1,
    skipped: 0,
};

fn cargo_command(workspace: &Workspace, arguments: &[&str]) -> Command {
    let mut command = workspace.command(cargo());
    command.args(arguments);
    command
}

/// A worker for each processor; the tests of a file, which share what they made, stay in one worker.
fn pytest(workspace: &Workspace, folder: &str, marked: &str) -> Command {
    let mut command = workspace.command(Environment::validation(workspace).program("python"));
    command
        .args(["-m", "pytest", folder, "-m", marked])
        .args(["-n", "auto", "--dist", "loadfile"])
        .env("LENNARD_BINARY", workspace.binary())
        .env("CARGO", cargo());
    command
}

/// One check: the exit status tells.
fn by_status(mut command: Command) -> Outcome {
    Ok(if command.status()?.success() {
        ONE_PASSED
    } else {
        ONE_FAILED
    })
}

/// Counts the checks in the output of a command.
/// A command that fails without a failed check, for instance in compilation, counts as one failed check.
fn by_counts(mut command: Command, format: Format) -> Outcome {
    let mut child = command.stdout(Stdio::piped()).spawn()?;
    let mut counts = Counts::default();
    if let Some(output) = child.stdout.take() {
        for line in BufReader::new(output).split(b'\n') {
            let line = String::from_utf8_lossy(&line?).into_owned();
            println!("{line}");
            if let Some(more) = format.counts_in(line.trim_end()) {
                counts += more;
            }
        }
    }
    let succeeded = child.wait()?.success();
    if !succeeded && counts.failed == 0 {
        counts += ONE_FAILED;
    }
    Ok(counts)
}

/// Runs all tiers, whatever fails, and sums up; `left_out` names what this command does not run.
pub fn run_all(workspace: &Workspace, tiers: &[Tier], left_out: &[&str]) -> ExitCode {
    let mut results = Vec::new();
    for tier in tiers {
        println!("\n── {} ──", tier.name);
        let start = Instant::now();
        let counts = (tier.run)(workspace).unwrap_or_else(|error| {
            println!("{error}");
            ONE_FAILED
        });
        // What the tools print on standard error must come before the next heading.
        let _ = std::io::stdout().flush();
        results.push((tier.name, counts, start.elapsed()));
    }
    let (text, failed) = summary(&results, left_out);
    println!("\n{text}");
    if failed {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

/// The closing table and whether anything failed.
fn summary(results: &[(&str, Counts, Duration)], left_out: &[&str]) -> (String, bool) {
    let mut total = Counts::default();
    let mut text = format!(
        "{:<20}{:>8}{:>8}{:>9}{:>10}\n",
        "tier", "passed", "failed", "skipped", "time"
    );
    for (name, counts, time) in results {
        total += *counts;
        text += &format!(
            "{name:<20}{:>8}{:>8}{:>9}{:>8.1} s\n",
            counts.passed,
            counts.failed,
            counts.skipped,
            time.as_secs_f64()
        );
    }
    if total.skipped > 0 {
        text += &format!("skipped inside the tiers: {}\n", total.skipped);
    }
    for tier in left_out {
        text += &format!("left out, {tier}\n");
    }
    text += &format!("{} passed, {} failed", total.passed, total.failed);
    (text, total.failed > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_counts_names_what_was_left_out_and_ends_plainly() {
        let some = |passed, failed, skipped| Counts {
            passed,
            failed,
            skipped,
        };
        let results = [
            ("format", some(1, 0, 0), Duration::from_millis(1500)),
            ("Rust tests", some(40, 2, 3), Duration::from_secs(61)),
        ];
        let (text, failed) = summary(&results, &["physics (cargo xtask physics)"]);
        assert!(failed);
        assert!(text.contains("skipped inside the tiers: 3"));
        assert!(text.contains("left out, physics (cargo xtask physics)"));
        assert_eq!(text.lines().last(), Some("41 passed, 2 failed"));
        let (text, failed) = summary(&results[..1], &[]);
        assert!(!failed);
        assert_eq!(text.lines().last(), Some("1 passed, 0 failed"));
    }

    #[cfg(unix)]
    #[test]
    fn a_command_that_fails_without_counting_is_a_failure() {
        let run = |script: &str| {
            let mut command = Command::new("sh");
            command.args(["-c", script]);
            by_counts(command, Format::Pytest).unwrap()
        };
        assert_eq!(run("echo does not compile; exit 101"), ONE_FAILED);
        assert_eq!(run("echo '3 passed in 0.1s'; exit 0").passed, 3);
        let mixed = run("echo '3 passed, 2 failed in 0.1s'; exit 1");
        assert_eq!((mixed.passed, mixed.failed), (3, 2));
    }
}
