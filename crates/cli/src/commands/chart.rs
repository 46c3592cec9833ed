//! `lennard chart`: speed against accuracy for one scene.

use std::process::ExitCode;

use lennard_io::Existing;
use lennard_studies::chart::{self, ChartError, ChartOptions};
use lennard_studies::settings::Size;

use crate::args::ChartArgs;
use crate::commands::{Inputs, load_file, output_folder, print_json};
use crate::failure::{Failure, INPUT, STOPPED};
use crate::progress::Display;
use crate::{show, signals};

/// Measures what is not measured yet, and prints where the scene's own settings stand.
pub fn chart(args: &ChartArgs) -> Result<ExitCode, Failure> {
    let stop = signals::stop_flag()?;
    let (scene, lock) = load_file(&args.scene, &args.set, args.lock.as_deref())?;
    if let Some(folder) = &args.out {
        let lock = lock.as_ref().map(|l| l.path.as_path());
        let inputs = Inputs::of_scene(&args.scene, lock, &scene);
        inputs.not_in(folder)?;
        inputs.not_below(&folder.join(chart::POINTS))?;
    }
    let folder = output_folder(
        args.out.as_deref(),
        Existing::Keep,
        &format!("{}-chart", scene.name),
    )?;
    let processors = lennard_core::parallel::processors();
    let command = command(args, &folder.path().display().to_string());
    let options = ChartOptions {
        folder: folder.path(),
        size: match (args.quick, args.full) {
            (true, _) => Size::Quick,
            (false, true) => Size::Full,
            (false, false) => Size::Default,
        },
        anew: args.force,
        workers: args.workers.map_or(processors, usize::from),
        threads: usize::from(args.threads),
        with_peers: args.with_peers,
        stop: &stop,
        command: command.clone(),
    };
    let mut display = Display::of_study(args.quiet);
    let found = chart::run(&scene, &options, &mut display)?;
    drop(display);
    if args.json {
        print_json(&found)?;
    } else if !args.quiet {
        show::chart(&found, folder.path());
    }
    if !found.finished {
        eprintln!("stopped on request; finished points are kept\n  to go on: {command}");
        return Ok(ExitCode::from(STOPPED));
    }
    Ok(ExitCode::SUCCESS)
}

/// The command that makes the same chart, or goes on with it.
fn command(args: &ChartArgs, folder: &str) -> String {
    let mut line = format!("lennard chart {} --out {folder}", args.scene.display());
    for (key, value) in &args.set {
        line += &format!(" --set {key}={value}");
    }
    if let Some(lock) = &args.lock {
        line += &format!(" --lock {}", lock.display());
    }
    for (wanted, flag) in [
        (args.quick, " --quick"),
        (args.full, " --full"),
        (args.with_peers, " --with-peers"),
    ] {
        if wanted {
            line += flag;
        }
    }
    if args.threads != 1 {
        line += &format!(" --threads {}", args.threads);
    }
    line
}

impl From<ChartError> for Failure {
    fn from(error: ChartError) -> Self {
        match error {
            ChartError::Study(error) => error.into(),
            other => Self::new("the chart", other, INPUT),
        }
    }
}
