//! Every check with one command: `cargo xtask test`.
#![allow(clippy::print_stdout, clippy::print_stderr)] // a command-line tool speaks on both

mod book;
mod check;
mod help;
mod ledger;
mod python;
mod soak;
mod tidy;
mod workspace;

use std::process::ExitCode;

use help::HELP;
use workspace::Workspace;

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
            print!("{HELP}");
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
