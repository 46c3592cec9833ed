//! `lennard resume`: a run goes on from its checkpoint, to the bit.

use std::time::Instant;

use lennard_core::Team;
use lennard_engine::{Control, EngineError, ResumeError, ResumeOptions};
use lennard_io::Existing;

use crate::program::args::ResumeArgs;
use crate::program::commands::run::Running;
use crate::program::commands::{output_folder, threads};
use crate::program::failure::Failure;
use crate::program::progress::Display;
use crate::program::ranks;
use crate::program::show::{self, Style};
use crate::program::signals::{Signals, StartUp};
use crate::program::typed;
use crate::program::watch::LivePage;

/// Goes on with a run and prints the table of its results.
pub fn resume(args: &ResumeArgs) -> Result<u8, Failure> {
    resume_on(args, None)
}

/// As [`resume`], on one of several ranks where there is a team. Rank 0 alone writes and prints.
pub fn resume_on(args: &ResumeArgs, team: Option<&Team>) -> Result<u8, Failure> {
    let deadline = args.control.deadline(Instant::now());
    let loading = || {
        StartUp::resumable(&format!(
            "stopped before the first step: the checkpoint is untouched\n  to go on: {}",
            typed::again(None, &[])
        ))
    };
    let signals = Signals::listen(loading())?;
    let options = ResumeOptions {
        more_steps: args.steps.unwrap_or(0),
        isa: args.isa.clone(),
        older: args.older,
        output: args.set.clone(),
    };
    let resume = || lennard_engine::resume_on(&args.folder, &options, team).map_err(ranks::apart);
    // Claimed before it is read: what another process writes there would change in between.
    let claim = || {
        if !args.folder.is_dir() {
            return Err(EngineError::from(ResumeError::NoRun(args.folder.clone())).into());
        }
        signals.claim(|| output_folder(Some(&args.folder), Existing::Keep, ""), |_| Some(loading()))
    };
    let folder = ranks::made_by_first(team, claim)?;
    let mut resumed = ranks::together(team, resume())?;
    let quiet = args.control.quiet || args.json;
    let threads =
        ranks::threads(team, args.threads, |asked| threads(asked, resumed.simulation.system.len()));
    let Some(folder) = folder else {
        let steps = |control: Control<'_>| lennard_engine::go_on(&mut resumed, None, control);
        return ranks::beside(team, threads, &signals, steps);
    };
    let simulation = &resumed.simulation;
    let (step, total) = (simulation.state.step, simulation.scene.total_steps());
    if !quiet {
        let from = resumed.checkpoint.display();
        let done = "all steps were done already; --steps N goes on for N more";
        let header = show::header(simulation, threads, &args.folder)
            .text(format!("goes on after step {step} of {total}, from {from}"))
            .texts((step == total).then_some(done));
        show::print(&header, Style::Ruled);
    }
    // The checkpoint is loaded: whatever happens now, the run can go on.
    signals.under_way();
    // A page of a shorter run, or of one under way, says nothing of this one.
    if step < total {
        let _ = std::fs::remove_file(folder.path().join("report.html"));
    }
    let watch = args.watch.then_some(simulation.state.cell);
    let run =
        Running { team, folder: &folder, threads, stop: signals.stop(), deadline, total, watch };
    let page = watch.map(|cell| LivePage::new(folder.path(), cell));
    let display = Display::new(args.control.quiet).watching(page);
    let work = |control: Control<'_>| lennard_engine::go_on(&mut resumed, &*folder, control);
    run.to_its_end(display, work, args.json, &args.control)
}
