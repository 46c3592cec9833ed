//! `lennard bench`: how fast the parts of a step are.

use lennard_io::{in_shell, path_in_shell};
use lennard_studies::bench::{self, BenchError, BenchOptions, Subject};

use crate::program::args::BenchArgs;
use crate::program::commands::{Inputs, UNFINISHED, output_folder, print_json, replace_if};
use crate::program::failure::{DONE, Failure, OTHER};
use crate::program::progress::Display;
use crate::program::show::{self, Style};
use crate::program::signals::{Signals, StartUp};

/// Blocks for each variant where nothing else is said.
const REPEATS: usize = 7;
const REPEATS_QUICK: usize = 3;

/// Measures, writes a folder and prints a table.
pub fn bench(args: &BenchArgs) -> Result<u8, Failure> {
    let nothing = || StartUp::of_nothing(UNFINISHED);
    let signals = Signals::listen(nothing())?;
    let subject = match &args.scene {
        Some(path) => Subject::File(path.clone()),
        None => Subject::BuiltIn { quick: args.quick },
    };
    // A scene that cannot be measured shows before a folder is made.
    bench::check(&subject, &args.set, &args.isa, &args.precision)?;
    if let (Some(file), Some(folder)) = (&args.scene, &args.out) {
        let inputs = Inputs::of_scene(file, None, &subject.load(&args.set)?);
        inputs.not_in(folder)?;
    }
    let folder = signals.claim(
        || output_folder(args.out.as_deref(), replace_if(args.force), "bench"),
        |_| Some(nothing()),
    )?;
    let repeats =
        args.repeats.map_or(if args.quick { REPEATS_QUICK } else { REPEATS }, usize::from);
    let options = BenchOptions {
        subject,
        overrides: args.set.clone(),
        isas: args.isa.clone(),
        precisions: args.precision.clone(),
        threads: args.threads.iter().map(|&t| usize::from(t)).collect(),
        repeats,
        quick: args.quick,
        command: command(args),
        machine: machine(),
    };
    let mut progress = Display::of_study(args.quiet);
    let study = bench::run(&options, &mut progress);
    drop(progress);
    let study = study?;
    bench::write(&study, folder.path())?;
    if args.json {
        print_json(&study)?;
    } else if !args.quiet {
        show::print(&show::bench(&study, folder.path()), Style::Ruled);
    }
    Ok(DONE)
}

/// The command as it can be typed again.
fn command(args: &BenchArgs) -> String {
    let mut words = vec!["lennard bench".to_owned()];
    words.extend(args.scene.iter().map(|scene| path_in_shell(scene)));
    let settings = args.set.iter().map(|(key, value)| format!("{key}={value}"));
    words.extend(settings.map(|setting| format!("--set {}", in_shell(&setting))));
    let lists = [("--isa", args.isa.join(",")), ("--precision", args.precision.join(","))];
    words.extend(
        lists
            .into_iter()
            .filter(|(_, list)| !list.is_empty())
            .map(|(name, list)| format!("{name} {}", in_shell(&list))),
    );
    if !args.threads.is_empty() {
        let threads: Vec<String> = args.threads.iter().map(u16::to_string).collect();
        words.push(format!("--threads {}", threads.join(",")));
    }
    words.extend(args.repeats.map(|n| format!("--repeats {n}")));
    words.extend(args.quick.then(|| "--quick".to_owned()));
    words.join(" ")
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
