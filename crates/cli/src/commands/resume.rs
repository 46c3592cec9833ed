//! `lennard resume`: a run goes on from its checkpoint, to the bit.

use std::time::Instant;

use lennard_engine::{EngineError, ResumeError, ResumeOptions, RunOptions};
use lennard_io::Existing;

use crate::args::ResumeArgs;
use crate::commands::run::tell;
use crate::commands::{on_threads, output_folder, threads, write_report};
use crate::failure::Failure;
use crate::progress::Display;
use crate::show;
use crate::signals::{Signals, StartUp};

/// Goes on with a run and prints the table of its results.
pub fn resume(args: &ResumeArgs) -> Result<u8, Failure> {
    let deadline = args.control.deadline(Instant::now());
    let loading = || {
        StartUp::resumable(&format!(
            "stopped before the first step: the checkpoint is untouched\n  to go on: {}",
            command(args)
        ))
    };
    let signals = Signals::listen(loading())?;
    let options = ResumeOptions {
        more_steps: args.steps.unwrap_or(0),
        isa: args.isa.clone(),
        older: args.older,
    };
    if !args.folder.is_dir() {
        return Err(EngineError::from(ResumeError::NoRun(args.folder.clone())).into());
    }
    // Claimed before it is read: what another process writes there would change in between.
    let folder = signals.claim(
        || output_folder(Some(&args.folder), Existing::Keep, ""),
        |_| Some(loading()),
    )?;
    let mut resumed = lennard_engine::resume(&args.folder, &options)?;
    let quiet = args.control.quiet || args.json;
    let simulation = &resumed.simulation;
    let threads = threads(args.threads, simulation.state.len());
    let (step, total) = (simulation.state.step, simulation.scene.total_steps());
    if !quiet {
        show::header(simulation, threads, &args.folder);
        println!(
            "  goes on after step {step} of {total}, from {}",
            resumed.checkpoint.display()
        );
        if step == total {
            println!("  all steps were done already; --steps N goes on for N more");
        }
    }
    // The checkpoint is loaded: whatever happens now, the run can go on.
    signals.under_way();
    let mut display = Display::new(args.control.quiet);
    let outcome = on_threads(threads, || {
        let options = RunOptions {
            folder: &folder,
            threads,
            stop: signals.stop(),
            deadline,
            progress: &mut display,
        };
        lennard_engine::go_on(&mut resumed, options).map_err(|e| Failure::of_run(e, &args.folder))
    })?;
    drop(display);
    write_report(&outcome, &args.folder, &args.control)?;
    tell(&outcome, &args.folder, total, args.json, &args.control)
}

/// The command as it can be typed again.
fn command(args: &ResumeArgs) -> String {
    let mut line = format!("lennard resume {}", args.folder.display());
    if let Some(steps) = args.steps {
        line += &format!(" --steps {steps}");
    }
    if args.older {
        line += " --older";
    }
    if let Some(isa) = &args.isa {
        line += &format!(" --isa {isa}");
    }
    line
}
