//! `lennard chart`: speed against accuracy for one scene.

use std::path::Path;

use lennard_io::Existing;
use lennard_scene::Scene;
use lennard_studies::chart::{self, Axes, ChartError, ChartOptions, Size};

use crate::program::args::ChartArgs;
use crate::program::commands::{Inputs, answer, output_folder};
use crate::program::failure::{Failure, INPUT, STOPPED};
use crate::program::progress::Display;
use crate::program::show::{self, Style};
use crate::program::signals::{FirstStep, Signals, StartUp};
use crate::program::typed;

/// Measures what is not measured yet, and prints where the scene's own settings stand.
pub fn chart(args: &ChartArgs) -> Result<u8, Failure> {
    let nothing = || StartUp::of_nothing("stopped before the first point: no point was measured");
    let signals = Signals::listen(nothing())?;
    let (scene, lock) = Scene::load_settled(&args.scene, &args.set, args.lock.as_deref())?;
    scene.homogeneous_for("lennard chart")?;
    if args.ensemble {
        chart::suits(&scene)?;
    }
    if let Some(folder) = &args.out {
        let lock = lock.as_ref().map(|l| l.path.as_path());
        let inputs = Inputs::of_scene(&args.scene, lock, &scene);
        inputs.not_in(folder)?;
        inputs.not_below(&folder.join(chart::POINTS))?;
    }
    let kind = if args.ensemble { "ensemble" } else { "chart" };
    let folder = signals.claim(
        || output_folder(args.out.as_deref(), Existing::Keep, &format!("{}-{kind}", scene.name)),
        |folder| Some(nothing().unless_kept(chart::has_points, kept_points(folder))),
    )?;
    let processors = lennard_core::parallel::processors();
    let options = ChartOptions {
        axes: if args.ensemble { Axes::Baths } else { Axes::Settings },
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
        stop: signals.stop(),
        command: typed::again(Some(folder.path()), &[]),
    };
    let mut display = FirstStep::new(&signals, Display::of_study(args.quiet));
    let found = chart::run(&scene, &options, &mut display)?;
    drop(display);
    let done = answer(args.json, args.quiet, &found, || {
        show::print(&show::chart(&found, folder.path()), Style::Ruled);
    })?;
    if !found.finished {
        eprintln!("{}", kept_points(folder.path()));
        return Ok(STOPPED);
    }
    Ok(done)
}

fn kept_points(folder: &Path) -> String {
    let command = typed::again(Some(folder), &[]);
    format!("stopped on request; finished points are kept\n  to go on: {command}")
}

impl From<ChartError> for Failure {
    fn from(error: ChartError) -> Self {
        match error {
            ChartError::Study(error) => error.into(),
            other => Self::new("the chart", other, INPUT),
        }
    }
}
