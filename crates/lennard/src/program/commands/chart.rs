//! `lennard chart`: speed against accuracy for one scene.

use std::path::{Path, PathBuf};
use std::time::Instant;

use lennard_io::Existing;
use lennard_scene::{Lock, Scene, UsedLock};
use lennard_studies::chart::{self, ChartOptions, Size};
use lennard_studies::sweep::{self, Sweep};

use crate::program::args::{ChartArgs, SweepArgs};
use crate::program::commands::sweep::whole;
use crate::program::commands::{Inputs, answer, output_folder};
use crate::program::failure::{Failure, STOPPED};
use crate::program::progress::Display;
use crate::program::show::{self, Style};
use crate::program::signals::{FirstStep, Signals, StartUp};
use crate::program::typed;

/// Measures what is not measured yet, and prints where the scene's own settings stand.
pub fn chart(args: &ChartArgs) -> Result<u8, Failure> {
    if args.ensemble {
        return ensemble(args);
    }
    let nothing = || StartUp::of_nothing("stopped before the first point: no point was measured");
    let signals = Signals::listen(nothing())?;
    let (scene, lock, study) = read(args)?;
    if let Some(folder) = &args.out {
        let lock = lock.as_ref().map(|l| l.path.as_path());
        let inputs = Inputs::of_scene(&args.scene, lock, &scene);
        inputs.not_in(folder)?;
        inputs.not_below(&folder.join(chart::POINTS))?;
    }
    let folder = signals.claim(
        || output_folder(args.out.as_deref(), Existing::Keep, &format!("{}-chart", scene.name)),
        |folder| Some(nothing().unless_kept(chart::has_points, kept_points(folder))),
    )?;
    let processors = lennard_core::parallel::processors();
    let options = ChartOptions {
        folder: folder.path(),
        size: of_size(args, [Size::Quick, Size::Default, Size::Full]),
        anew: args.force,
        workers: args.workers.map_or(processors, usize::from),
        threads: usize::from(args.threads),
        with_peers: args.with_peers,
        stop: signals.stop(),
        command: typed::again(Some(folder.path()), &[]),
    };
    let mut display = FirstStep::new(&signals, Display::of_study(args.quiet));
    let found = chart::run(&scene, &study, &options, &mut display)
        .map_err(|error| Failure::of_study("the chart", error))?;
    drop(display);
    let done = answer(args.json, args.quiet, &found, || {
        show::print(&show::chart(&found, folder.path()), Style::Narrow);
    })?;
    if !found.finished {
        eprintln!("{}", kept_points(folder.path()));
        return Ok(STOPPED);
    }
    Ok(done)
}

/// The scene with its lock file, and the points around it. They are of the study file that is named, or of a shipped one.
fn read(args: &ChartArgs) -> Result<(Scene, Option<UsedLock>, Sweep), Failure> {
    if lennard_scene::shipped::is_study(&args.scene) {
        let (scene, study) = sweep::of_command("chart", &args.scene, &args.set)?;
        return Ok((scene, None, study));
    }
    let (scene, lock) = Scene::load_settled(&args.scene, &args.set, args.lock.as_deref())?;
    scene.homogeneous_for("lennard chart")?;
    let mut overrides = args.set.clone();
    if let Some(lock) = &lock {
        let chosen = Lock::load(&lock.path)?.chosen().overrides();
        overrides.extend(chosen.into_iter().filter(|(key, _)| !scene.source.wrote(key)));
    }
    let name = of_size(args, ["chart-quick", "chart", "chart-full"]);
    let study = sweep::over(&studies(name), &args.scene, &overrides)?;
    Ok((scene, lock, study))
}

/// A shipped study file.
fn studies(name: &str) -> PathBuf {
    format!("shipped:/studies/{name}.toml").into()
}

/// What belongs to the size that is asked for.
fn of_size<T>(args: &ChartArgs, [quick, default, full]: [T; 3]) -> T {
    match (args.quick, args.full) {
        (true, _) => quick,
        (false, true) => full,
        (false, false) => default,
    }
}

/// Runs the shipped sweep over settings of barostat and thermostat with this scene.
fn ensemble(args: &ChartArgs) -> Result<u8, Failure> {
    let name = of_size(args, ["ensemble-quick", "ensemble", "ensemble-full"]);
    let sweep = SweepArgs {
        sweep: args.scene.clone(),
        set: args.set.clone(),
        out: args.out.clone(),
        points: false,
        point: None,
        chunk: 1,
        collect: false,
        emit: None,
        max_walltime: None,
        force: args.force,
        threads: args.workers,
        no_report: false,
        json: args.json,
        quiet: args.quiet,
    };
    whole(&sweep, Instant::now(), || sweep::over(&studies(name), &args.scene, &args.set))
}

fn kept_points(folder: &Path) -> String {
    let command = typed::again(Some(folder), &[]);
    format!("stopped on request; finished points are kept\n  to go on: {command}")
}
