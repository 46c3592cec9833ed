//! `lennard sweep`: many state points from one file.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use lennard_io::Existing;
use lennard_scene::{Start, shipped};
use lennard_studies::sweep::{self, Ending, Sweep, SweepError, SweepOptions, SweptPoint};

use crate::args::SweepArgs;
use crate::commands::sweep_tasks::Tasks;
use crate::commands::{Inputs, output_folder, print_json};
use crate::failure::{DONE, Failure, INPUT, OTHER, STOPPED};
use crate::progress::Display;
use crate::show;
use crate::signals::{Signals, StartUp};

/// Exit code where physics stopped a point.
const PHYSICS: u8 = 3;
/// What is said of a sweep without a step that could be kept.
const NOT_BEGUN: &str = "stopped before the first step of any point: nothing was written";

/// Does what is asked of a sweep.
pub fn sweep(args: &SweepArgs) -> Result<u8, Failure> {
    let tasks = Tasks {
        args,
        started: Instant::now(),
    };
    match (&args.point, args.emit) {
        (Some(point), _) => tasks.run(point),
        (None, Some(scheduler)) => tasks.emit(scheduler),
        (None, None) if args.points => tasks.list(),
        (None, None) if args.collect => tasks.collect(),
        (None, None) => whole(args, tasks.started),
    }
}

/// Runs the points that are not finished yet, and prints their table.
fn whole(args: &SweepArgs, started: Instant) -> Result<u8, Failure> {
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
    let command = command(args, folder.path());
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
        deadline: deadline(args, started),
        command: command.clone(),
    };
    let record = sweep::run(&sweep, &options, &mut display)?;
    drop(display);
    if args.json {
        print_json(&record)?;
    } else if !args.quiet && record.ending != Ending::NotBegun {
        show::sweep(&record, folder.path());
    }
    Ok(ended(record.ending, &record.points, &command))
}

/// Says on standard error what is not as it should be, and gives the exit code.
pub(super) fn ended(ending: Ending, points: &[SweptPoint], command: &str) -> u8 {
    for point in points {
        if let Some(reason) = point.failure.as_ref().or(point.elsewhere.as_ref()) {
            eprintln!("{}: {reason}", point.name);
        }
    }
    match ending {
        Ending::Finished => DONE,
        Ending::Failed => PHYSICS,
        Ending::Elsewhere => INPUT,
        Ending::NotBegun => {
            eprintln!("{NOT_BEGUN}");
            OTHER
        }
        Ending::Incomplete => {
            let missing = points.iter().filter(|p| p.is_unfinished());
            let names: Vec<&str> = missing.map(|p| p.name.as_str()).collect();
            eprintln!(
                "{} of {} points are not finished: {}\n  to run them: {command}",
                names.len(),
                points.len(),
                some_of(&names)
            );
            STOPPED
        }
        Ending::Stopped => {
            eprintln!(
                "stopped on request; what is finished is kept, and points at work have checkpoints\n  to go on: {command}"
            );
            STOPPED
        }
    }
}

/// The first names of a list.
fn some_of(names: &[&str]) -> String {
    const SHOWN: usize = 5;
    let shown = names[..names.len().min(SHOWN)].join(", ");
    if names.len() > SHOWN {
        return format!("{shown}, …");
    }
    shown
}

/// When to stop.
pub(super) fn deadline(args: &SweepArgs, started: Instant) -> Option<Instant> {
    started.checked_add(args.max_walltime?)
}

/// The command that runs or goes on with a sweep, as a shell reads it.
pub(super) fn command(args: &SweepArgs, folder: &Path) -> String {
    let shipped = shipped::find(&args.sweep).filter(|_| shipped::is_shipped(&args.sweep));
    let name = shipped.map_or_else(|| args.sweep.to_string_lossy(), |sweep| sweep.name.into());
    let file = in_shell(&name);
    let line = format!(
        "lennard sweep {file} --out {}",
        in_shell(&folder.to_string_lossy())
    );
    args.set.iter().fold(line, |line, (key, value)| {
        format!("{line} --set {}", in_shell(&format!("{key}={value}")))
    })
}

/// A word as a shell reads it: in quotes where it has more than plain letters.
fn in_shell(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// Refuses an output folder where a file that the sweep reads would be replaced or removed.
pub(super) fn keep_inputs(file: &Path, sweep: &Sweep, folder: &Path) -> Result<(), Failure> {
    let configurations = sweep
        .points
        .iter()
        .filter_map(|point| match &point.scene.system.start {
            Start::Configuration { path, .. } => Some(path.clone()),
            Start::Lattice { .. } | Start::Slab(_) | Start::Listed { .. } => None,
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
