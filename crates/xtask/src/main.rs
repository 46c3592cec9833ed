//! Every check with one command: `cargo xtask test`.
#![allow(clippy::print_stdout, clippy::print_stderr)] // a command-line tool speaks on both

mod book;
mod check;
mod ledger;
mod python;
mod soak;
mod tidy;
mod workspace;

use std::process::ExitCode;

use workspace::Workspace;

const HELP: &str = "\
Every check with one command.

Usage: cargo xtask COMMAND

Commands:
  test     All checks but the long ones: format, lints, documentation, Rust tests, tidiness, names, book,
           Python package, validation by other people's tools
  check    Lints and tests of some crates alone: cargo xtask check observables
  physics  The long checks: state points against the equation of state, error bars against
           independent seeds, Rust tests marked as ignored
  tidy     Crates depend as designed, no files import each other in circles, files and sentences are short,
           methods are named in one place, no machine path, registry host or large file is tracked
  soak     Kill runs at random times, go on with them, and compare every byte with an undisturbed
           run; --quick for 10 kills in place of 200, --long for ten million steps
  ledger   Bits of every shipped scene, and names of keys, options and methods, against validation/ledger;
           --write makes the record anew, --names compares names alone, --binary FILE takes another build
  fuzz     Seeded mutations of fuzz/corpus through every reader; --runs N, --target NAME, --seed N
  cluster  One sweep by an array of Slurm, by GNU parallel and by dask, stopped and killed on the way;
           as root on Debian, what is missing is installed
  mpi      One run on ranks of MPI against one process, byte by byte, with a rank that is killed, halos and speed;
           MPICH comes from PyPI, and Open MPI from Debian as root
  docs     Run the commands of README.md and docs, check their paths and links, and build the book in target/book/site
  python   The Python package: make the virtual environment .venv from validation/requirements.txt, build the
           wheel, install it there, and run python/tests
  help     This text

Every command runs all its tiers, says at the end what passed, failed and was left out, and exits
with 1 if anything failed.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let workspace = match Workspace::find() {
        Ok(workspace) => workspace,
        Err(error) => {
            eprintln!("cannot find the workspace: {error}");
            return ExitCode::FAILURE;
        }
    };
    match words.as_slice() {
        [] | ["help" | "--help" | "-h"] => {
            println!("{HELP}");
            ExitCode::SUCCESS
        }
        ["soak", rest @ ..] => soak::build_and_run(&workspace, rest),
        ["ledger", rest @ ..] => ledger::run(workspace, rest),
        ["fuzz", rest @ ..] => workspace.run_optimised(&["--package", "lennard-fuzz"], rest),
        ["check", crates @ ..] => match workspace.with_crates(crates) {
            Ok(selected) => check::run(selected, "check").unwrap_or(ExitCode::FAILURE),
            Err(error) => {
                eprintln!("{error}");
                ExitCode::from(2)
            }
        },
        [name] => check::run(workspace, name).unwrap_or_else(|| unknown(name)),
        _ => unknown(&words.join(" ")),
    }
}

fn unknown(command: &str) -> ExitCode {
    eprintln!("unknown command: {command}\n\n{HELP}");
    ExitCode::from(2)
}
