//! `lennard tune`: settings for the accuracy that a scene asks for.

use std::process::ExitCode;

use lennard_scene::{Lock, Scene};
use lennard_studies::tune::{self, TuneError, TuneOptions};

use crate::args::TuneArgs;
use crate::commands::{on_threads, print_json};
use crate::failure::{Failure, INPUT, OTHER};
use crate::progress::Display;
use crate::show;

/// Finds the settings, writes the lock file and prints what was wanted, predicted and measured.
pub fn tune(args: &TuneArgs) -> Result<ExitCode, Failure> {
    let scene = Scene::load(&args.scene.scene, &args.scene.overrides())?;
    let lock = args
        .scene
        .lock
        .clone()
        .unwrap_or_else(|| Lock::beside(&args.scene.scene));
    let available = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = args.scene.threads.map_or(available, usize::from);
    let options = TuneOptions {
        seconds: args.seconds,
        threads,
    };
    let mut display = Display::of_study(args.quiet);
    let tuning = on_threads(threads, || Ok(tune::tune(&scene, &options, &mut display)?))?;
    drop(display);
    let text = Lock::text(
        &scene,
        &tuning.chosen(),
        &tuning.judged(),
        &lennard_io::cpu_name(),
    );
    lennard_io::write_text_atomically(&lock, &text)?;
    if args.scene.json {
        print_json(&tuning)?;
    } else if !args.quiet {
        show::tuning(&tuning, &lock);
    }
    Ok(ExitCode::SUCCESS)
}

impl From<TuneError> for Failure {
    fn from(error: TuneError) -> Self {
        match error {
            TuneError::Scene(error) => Self::new("tuning the scene", error, INPUT),
            TuneError::Engine(error) => error.into(),
            TuneError::NoAccuracy(_) => Self::new("tuning the scene", error, INPUT),
            _ => Self::new("tuning the scene", error, OTHER),
        }
    }
}
