//! Hostile input in counted runs: `cargo xtask fuzz`.

use std::process::ExitCode;

use crate::workspace::Workspace;

/// Runs the package that holds the readers' bodies.
pub fn run(workspace: &Workspace, arguments: &[&str]) -> ExitCode {
    workspace.run_optimised(&["--package", "lennard-fuzz"], arguments)
}
