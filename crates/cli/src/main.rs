//! The `lennard` command line: arguments in, exit code out.
#![allow(clippy::print_stdout, clippy::print_stderr)] // printing is what this crate is for

#[macro_use]
mod out;

mod args;
mod commands;
mod failure;
mod list_entry;
mod progress;
mod show;
mod signals;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Cli, Command};
use crate::failure::Failure;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let done = match &cli.command {
        Command::Run(args) => commands::run::run(args),
        Command::Resume(args) => commands::resume::resume(args),
        Command::Plan(args) => commands::plan::plan(args),
        Command::Energy(args) => commands::energy::energy(args),
        Command::Stability(args) => commands::stability::stability(args),
        Command::Chart(args) => commands::chart::chart(args),
        Command::Sweep(args) => commands::sweep::sweep(args),
        Command::Tune(args) => commands::tune::tune(args),
        Command::Compare(args) => commands::compare::compare(args),
        Command::Bench(args) => commands::bench::bench(args),
        Command::List(args) => commands::list::list(args),
        Command::Completions { shell } => commands::completions(*shell),
        Command::Version { json } => commands::version(*json),
    };
    match done.and_then(|code| out::finish().map(|()| code)) {
        Ok(code) => code,
        Err(Failure { message, code }) => {
            eprintln!(
                "{} {message}",
                console::style("error:").for_stderr().red().bold()
            );
            ExitCode::from(code)
        }
    }
}
