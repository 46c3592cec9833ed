//! `lennard run`: a scene from start to finished folder.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use lennard_core::{PeriodicBox, Team};
use lennard_engine::{Control, Ending, EngineError, Outcome, Progress};
use lennard_io::{OutputFolder, path_in_shell};
use lennard_studies::run_page;

use crate::program::args::{ControlArgs, RunArgs};
use crate::program::commands::{
    load_locked, on_threads, output_folder, print_json, replace_if, threads_with,
};
use crate::program::failure::{DONE, Failure, STOPPED};
use crate::program::progress::Display;
use crate::program::ranks;
use crate::program::show::{self, Style};
use crate::program::signals::{FirstStep, Leave, Signals, StartUp};
use crate::program::watch::LivePage;

/// Runs a scene and prints the table of its results.
pub fn run(args: &RunArgs) -> Result<u8, Failure> {
    run_on(args, None)
}

/// As [`run`], on one of several ranks where there is a team. Rank 0 alone writes and prints.
pub fn run_on(args: &RunArgs, team: Option<&Team>) -> Result<u8, Failure> {
    let deadline = args.control.deadline(Instant::now());
    let nothing = || StartUp::of_nothing("stopped before the first step: nothing was written");
    let signals = Signals::listen(nothing())?;
    let loaded = || {
        let (scene, lock) = load_locked(&args.scene)?;
        if let Some(folder) = &args.out {
            args.scene.inputs(&scene, lock.as_ref()).not_in(folder)?;
        }
        Ok((scene, lock))
    };
    let quiet = args.control.quiet || args.scene.json;
    let (scene, lock) = ranks::together(team, loaded())?;
    // Everything that can be wrong with the scene shows before anything is written.
    let prepared = lennard_engine::prepare_on(scene, team).map_err(ranks::apart);
    let mut simulation = ranks::together(team, prepared)?;
    let threads = ranks::threads(team, args.scene.threads, |asked| {
        threads_with(asked, lock.as_ref(), simulation.system.len())
    });
    let name = &simulation.scene.name;
    let claim = || {
        signals.claim(
            || output_folder(args.out.as_deref(), replace_if(args.force), name),
            |_| Some(nothing().leaving(Leave::WithoutTheRun)),
        )
    };
    let Some(folder) = ranks::made_by_first(team, claim)? else {
        let steps = |control: Control<'_>| lennard_engine::run(&mut simulation, None, control);
        return ranks::beside(team, threads, &signals, steps);
    };
    if !quiet {
        let lock = lock.as_ref().map(|lock| format!("settings from {}", lock.path.display()));
        let header = show::header(&simulation, threads, folder.path()).texts(lock);
        let remarks = simulation.remarks.iter().cloned().chain(simulation.foreseen());
        show::print(&header.texts(remarks), Style::Ruled);
    }
    let page = args.watch.then(|| LivePage::new(folder.path(), simulation.state.cell));
    let display = Display::new(args.control.quiet).watching(page);
    let display = FirstStep::new(&signals, display);
    let run = Running {
        team,
        folder: &folder,
        threads,
        stop: signals.stop(),
        deadline,
        total: simulation.scene.total_steps(),
        watch: args.watch.then_some(simulation.state.cell),
    };
    let work = |control: Control<'_>| lennard_engine::run(&mut simulation, &*folder, control);
    run.to_its_end(display, work, args.scene.json, &args.control)
}

/// A run or the rest of one, in its folder.
pub struct Running<'a> {
    pub team: Option<&'a Team>,
    pub folder: &'a OutputFolder,
    pub threads: usize,
    pub stop: &'a AtomicBool,
    pub deadline: Option<Instant>,
    /// Steps of the whole scene.
    pub total: u64,
    /// The box in which it begins, where a page shows the run as it goes.
    pub watch: Option<PeriodicBox>,
}

impl Running<'_> {
    /// Does the steps that are left, writes the page, and prints what was found.
    pub fn to_its_end(
        &self,
        mut progress: impl Progress,
        steps: impl FnOnce(Control<'_>) -> Result<Outcome, EngineError> + Send,
        json: bool,
        args: &ControlArgs,
    ) -> Result<u8, Failure> {
        let Self { team, threads, stop, deadline, total, watch, .. } = *self;
        let folder = self.folder.path();
        let outcome = on_threads(threads, || {
            let control = Control { stop, deadline, progress: &mut progress };
            steps(control).map_err(|e| ranks::failed(team, e, folder))
        })?;
        drop(progress);
        match (outcome.ending, watch) {
            (Ending::Finished, _) if args.no_report => {}
            (Ending::Finished, _) => run_page::write(folder)?,
            (_, Some(cell)) => run_page::write_under_way(folder, cell)?,
            (_, None) => {}
        }
        tell(&outcome, folder, total, json, args)
    }
}

/// Prints what a run found, or where it stopped.
pub fn tell(
    outcome: &Outcome,
    folder: &Path,
    total: u64,
    json: bool,
    control: &ControlArgs,
) -> Result<u8, Failure> {
    let (quiet, verbose) = (control.quiet || json, control.verbose);
    if json {
        print_json(&outcome.record)?;
    }
    let why = match outcome.ending {
        Ending::Finished => {
            if !quiet {
                let run = lennard_studies::compare::RunFolder::open(folder)?;
                let compared = lennard_studies::compare::compare(&run);
                let style = if verbose { Style::Ruled } else { Style::Open };
                show::print(&show::results(&outcome.record, &compared, folder, verbose), style);
            }
            return Ok(DONE);
        }
        Ending::Stopped => "stopped on request",
        Ending::OutOfTime => "stopped by --max-walltime",
    };
    eprintln!(
        "{why} after step {} of {total}, with a checkpoint\n  to go on: lennard resume {}",
        outcome.record.steps,
        path_in_shell(folder)
    );
    Ok(STOPPED)
}
