//! Shared by a whole sweep and its tasks: inputs that are kept, options, the command to go on with, and the end.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use lennard_scene::Arrangement;
use lennard_studies::sweep::{self, Ending, Sweep, SweepOptions, SweepRecord, SweptPoint};

use crate::program::args::SweepArgs;
use crate::program::commands::{Inputs, answer};
use crate::program::failure::{DONE, Failure, INPUT, OTHER, STOPPED};
use crate::program::show::{self, Style};
use crate::program::signals::Signals;
use crate::program::typed;

/// What is said of a sweep without a step that could be kept.
pub(super) const NOT_BEGUN: &str =
    "stopped before the first step of any point: nothing was written";

/// Says on standard error what is not as it should be, and gives the exit code.
pub(super) fn ended(ending: Ending, points: &[SweptPoint], command: &str) -> u8 {
    for point in points {
        let failed = point.failure.as_ref().map(|failed| &failed.reason);
        if let Some(reason) = failed.or(point.elsewhere.as_ref()) {
            eprintln!("{}: {reason}", point.name);
        }
    }
    match ending {
        Ending::Finished => DONE,
        Ending::Failed => gravest(points),
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

/// The exit code of a sweep with failed points: physics, where it stopped one; else input, where one was at fault.
fn gravest(points: &[SweptPoint]) -> u8 {
    let failed = points.iter().filter_map(|point| point.failure.as_ref());
    failed.map(|failed| failed.exit_code).max().unwrap_or(OTHER)
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

/// How points are run into a folder.
pub(super) fn options<'a>(
    args: &SweepArgs,
    started: Instant,
    folder: &'a Path,
    threads: usize,
    signals: &Signals,
) -> SweepOptions<'a> {
    SweepOptions {
        folder,
        threads,
        replace: args.force,
        reports: !args.no_report,
        stop: Arc::clone(signals.stop()),
        deadline: args.max_walltime.and_then(|time| started.checked_add(time)),
        command: command(folder),
    }
}

/// Prints the record of a sweep, and gives the exit code.
pub(super) fn printed(
    args: &SweepArgs,
    quiet: bool,
    record: &SweepRecord,
    folder: &Path,
) -> Result<u8, Failure> {
    answer(args.json, quiet, record, || {
        show::print(&show::sweep(record, folder), Style::Narrow);
    })?;
    if let Some(failure) = &record.found.failure {
        eprintln!("{failure}");
    }
    Ok(ended(record.ending, &record.points, &command(folder)))
}

/// The command that runs or goes on with a whole sweep.
pub(super) fn command(folder: &Path) -> String {
    /// What belongs to one process, and not to the sweep.
    const OF_ONE: [&str; 7] = [
        "--point=",
        "--chunk=",
        "--emit=",
        "--max-walltime=",
        "--threads=",
        "--collect",
        "--points",
    ];
    typed::again(Some(folder), &OF_ONE)
}

/// Refuses an output folder where a file that the sweep reads would be replaced or removed.
pub(super) fn keep_inputs(file: &Path, sweep: &Sweep, folder: &Path) -> Result<(), Failure> {
    let configurations = sweep.points.iter().filter_map(|point| match &point.scene.system.start {
        Arrangement::File { path, .. } => Some(path.clone()),
        Arrangement::Lattice { .. }
        | Arrangement::Slab(_)
        | Arrangement::HalfCrystal(_)
        | Arrangement::Listed { .. } => None,
    });
    let mut inputs: Vec<PathBuf> = configurations.collect();
    inputs.dedup();
    inputs.extend([file.to_path_buf(), sweep.base.clone()]);
    let inputs = Inputs::of(inputs);
    for name in sweep::files() {
        inputs.are_not(&folder.join(name))?;
    }
    for point in &sweep.points {
        inputs.not_in(&folder.join(&point.name))?;
    }
    Ok(())
}
