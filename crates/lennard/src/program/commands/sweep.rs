//! `lennard sweep`: many state points from one file.

use std::time::Instant;

use lennard_core::parallel::{can_have, processors};
use lennard_io::Existing;
use lennard_studies::sweep::{self, Ending, Sweep, SweepError};

use crate::program::args::SweepArgs;
use crate::program::commands::output_folder;
use crate::program::commands::sweep_ends::{NOT_BEGUN, keep_inputs, options, printed};
use crate::program::commands::sweep_tasks::Tasks;
use crate::program::failure::{Failure, INPUT, OTHER};
use crate::program::progress::Display;
use crate::program::show::{self, Style};
use crate::program::signals::{Signals, StartUp};

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
