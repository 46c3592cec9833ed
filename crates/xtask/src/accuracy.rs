//! Tuned settings on trial: `cargo xtask accuracy`.

use std::process::ExitCode;

use crate::workspace::Workspace;

/// Runs the study's example.
pub fn run(workspace: &Workspace, arguments: &[&str]) -> ExitCode {
    let target = ["--package", "lennard-studies", "--example", "accuracy"];
    workspace.run_optimised(&target, arguments)
}
