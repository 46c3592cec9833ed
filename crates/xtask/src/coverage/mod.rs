//! Whether the printed error bars cover: `cargo xtask coverage`.

mod distributions;
mod groups;
mod judge;
mod line;
mod plan;
mod records;
mod request;
mod runner;
mod summary;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::workspace::{Workspace, cargo};
use request::{HELP, Request, Source};
use runner::{Failure, Runner};
use summary::Summary;

/// Builds the program where none is given, and runs the command.
pub fn run(workspace: &Workspace, arguments: &[&str]) -> ExitCode {
    let request = match Request::read(arguments) {
        Ok(request) => request,
        Err(fault) => {
            eprintln!("{fault}\n\n{HELP}");
            return ExitCode::from(2);
        }
    };
    match built(workspace, &request).and_then(|binary| carry_out(workspace, &request, &binary)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("coverage failed: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The short form, as one check among others: with the program that the workspace looks at.
///
/// # Errors
///
/// Runs that fail, and errors that do not cover.
pub fn quick(workspace: &Workspace) -> Result<(), Failure> {
    carry_out(workspace, &Request::quick(), &workspace.binary())
}

/// The program that is asked for; the release build is made first.
fn built(workspace: &Workspace, request: &Request) -> Result<PathBuf, Failure> {
    if let Some(binary) = &request.binary {
        return Ok(binary.clone());
    }
    let mut build = workspace.command(cargo());
    build.args(["build", "--quiet", "--release", "--package", "lennard"]);
    if build.status()?.success() {
        Ok(workspace.binary())
    } else {
        Err("the program cannot be built".into())
    }
}

fn carry_out(workspace: &Workspace, request: &Request, binary: &Path) -> Result<(), Failure> {
    let runner = Runner { binary: binary.to_owned(), workers: request.workers };
    let folder = match (&request.source, request.quick) {
        (Source::Checkpoints(_), _) => "again",
        (_, true) => "quick",
        (_, false) => "runs",
    };
    let default = workspace.target.join("coverage").join(folder);
    if request.quick && request.source == Source::Simulation && request.out.is_none() {
        // Short runs are made again each time: the program may have changed.
        let _ = std::fs::remove_dir_all(&default);
    }
    let out = request.out.clone().unwrap_or(default);
    let runs = request.runs();
    match &request.source {
        Source::Simulation => runner.simulate(&runs, &out)?,
        Source::Checkpoints(data) => runner.conclude(&runs, data, &out)?,
        Source::Records => {}
    }
    let (samples, origin) = records::read(&runs, &out)?;
    let judged = judge::all(&samples);
    if judged.iter().all(|one| one.given == 0) {
        return Err(format!(
            "no finished run in {} printed an error that can be judged",
            out.display()
        )
        .into());
    }
    let summary = Summary::new(judged, &request.lengths);
    let text = summary.text(&origin);
    print!("{text}");
    std::fs::write(out.join("coverage.md"), text)?;
    let json = serde_json::to_string_pretty(&summary.json(&origin))?;
    std::fs::write(out.join("coverage.json"), json)?;
    match summary.failures() {
        (0, 0) => Ok(()),
        (groups, cells) => Err(format!(
            "{groups} groups are outside their bars and {cells} cells are beyond chance; {} has all",
            out.join("coverage.json").display()
        )
        .into()),
    }
}
