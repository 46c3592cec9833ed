//! `lennard run`: a scene from start to finished folder.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use lennard_engine::{EngineError, Ending, RunOptions};
use lennard_io::Existing;

use crate::args::RunArgs;
use crate::commands::{load, on_threads, print_json, threads};
use crate::failure::Failure;
use crate::progress::Display;
use crate::show;

/// Exit code of a run that was asked to stop and can be resumed.
const STOPPED: u8 = 4;

/// Runs a scene and prints the table of its results.
pub fn run(args: &RunArgs) -> Result<ExitCode, Failure> {
    let scene = load(&args.scene)?;
    let quiet = args.quiet || args.scene.json;
    // Everything that can be wrong with the scene shows before anything is written.
    let mut simulation = lennard_engine::prepare(scene)?;
    let threads = threads(&args.scene, simulation.state.len());
    let folder = folder(args, &simulation.scene.name)?;
    if !quiet {
        show::header(&simulation, threads, &folder);
    }
    let stop = AtomicBool::new(false);
    let mut display = Display::new(args.quiet);
    let outcome = on_threads(threads, || {
        let options = RunOptions { folder: &folder, threads, stop: &stop, progress: &mut display };
        Ok(lennard_engine::run(&mut simulation, options)?)
    })?;
    drop(display);
    if args.scene.json {
        print_json(&outcome.record)?;
    } else if !quiet {
        show::results(&outcome.record, &folder);
    }
    Ok(match outcome.ending {
        Ending::Finished => ExitCode::SUCCESS,
        Ending::Stopped => ExitCode::from(STOPPED),
    })
}

/// Makes the output folder: the one named, or the first free number.
fn folder(args: &RunArgs, scene: &str) -> Result<PathBuf, Failure> {
    let made = match &args.out {
        Some(folder) => {
            let existing = if args.force { Existing::Replace } else { Existing::Refuse };
            lennard_io::create_named_folder(folder, existing).map(|()| folder.clone())
        }
        None => lennard_io::create_numbered_folder("runs".as_ref(), scene),
    };
    made.map_err(|e| EngineError::Folder(e).into())
}
