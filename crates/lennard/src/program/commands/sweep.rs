//! `lennard sweep`: many state points from one file.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use lennard_core::parallel::{can_have, processors};
use lennard_io::{Existing, shown};
use lennard_scene::Arrangement;
use lennard_studies::sweep::{
    self, Ending, Plan, Scheduler, Script, Sweep, SweepError, SweepOptions, SweepRecord, SweptPoint,
};
use serde::Serialize;
use serde_json::json;

use crate::program::args::{SchedulerName, SweepArgs};
use crate::program::commands::{Inputs, answer, output_folder};
use crate::program::failure::{DONE, Failure, INPUT, OTHER, STOPPED};
use crate::program::progress::Display;
use crate::program::show::{self, Style};
use crate::program::signals::{Signals, StartUp};
use crate::program::{out, typed};

/// Does what is asked of a sweep.
pub fn sweep(args: &SweepArgs) -> Result<u8, Failure> {
    let tasks = Tasks { args, started: Instant::now() };
    match (&args.point, args.emit) {
        (Some(point), _) => tasks.run(point),
        (None, Some(scheduler)) => tasks.emit(scheduler),
        (None, None) if args.points => tasks.list(),
        (None, None) if args.collect => tasks.collect(),
        (None, None) => whole(args, tasks.started, || sweep::load(&args.sweep, &args.set)),
    }
}

/// Runs the points that are not finished yet, and prints their table.
pub fn whole(
    args: &SweepArgs,
    started: Instant,
    load: impl FnOnce() -> Result<Sweep, SweepError>,
) -> Result<u8, Failure> {
    let signals = Signals::listen(StartUp::of_nothing(NOT_BEGUN))?;
    let sweep = load()?;
    if let Some(folder) = &args.out {
        keep_inputs(&args.sweep, &sweep, folder)?;
    }
    let threads = args.threads.map_or_else(processors, usize::from);
    can_have(threads)?;
    // What an earlier sweep has left there is looked at point by point.
    let folder = signals.claim(
        || output_folder(args.out.as_deref(), Existing::Keep, &sweep.name),
        // What a point has done is kept, and the sweep itself gives up what only starts.
        |_| None,
    )?;
    if !args.quiet && !args.json {
        show::print(&show::sweep_header(&sweep, threads, folder.path()), Style::Narrow);
    }
    let mut display = Display::of_study(args.quiet);
    let options = options(args, started, folder.path(), threads, &signals);
    let record = sweep::run(&sweep, &options, &mut display)?;
    drop(display);
    printed(args, args.quiet || record.ending == Ending::NotBegun, &record, folder.path())
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
        _ => None,
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

/// What is asked of a sweep in parts.
pub(super) struct Tasks<'a> {
    pub(super) args: &'a SweepArgs,
    pub(super) started: Instant,
}

/// A point of the list.
#[derive(Serialize)]
struct Listed<'a> {
    number: usize,
    name: &'a str,
    values: serde_json::Map<String, serde_json::Value>,
}

impl Tasks<'_> {
    fn plan(&self) -> Result<Plan, Failure> {
        Ok(sweep::plan(&self.args.sweep, &self.args.set)?)
    }

    /// The folder that was named.
    fn folder(&self) -> &Path {
        // The arguments require it wherever it is asked for.
        self.args.out.as_deref().unwrap_or(Path::new("."))
    }

    /// Prints the points.
    pub(super) fn list(&self) -> Result<u8, Failure> {
        let plan = self.plan()?;
        let points: Vec<Listed<'_>> = plan
            .points
            .iter()
            .enumerate()
            .map(|(number, point)| Listed {
                number,
                name: &point.name,
                values: point.values().map(|(key, text)| (key.to_owned(), value(text))).collect(),
            })
            .collect();
        answer(self.args.json, false, &document(&points), || {
            for point in &points {
                println!("{:>5}  {}", point.number, point.name);
            }
        })
    }

    /// Runs the points of one task.
    pub(super) fn run(&self, point: &str) -> Result<u8, Failure> {
        let signals = Signals::listen(StartUp::of_nothing(NOT_BEGUN))?;
        let args = self.args;
        let plan = self.plan()?;
        let chunk = args.chunk as usize;
        let first = match point.parse::<usize>() {
            // The number of a task, where tasks have more points than one.
            Ok(task) if chunk > 1 => task.saturating_mul(chunk),
            _ => plan.number_of(point)?,
        };
        // A task beyond the last is as wrong as a point.
        plan.number_of(&first.to_string())?;
        let part = plan.part(first..first.saturating_add(chunk))?;
        keep_inputs(&args.sweep, &part, self.folder())?;
        let threads = args
            .threads
            .map_or_else(|| lennard_engine::recommended_threads(part.points[0].atoms), usize::from);
        signals.under_way();
        let mut display = Display::of_study(args.quiet);
        let options = options(args, self.started, self.folder(), threads, &signals);
        let points = sweep::run_points(&part, &options, &mut display)?;
        drop(display);
        answer(args.json, args.quiet, &document(&points), || {
            for point in points.iter().filter(|point| point.compared.is_some()) {
                let before = if point.kept { ", by an earlier process" } else { "" };
                println!("{}: finished{before}", point.name);
            }
        })?;
        let ending = sweep::ending_of(&points, self.folder());
        let again = format!("{} --point {point}", options.command);
        let again = if chunk > 1 { format!("{again} --chunk {chunk}") } else { again };
        Ok(ended(ending, &points, &again))
    }

    /// Writes the table of what is finished.
    pub(super) fn collect(&self) -> Result<u8, Failure> {
        let args = self.args;
        let sweep = self.plan()?.sweep()?;
        keep_inputs(&args.sweep, &sweep, self.folder())?;
        let folder = output_folder(Some(self.folder()), Existing::Keep, &sweep.name)?;
        let record = sweep::collect(&sweep, folder.path(), &command(folder.path()))?;
        printed(args, args.quiet, &record, folder.path())
    }

    /// Prints a script for a scheduler.
    pub(super) fn emit(&self, scheduler: SchedulerName) -> Result<u8, Failure> {
        let plan = self.plan()?;
        // A wrong scene shows before the script is sent away.
        plan.check()?;
        let folder = shown(self.folder()).to_string();
        if scheduler == SchedulerName::Snakemake
            && (Path::new(&folder) != self.folder() || folder.contains(['{', '}']))
        {
            let error = format!(
                "Snakemake cannot name the output folder\n  found:   {folder}\n  allowed: a folder whose name has no braces and no line ends"
            );
            return Err(Failure::new("writing the script", error, INPUT));
        }
        let script = Script {
            command: command(self.folder()),
            folder,
            plan: &plan,
            chunk: self.args.chunk as usize,
            // Small points are fastest with a thread each, side by side.
            threads: self.args.threads.map_or(1, usize::from),
            time: self.args.max_walltime,
        };
        out::text(&script.text(match scheduler {
            SchedulerName::Slurm => Scheduler::Slurm,
            SchedulerName::Parallel => Scheduler::Parallel,
            SchedulerName::Snakemake => Scheduler::Snakemake,
        }));
        Ok(DONE)
    }
}

/// Points as one JSON document.
fn document(points: &impl Serialize) -> serde_json::Value {
    json!({ "schema": lennard_io::schema!("sweep-points", 1), "points": points })
}

/// A number where the text is one.
fn value(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap_or_else(|_| text.into())
}
