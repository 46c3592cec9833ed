//! `lennard measure`: the observables of a scene over the frames of a trajectory.

use std::time::Instant;

use lennard_engine::{Control, Ending, Measurement, Trajectory};
use lennard_io::{FileUnits, TrajectoryFormat};
use lennard_scene::Arrangement;

use crate::program::args::MeasureArgs;
use crate::program::commands::run::tell;
use crate::program::commands::{load_locked, on_threads, output_folder, replace_if, threads_with};
use crate::program::failure::{Failure, OTHER};
use crate::program::progress::Display;
use crate::program::show::{self, Style};
use crate::program::signals::{Signals, StartUp};

/// What is true of a measurement that a signal ends.
const NOTHING: &str = "stopped before the last frame: nothing was written";

/// Measures a trajectory into the folder of a run, and prints the table of results.
pub fn measure(args: &MeasureArgs) -> Result<u8, Failure> {
    let deadline = args.control.deadline(Instant::now());
    let nothing = || StartUp::of_nothing(NOTHING);
    let signals = Signals::listen(nothing())?;
    let (scene, lock) = load_locked(&args.scene)?;
    if let Some(folder) = &args.out {
        args.scene.inputs(&scene, lock.as_ref()).with(&args.trajectory).not_in(folder)?;
    }
    let own = match &scene.system.start {
        Arrangement::File { units, .. } => *units,
        _ => FileUnits::default(),
    };
    let mut units = FileUnits::new(
        args.length_scale.or(own.length),
        args.time_scale.or(own.time),
        scene.units.map(|units| units.length_time_mass()),
    );
    let output = &scene.output;
    units.xtc = (output.format == TrajectoryFormat::Xtc).then_some(output.length_scale);
    let trajectory = Trajectory { file: args.trajectory.clone(), interval: args.interval, units };
    let mut measurement = Measurement::open(scene, &trajectory)?;
    let simulation = &measurement.simulation;
    let threads = threads_with(args.scene.threads, lock.as_ref(), simulation.state.len());
    let make =
        || output_folder(args.out.as_deref(), replace_if(args.force), &simulation.scene.name);
    // Nothing is written before the last frame is read: a folder that was made goes again.
    let folder = signals.claim(make, |_| Some(nothing()))?;
    let quiet = args.control.quiet || args.scene.json;
    if !quiet {
        let header = show::header(simulation, threads, folder.path());
        show::print(&header.texts(simulation.remarks.clone()), Style::Ruled);
    }
    let mut progress = Display::new(args.control.quiet);
    let outcome = on_threads(threads, || {
        let control = Control { stop: signals.stop(), deadline, progress: &mut progress };
        match measurement.read(control)? {
            Ending::Finished => {
                signals.under_way();
                Ok(measurement.write(&folder)?)
            }
            Ending::Stopped | Ending::OutOfTime => {
                Err(Failure { message: NOTHING.to_owned(), code: OTHER })
            }
        }
    });
    let outcome = outcome.inspect_err(|_| folder.leave())?;
    drop(progress);
    if !args.control.no_report {
        lennard_studies::run_page::write(folder.path())?;
    }
    let frames = outcome.record.steps;
    tell(&outcome, folder.path(), frames, args.scene.json, &args.control)
}
