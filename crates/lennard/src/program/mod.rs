//! The `lennard` command line: arguments in, exit code out.
//!
//! A library, so that the Python package has the same command.
#![allow(clippy::print_stdout, clippy::print_stderr)] // printing is what this crate is for

#[macro_use]
mod out;

mod args;
mod commands;
mod failure;
mod lammps;
mod list_entry;
mod progress;
mod ranks;
mod show;
mod signals;
mod typed;
mod watch;

use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};

use lennard_core::Team;
use lennard_scene::{RemovedKind, removed};

use crate::program::args::{Cli, Command, GenerateCommand, RanksCli, RanksCommand, StudyCommand};
use crate::program::failure::Failure;

/// Runs the command line with these arguments, the name of the program first, and returns the exit code.
///
/// Results go to standard output, messages to standard error.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    signals::let_long_files_fail();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    typed::keep(&arguments);
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(error) => return usage(&error, &arguments),
    };
    let done = match &cli.command {
        Command::Run(args) => commands::run::run(args),
        Command::New(args) => commands::new::new(args),
        Command::Resume(args) => commands::resume::resume(args),
        Command::Plan(args) => commands::plan::plan(args),
        Command::Energy(args) => commands::energy::energy(args),
        Command::Chart(args) => commands::chart::chart(args),
        Command::Sweep(args) => commands::sweep::sweep(args),
        Command::Tune(args) => commands::tune::tune(args),
        Command::Measure(args) => commands::measure::measure(args),
        Command::Compare(args) => commands::compare::compare(args),
        Command::Eos(args) => commands::eos::eos(args),
        Command::List(args) => commands::list::list(args),
        Command::Study(StudyCommand::Bench(args)) => commands::bench::bench(args),
        Command::Study(StudyCommand::Stability(args)) => commands::stability::stability(args),
        Command::Study(StudyCommand::Mechanics(args)) => commands::stability::mechanics(args),
        Command::Generate(document) => match document {
            GenerateCommand::Lammps(args) => commands::export::to_lammps(args),
            GenerateCommand::Completions { shell } => commands::documents::completions(*shell),
            GenerateCommand::Man { folder } => commands::documents::man(folder),
            GenerateCommand::Schema => commands::documents::schema(),
        },
        Command::Version { json } => commands::version(*json),
    };
    exit_code(done)
}

/// Runs the command line of `lennard-mpi` on one of several ranks, and returns the exit code, which all ranks share.
///
/// Every rank is given the same arguments. What only one rank meets ends all of them ([`Team::abort`]).
pub fn main_on_ranks(arguments: impl IntoIterator<Item = OsString>, team: &Team) -> u8 {
    signals::let_long_files_fail();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    typed::keep(&arguments);
    let cli = match RanksCli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(error) if team.leads() => return usage(&error, &arguments),
        Err(error) => return code_of(&error),
    };
    exit_code(match &cli.command {
        RanksCommand::Run(args) => commands::run::run_on(args, Some(team)),
        RanksCommand::Resume(args) => commands::resume::resume_on(args, Some(team)),
    })
}

/// Prints help, or what is wrong with the arguments, and gives the exit code.
fn usage(error: &clap::Error, arguments: &[OsString]) -> u8 {
    if let Some(message) = new_way(error, arguments) {
        out::failed(&message);
    } else if error.use_stderr() {
        let text = error.render().to_string();
        out::failed(text.strip_prefix("error: ").unwrap_or(&text).trim_end());
    } else {
        // A reader who has gone needs no help.
        let _ = error.print();
    }
    code_of(error)
}

/// The refusal of a command or an option that was removed; `None` where the arguments have neither.
fn new_way(error: &clap::Error, arguments: &[OsString]) -> Option<String> {
    let found = |kind| match error.get(kind)? {
        ContextValue::String(name) => Some(name.as_str()),
        _ => None,
    };
    let (kind, name) = match error.kind() {
        ErrorKind::UnknownArgument => {
            let option = found(ContextKind::InvalidArg)?;
            (RemovedKind::Option, format!("{}{option}", command_in(arguments)))
        }
        ErrorKind::InvalidSubcommand => {
            (RemovedKind::Command, found(ContextKind::InvalidSubcommand)?.to_owned())
        }
        _ => return None,
    };
    let instead = removed(kind, &name)?;
    Some(format!("`{name}` was removed\n  allowed: {instead}"))
}

/// The words of the command among the arguments, each with a space behind it: `study bench `.
fn command_in(arguments: &[OsString]) -> String {
    let (mut level, mut words) = (Cli::command(), String::new());
    for word in arguments.iter().skip(1).filter_map(|argument| argument.to_str()) {
        let Some(below) = level.find_subcommand(word) else { break };
        words += &format!("{word} ");
        level = below.clone();
    }
    words
}

fn code_of(error: &clap::Error) -> u8 {
    u8::try_from(error.exit_code()).unwrap_or(failure::INPUT)
}

/// Prints a failure, unless another rank does, and gives the exit code.
fn exit_code(done: Result<u8, Failure>) -> u8 {
    match done.and_then(|code| out::finish().map(|()| code)) {
        Ok(code) => code,
        Err(Failure { message, code }) => {
            signals::let_a_signal_end();
            if !message.is_empty() {
                out::failed(&message);
            }
            code
        }
    }
}
