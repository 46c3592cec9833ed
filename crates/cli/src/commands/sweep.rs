//! `lennard sweep`: many state points from one file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lennard_io::Existing;
use lennard_scene::Start;
use lennard_studies::sweep::{self, Ending, Sweep, SweepError, SweepOptions};

use crate::args::SweepArgs;
use crate::commands::{Inputs, output_folder, print_json};
use crate::failure::{DONE, Failure, INPUT, OTHER, STOPPED};
use crate::progress::Display;
use crate::show;
use crate::signals::{Signals, StartUp};

/// Exit code where physics stopped a point.
const PHYSICS: u8 = 3;
/// What is said of a sweep without a step that could be kept.
const NOT_BEGUN: &str = "stopped before the first step of any point: nothing was written";

/// Runs the points that are not finished yet, and prints their table.
pub fn sweep(args: &SweepArgs) -> Result<u8, Failure> {
    let signals = Signals::listen(StartUp::of_nothing(NOT_BEGUN))?;
    let sweep = sweep::load(&args.sweep, &args.set)?;
    if let Some(folder) = &args.out {
        keep_inputs(&args.sweep, &sweep, folder)?;
    }
    // What an earlier sweep has left there is looked at point by point.
    let folder = signals.claim(
        || output_folder(args.out.as_deref(), Existing::Keep, &sweep.name),
        // What a point has done is kept, and the sweep itself gives up what only starts.
        |_| None,
    )?;
    let threads = args
        .threads
        .map_or_else(lennard_core::parallel::processors, usize::from);
    let quiet = args.quiet || args.json;
    let again = format!(
        "lennard sweep {} --out {}",
        args.sweep.display(),
        folder.path().display()
    );
    let command = args.set.iter().fold(again, |line, (key, value)| {
        format!("{line} --set {key}={value}")
    });
    if !quiet {
        show::sweep_header(&sweep, threads, folder.path());
    }
    let mut display = Display::of_study(args.quiet);
    let options = SweepOptions {
        folder: folder.path(),
        threads,
        replace: args.force,
        reports: !args.no_report,
        stop: Arc::clone(signals.stop()),
        command: command.clone(),
    };
    let record = sweep::run(&sweep, &options, &mut display)?;
    drop(display);
    if args.json {
        print_json(&record)?;
    } else if !args.quiet && record.ending != Ending::NotBegun {
        show::sweep(&record, folder.path());
    }
    match record.ending {
        Ending::Finished => Ok(DONE),
        Ending::Failed => {
            for point in record.points.iter().filter(|p| p.failure.is_some()) {
                eprintln!(
                    "{}: {}",
                    point.name,
                    point.failure.as_deref().unwrap_or_default()
                );
            }
            Ok(PHYSICS)
        }
        Ending::NotBegun => {
            eprintln!("{NOT_BEGUN}");
            Ok(OTHER)
        }
        Ending::Stopped => {
            eprintln!(
                "stopped on request; what is finished is kept, and points at work have checkpoints\n  to go on: {command}"
            );
            Ok(STOPPED)
        }
    }
}

/// Refuses an output folder where a file that the sweep reads would be replaced or removed.
fn keep_inputs(file: &Path, sweep: &Sweep, folder: &Path) -> Result<(), Failure> {
    let configurations = sweep
        .points
        .iter()
        .filter_map(|point| match &point.scene.system.start {
            Start::Configuration { path, .. } => Some(path.clone()),
            Start::Lattice { .. } | Start::Slab(_) => None,
        });
    let mut inputs: Vec<PathBuf> = configurations.collect();
    inputs.dedup();
    inputs.extend([file.to_path_buf(), sweep.base.clone()]);
    let inputs = Inputs::of(inputs);
    for name in sweep::FILES {
        inputs.are_not(&folder.join(name))?;
    }
    for point in &sweep.points {
        inputs.not_in(&folder.join(&point.name))?;
    }
    Ok(())
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        let code = match &error {
            SweepError::Write(_) | SweepError::Report(_) => OTHER,
            SweepError::Start { source, .. } => source.exit_code(),
            _ => INPUT,
        };
        Self::new("the sweep", error, code)
    }
}
