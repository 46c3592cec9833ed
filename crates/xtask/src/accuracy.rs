//! Tuned settings on trial: `cargo xtask accuracy`.

use std::process::ExitCode;

use crate::workspace::{Workspace, cargo};

/// Builds the study's example, optimised, and hands the arguments on.
pub fn run(workspace: &Workspace, arguments: &[&str]) -> ExitCode {
    let mut command = workspace.command(cargo());
    command.args([
        "run",
        "--quiet",
        "--release",
        "--package",
        "lennard-studies",
    ]);
    command.args(["--example", "accuracy", "--"]);
    command.args(arguments);
    match command.status() {
        Ok(status) => ExitCode::from(u8::try_from(status.code().unwrap_or(1)).unwrap_or(1)),
        Err(error) => {
            eprintln!("cargo cannot be started: {error}");
            ExitCode::FAILURE
        }
    }
}
