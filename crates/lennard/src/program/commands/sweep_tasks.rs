//! A sweep in parts, for many processes on one machine or on many: each runs points of its own, and one collects.

use std::path::Path;
use std::time::Instant;

use lennard_io::{Existing, shown};
use lennard_studies::sweep::{self, Plan, Scheduler, Script};
use serde::Serialize;
use serde_json::json;

use crate::program::args::{SchedulerName, SweepArgs};
use crate::program::commands::sweep_ends::{
    NOT_BEGUN, command, ended, keep_inputs, options, printed,
};
use crate::program::commands::{answer, output_folder};
use crate::program::failure::{DONE, Failure, INPUT};
use crate::program::out;
use crate::program::progress::Display;
use crate::program::signals::{Signals, StartUp};

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
