//! `lennard plan`: what a scene computes.

use std::process::ExitCode;

use crate::args::PlanArgs;
use crate::commands::{load, on_threads, print_json, threads};
use crate::failure::Failure;
use crate::show;

/// Prints what a scene computes, what it leaves out and why, its memory and about how long it takes.
pub fn plan(args: &PlanArgs) -> Result<ExitCode, Failure> {
    let scene = load(&args.scene)?;
    let mut simulation = lennard_engine::prepare(scene)?;
    let threads = threads(args.scene.threads, simulation.state.len());
    let plan = on_threads(threads, || {
        Ok(lennard_engine::plan(&mut simulation, threads)?)
    })?;
    if args.scene.json {
        print_json(&plan)?;
    } else {
        show::plan(&plan);
    }
    Ok(ExitCode::SUCCESS)
}
