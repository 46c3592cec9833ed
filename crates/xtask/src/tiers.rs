//! The tiers of checks.

use std::error::Error;
use std::process::Command;

use crate::counts::{Counts, Format};
use crate::python::Environment;
use crate::running::{ONE_FAILED, ONE_PASSED, Tier, Work, by_counts, by_status};
use crate::workspace::{Workspace, cargo};
use crate::{book, python, sessions, tidy};

/// By file, since cargo does not see modules that a macro declares.
const FORMAT: Tier = Tier {
    name: "format",
    work: Work::Live(|w| {
        let mut command = w.command("rustfmt");
        command.args(["--check", "--edition", "2024"]);
        command.args(w.tracked(&["*.rs"])?);
        by_status(command)
    }),
};
const LINTS: Tier = Tier {
    name: "lints",
    work: Work::Live(|w| {
        let mut command = cargo_command(w, &["clippy", "--quiet", "--all-targets"]);
        command.args(w.package_arguments());
        command.args(["--", "-D", "warnings"]);
        by_status(command)
    }),
};
const DOCUMENTATION: Tier = Tier {
    name: "documentation",
    work: Work::Live(|w| {
        let mut command = cargo_command(w, &["doc", "--workspace", "--no-deps"]);
        command.env("RUSTDOCFLAGS", "-D warnings");
        by_status(command)
    }),
};
/// The Python environment is made while the pair loops compile, which takes minutes of one processor.
const BUILDS: Tier = Tier {
    name: "builds",
    work: Work::Live(|w| {
        std::thread::scope(|scope| {
            let python = scope.spawn(|| {
                let made = Environment::validation(w).prepare(w);
                made.map_err(|error| error.to_string())
            });
            let built = by_status(cargo_command(w, &["test", "--workspace", "--no-run"]));
            python.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            built
        })
    }),
};
const RUST_TESTS: Tier = Tier {
    name: "Rust tests",
    work: Work::Beside(
        |w| {
            let mut command = cargo_command(w, &["test", "--no-fail-fast"]);
            command.args(w.package_arguments());
            command.args(["--", "--quiet"]);
            command
        },
        Format::CargoTest,
    ),
};
const LONG_RUST_TESTS: Tier = Tier {
    name: "long Rust tests",
    work: Work::Live(|w| {
        by_counts(
            cargo_command(
                w,
                &["test", "--quiet", "--workspace", "--no-fail-fast", "--", "--ignored"],
            ),
            Format::CargoTest,
        )
    }),
};
const RELEASE_BUILD: Tier = Tier {
    name: "release build",
    work: Work::Live(|w| {
        by_status(cargo_command(w, &["build", "--release", "--package", "lennard"]))
    }),
};
const TESTED_BUILD: Tier = Tier {
    name: "build",
    work: Work::Live(|w| by_status(cargo_command(w, &["build", "--package", "lennard"]))),
};
const SOAK: Tier =
    Tier { name: "soak", work: Work::Live(|w| crate::soak::quick(w).map(|()| ONE_PASSED)) };
const TIDINESS: Tier = Tier {
    name: "tidiness",
    work: Work::Live(|w| {
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
    }),
};
const NAMES: Tier = Tier {
    name: "names",
    work: Work::Live(|w| match crate::ledger::names(w) {
        Ok(0) => Ok(ONE_PASSED),
        Ok(_) => {
            println!("`cargo xtask ledger --names --write` records names that changed on purpose");
            Ok(ONE_FAILED)
        }
        Err(error) => Err(error as Box<dyn Error>),
    }),
};
const SESSIONS: Tier = Tier { name: "documents", work: Work::Live(sessions::run) };
const BOOK: Tier = Tier {
    name: "book",
    work: Work::Live(|w| {
        let pages = book::build(w)?;
        println!("{pages} pages");
        Ok(ONE_PASSED)
    }),
};
const PYTHON: Tier = Tier {
    name: "Python environment",
    work: Work::Live(|w| {
        Environment::validation(w).prepare(w)?;
        Ok(ONE_PASSED)
    }),
};
const PACKAGE: Tier = Tier {
    name: "Python package",
    work: Work::Live(|w| {
        python::install_package(w)?;
        by_counts(pytest(w, "python/tests", "not physics"), Format::Pytest)
    }),
};
const VALIDATION: Tier = Tier {
    name: "validation",
    work: Work::Live(|w| {
        by_counts(
            pytest(w, "validation", "not physics and not cluster and not mpi"),
            Format::Pytest,
        )
    }),
};
const CLUSTER: Tier = Tier {
    name: "cluster",
    work: Work::Live(|w| by_counts(pytest(w, "validation", "cluster"), Format::Pytest)),
};
const RANKS: Tier = Tier {
    name: "ranks of MPI",
    work: Work::Live(|w| by_counts(pytest(w, "validation", "mpi"), Format::Pytest)),
};
const PHYSICS: Tier = Tier {
    name: "physics",
    work: Work::Live(|w| by_counts(pytest(w, "validation", "physics"), Format::Pytest)),
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
        TIDINESS,
        NAMES,
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
    vec![TESTED_BUILD, TIDINESS, NAMES]
}

/// What `cargo xtask docs` runs.
pub fn docs() -> Vec<Tier> {
    vec![TESTED_BUILD, SESSIONS, BOOK]
}

/// What `cargo xtask python` runs, on a workspace [as tested](Workspace::with_tested_binary).
pub fn python() -> Vec<Tier> {
    vec![TESTED_BUILD, PYTHON, PACKAGE]
}

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
