//! `lennard study bench`: how fast the parts of a step are.

use std::path::Path;

use lennard_studies::bench::{self, Bench, BenchOptions, BenchStudy, SkinStudy, kernel_table};
use lennard_studies::report::{Section, percent, significant};
use lennard_studies::{Study, StudyError};

use crate::program::args::BenchArgs;
use crate::program::commands::{Inputs, answer, study_folder};
use crate::program::failure::Failure;
use crate::program::progress::Display;
use crate::program::show::{self, Style};
use crate::program::typed;

/// Blocks for each variant where nothing else is said.
const REPEATS: usize = 7;
const REPEATS_QUICK: usize = 3;

/// Measures, writes a folder and prints a table.
pub fn bench(args: &BenchArgs) -> Result<u8, Failure> {
    let repeats =
        args.repeats.map_or(if args.quick { REPEATS_QUICK } else { REPEATS }, usize::from);
    let options = BenchOptions {
        scene: args.scene.clone().unwrap_or_else(|| bench::usual_scene(args.quick)),
        overrides: args.set.clone(),
        isas: args.isa.clone(),
        precisions: args.precision.clone(),
        threads: args.threads.iter().map(|&t| usize::from(t)).collect(),
        repeats,
        quick: args.quick,
        command: typed::again(None, &[]),
        machine: machine(),
    };
    // A scene that cannot be measured shows before a folder is made.
    let bench = Bench::new(options).map_err(failed)?;
    if let (Some(file), Some(folder)) = (&args.scene, &args.out) {
        let inputs = Inputs::of_scene(file, None, &bench.scene);
        inputs.not_in(folder)?;
    }
    let folder = study_folder(args.out.as_deref(), args.force, "bench")?;
    let mut progress = Display::of_study(args.quiet);
    let study = bench.run(&mut progress);
    drop(progress);
    let study = study.map_err(failed)?;
    study.write(folder.path())?;
    answer(args.json, args.quiet, &study, || {
        show::print(&told(&study, folder.path()), Style::Ruled);
    })
}

fn failed(error: StudyError) -> Failure {
    match error {
        StudyError::Scene(error) => error.into(),
        other => Failure::of_study("the benchmark", other),
    }
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

/// What was measured.
fn told(study: &BenchStudy, folder: &Path) -> Section {
    let limits: Vec<String> = study
        .kernels
        .iter()
        .filter(|k| k.threads == study.kernels[0].threads)
        .filter_map(|k| Some(format!("{} {} {:.0}", k.isa, k.precision, k.limit? * 1e-6)))
        .collect();
    let limits = (!limits.is_empty()).then(|| {
        format!(
            "the limit is the same arithmetic with everything in registers, measured here, million pairs/s per thread: {}",
            limits.join(", ")
        )
    });
    let skins = study.skin.iter().flat_map(skins);
    let doubts = study.doubts().into_iter().map(|doubt| format!("(?) {doubt}"));
    Section::new(&study.scene)
        .text(format!(
            "{} particles, density {:.4}, {}, {:.1} pairs per atom within the cutoff",
            study.atoms, study.density, study.model, study.pairs_per_atom
        ))
        .text(format!(
            "{} blocks of {} steps for each line, in shuffled order, all from one state at T = {:.3}",
            study.repeats, study.steps, study.temperature
        ))
        .texts(study.machine.iter().map(|(name, value)| format!("{name}: {value}")))
        .table(kernel_table(study, false))
        .text(
            "ns per atom: medians of whole steps, in brackets the range; best times of forces alone (the list given) and of one build, \
             which is paid once in many steps; processor time is for a step on one thread, and steadier than the clock where others are at work",
        )
        .texts(limits.into_iter().chain(skins).chain(doubts))
        .text(format!("page: {}", folder.join("report.html").display()))
}

fn skins(skin: &SkinStudy) -> [String; 2] {
    let scan: Vec<String> = skin
        .points
        .iter()
        .map(|p| format!("{:.3} σ {}", p.skin, significant(p.step_ns.median, 3)))
        .collect();
    [
        format!(
            "skin {:.3} σ, {} above the cheapest of the scan, {:.3} σ ({})",
            skin.chosen,
            percent(skin.excess),
            skin.cheapest,
            skin.with
        ),
        format!("ns per atom-step by skin: {}", scan.join(", ")),
    ]
}
