//! `lennard tune`: settings for the accuracy that a scene asks for.

use std::path::Path;

use lennard_io::{in_shell, path_in_shell};
use lennard_scene::{Chosen, Lock, Scene};
use lennard_studies::StudyError;
use lennard_studies::tune::{self, TuneOptions};

use crate::program::args::TuneArgs;
use crate::program::commands::{Inputs, answer, on_threads};
use crate::program::failure::{Failure, INPUT};
use crate::program::progress::Display;
use crate::program::show::{self, Style};
use crate::program::signals::{Signals, StartUp};

/// Finds the settings, writes the lock file and prints what was wanted, predicted and measured. A scene with settings of
/// its own is asked for the usual accuracy, and nothing is written: it would not read a lock.
pub fn tune(args: &TuneArgs) -> Result<u8, Failure> {
    Signals::listen(StartUp::of_nothing(
        "stopped before the end: no lock file was written, and there is nothing to go on from",
    ))?;
    let (path, overrides) = (&args.scene.scene, args.scene.overrides());
    let asked = Scene::load(path, &overrides)?;
    let named = args.scene.lock.clone();
    let (scene, lock) = if asked.accuracy.is_some() {
        (asked, Some(named.unwrap_or_else(|| Lock::beside(path))))
    } else if named.is_some() {
        return Err(failed(tune::no_accuracy(&path.display().to_string())));
    } else {
        (Scene::load_freed(path, &overrides)?, None)
    };
    if let Some(lock) = &lock {
        can_be_written(lock)?;
        Inputs::of_scene(path, None, &scene).are_not(lock)?;
    }
    let available = lennard_core::parallel::processors();
    let threads = args.scene.threads.map_or(available, usize::from);
    let options = TuneOptions { seconds: args.seconds, threads };
    let mut display = Display::of_study(args.quiet);
    let tuning =
        on_threads(threads, || tune::tune(&scene, &options, &mut display).map_err(failed))?;
    drop(display);
    if let Some(lock) = &lock {
        let text = Lock::text(&scene, &tuning.chosen(), &tuning.judged(), &lennard_io::cpu_name());
        let remarks = tuning.speed.remarks.iter().map(|r| format!("# {r}.\n"));
        lennard_io::write_text_atomically(lock, &(remarks.collect::<String>() + &text))?;
    }
    answer(args.scene.json, args.quiet, &tuning, || {
        let taken = match &lock {
            Some(lock) => format!("{}; `lennard run` takes the settings from there", lock.display()),
            None => {
                "the scene has settings of its own and asks for no `accuracy`, so no lock is written; to run it with these:"
                    .to_owned()
            }
        };
        show::print(&show::tuning(&tuning).text(taken), Style::Ruled);
        if lock.is_none() {
            println!("  {}", with_settings(path, &overrides, &tuning.chosen()));
        }
    })
}

/// Refuses a lock file without a folder to write it to, before a minute is spent.
fn can_be_written(lock: &Path) -> Result<(), Failure> {
    let folder = match lock.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if folder.is_dir() && !lock.is_dir() {
        return Ok(());
    }
    let error = format!(
        "{}: the lock file cannot be written there\n  found:   {}\n  allowed: a file in a folder that exists",
        lock.display(),
        if lock.is_dir() { "a folder" } else { "no such folder" }
    );
    Err(Failure::new("tuning the scene", error, INPUT))
}

/// The command that runs a scene with chosen settings.
fn with_settings(path: &Path, overrides: &[(String, String)], chosen: &Chosen) -> String {
    let mut command = format!("lennard run {} --threads {}", path_in_shell(path), chosen.threads);
    let settings = chosen.overrides();
    let is_chosen = |key: &str| settings.iter().any(|(chosen, _)| chosen == key);
    let fixed = overrides.iter().filter(|(key, _)| !is_chosen(key));
    for (key, value) in fixed.chain(&settings) {
        command += &format!(" --set {}", in_shell(&format!("{key}={value}")));
    }
    command
}

fn failed(error: StudyError) -> Failure {
    Failure::of_study("tuning the scene", error)
}
