//! `lennard study bench`: how fast the parts of a step are.

use lennard_studies::Study;
use lennard_studies::bench::{self, BenchError, BenchOptions};

use crate::program::args::BenchArgs;
use crate::program::commands::{Inputs, answer, study_folder};
use crate::program::failure::{Failure, OTHER};
use crate::program::progress::Display;
use crate::program::show::{self, Style};
use crate::program::typed;

/// Blocks for each variant where nothing else is said.
const REPEATS: usize = 7;
const REPEATS_QUICK: usize = 3;

/// Measures, writes a folder and prints a table.
pub fn bench(args: &BenchArgs) -> Result<u8, Failure> {
    let scene = args.scene.clone().unwrap_or_else(|| bench::usual_scene(args.quick));
    // A scene that cannot be measured shows before a folder is made.
    bench::check(&scene, &args.set, &args.isa, &args.precision)?;
    if let (Some(file), Some(folder)) = (&args.scene, &args.out) {
        let inputs = Inputs::of_scene(file, None, &bench::load(file, &args.set)?);
        inputs.not_in(folder)?;
    }
    let folder = study_folder(args.out.as_deref(), args.force, "bench")?;
    let repeats =
        args.repeats.map_or(if args.quick { REPEATS_QUICK } else { REPEATS }, usize::from);
    let options = BenchOptions {
        scene,
        overrides: args.set.clone(),
        isas: args.isa.clone(),
        precisions: args.precision.clone(),
        threads: args.threads.iter().map(|&t| usize::from(t)).collect(),
        repeats,
        quick: args.quick,
        command: typed::again(None, &[]),
        machine: machine(),
    };
    let mut progress = Display::of_study(args.quiet);
    let study = bench::run(&options, &mut progress);
    drop(progress);
    let study = study?;
    study.write(folder.path())?;
    answer(args.json, args.quiet, &study, || {
        show::print(&show::bench(&study, folder.path()), Style::Ruled);
    })
}

/// What the figures belong to.
fn machine() -> Vec<(String, String)> {
    let mut machine = vec![
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("processor".into(), lennard_io::cpu_name()),
        ("threads".into(), lennard_core::parallel::processors().to_string()),
        ("instruction sets".into(), lennard_forcefield::available_isas().join(", ")),
    ];
    // Who else was at work: the first question about a figure that cannot be had again.
    if let Ok(load) = std::fs::read_to_string("/proc/loadavg")
        && let Some(load) = load.split_whitespace().next()
    {
        machine
            .push(("processes at work when it began (load of a minute)".into(), load.to_owned()));
    }
    machine
}

impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Scene(e) => e.into(),
            BenchError::Engine(e) => e.into(),
            other => Self::new("the benchmark", other, OTHER),
        }
    }
}
