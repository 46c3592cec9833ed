//! Every check with one command: `cargo xtask test`.
#![allow(clippy::print_stdout, clippy::print_stderr)] // a command-line tool speaks on both

mod book;
mod counts;
mod fuzz;
mod ledger;
mod python;
mod running;
mod sessions;
mod soak;
mod tidy;
mod tiers;
mod workspace;

use std::process::ExitCode;

use workspace::Workspace;

const HELP: &str = "\
Every check with one command.

Usage: cargo xtask COMMAND

Commands:
  test     All checks but the long ones: format, lints, documentation, Rust tests, a short soak,
           tidiness, Python environment, validation by other people's tools
  check    Lints and tests of some crates alone: cargo xtask check observables
  physics  The long checks: state points against the equation of state, error bars against
           independent seeds, Rust tests marked as ignored
  tidy     README.md and docs name what exists, crates depend as designed, no files import each other
           in circles, files and sentences are short, methods are named in one place, no machine
           path, registry host or large file is tracked
  soak     Kill runs at random times, go on with them, and compare every byte with an undisturbed
           run; --quick for 10 kills in place of 200, --long for ten million steps
  ledger   Bits of every shipped scene, and names of keys, options and methods, against validation/ledger;
           --write makes the record anew, --names compares names alone, --binary FILE takes another build
  fuzz     Seeded mutations of fuzz/corpus through every reader; --runs N, --target NAME, --seed N
  cluster  One sweep by an array of Slurm, by GNU parallel and by dask, stopped and killed on the way;
           as root on Debian, what is missing is installed
  mpi      One run on ranks of MPI against one process, byte by byte, with a rank that is killed, halos and speed;
           MPICH comes from PyPI, and Open MPI from Debian as root
  docs     Run the commands of README.md and of the tutorials, and build the book in target/book/site
  python   The Python package: make the virtual environment .venv from validation/requirements.txt, build the
           wheel, install it there, and run python/tests
  help     This text

Every command runs all its tiers, says at the end what passed, failed and was skipped, and exits
with 1 if anything failed.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let command = match arguments.as_slice() {
        [] => "help",
        [one] => one.as_str(),
        _ => "",
    };
    if matches!(command, "help" | "--help" | "-h") {
        println!("{HELP}");
        return ExitCode::SUCCESS;
    }
    let workspace = match Workspace::find() {
        Ok(workspace) => workspace,
        Err(error) => {
            eprintln!("cannot find the workspace: {error}");
            return ExitCode::FAILURE;
        }
    };
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["soak", rest @ ..] => return soak::build_and_run(&workspace, rest),
        ["ledger", rest @ ..] => return ledger::run(workspace, rest),
        ["fuzz", rest @ ..] => return fuzz::run(&workspace, rest),
        ["check", crates @ ..] => {
            return match workspace.with_crates(crates) {
                Ok(selected) => {
                    let left_out = ["everything else (cargo xtask test)"];
                    running::run_all(&selected, &tiers::check(), &left_out)
                }
                Err(error) => {
                    eprintln!("{error}");
                    ExitCode::from(2)
                }
            };
        }
        _ => {}
    }
    match command {
        "test" => running::run_all(
            &workspace.with_tested_binary(),
            &tiers::test(),
            &[
                "physics: U and P at eight state points, error bars over ten seeds (cargo xtask physics)",
                "cluster: sweeps by Slurm, GNU parallel and dask (cargo xtask cluster)",
                "mpi: one run on several ranks (cargo xtask mpi)",
                "soak: runs killed at random times and resumed (cargo xtask soak)",
                "coverage: printed errors against 2,700 runs of many seeds (lennard sweep studies/coverage)",
                "fuzz: mutated files through every reader (cargo xtask fuzz)",
                "bench: speed (lennard bench)",
            ],
        ),
        "physics" => running::run_all(&workspace, &tiers::physics(), &[]),
        "cluster" => running::run_all(&workspace.with_tested_binary(), &tiers::cluster(), &[]),
        "mpi" => running::run_all(&workspace, &tiers::mpi(), &[]),
        "tidy" => running::run_all(&workspace.with_tested_binary(), &tiers::tidy(), &[]),
        "docs" => running::run_all(&workspace.with_tested_binary(), &tiers::docs(), &[]),
        "python" => running::run_all(&workspace.with_tested_binary(), &tiers::python(), &[]),
        _ => {
            eprintln!("unknown command: {}\n\n{HELP}", arguments.join(" "));
            ExitCode::from(2)
        }
    }
}
