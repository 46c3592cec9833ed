//! `lennard stability`: where each integrator fails, theory and measurement in one picture.

use lennard_studies::StudyError;
use lennard_studies::stability::{self, StabilityOptions};

use crate::args::StabilityArgs;
use crate::commands::{UNFINISHED, on_threads, output_folder, print_json, replace_if};
use crate::failure::{DONE, Failure, INPUT, OTHER};
use crate::progress::Display;
use crate::show;
use crate::signals::{Signals, StartUp};

/// Runs the study, writes its folder and prints its verdicts.
pub fn stability(args: &StabilityArgs) -> Result<u8, Failure> {
    let nothing = || StartUp::of_nothing(UNFINISHED);
    let signals = Signals::listen(nothing())?;
    let folder = signals.claim(
        || output_folder(args.out.as_deref(), replace_if(args.force), "stability"),
        |_| Some(nothing()),
    )?;
    let command = if args.quick {
        "lennard stability --quick"
    } else {
        "lennard stability"
    };
    let threads = args
        .threads
        .map_or_else(lennard_core::parallel::processors, usize::from);
    let options = StabilityOptions {
        quick: args.quick,
        command: command.to_owned(),
        provenance: vec![
            ("version".into(), env!("CARGO_PKG_VERSION").into()),
            ("processor".into(), lennard_io::cpu_name()),
            ("threads".into(), threads.to_string()),
        ],
    };
    let mut progress = Display::of_study(args.quiet);
    let study = on_threads(threads, || {
        let study = stability::run(&options, &mut progress)?;
        stability::write(&study, folder.path())?;
        Ok(study)
    })?;
    drop(progress);
    if args.json {
        print_json(&study)?;
    } else if !args.quiet {
        show::stability(&study, folder.path());
    }
    Ok(DONE)
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Engine(error) => error.into(),
            StudyError::Write(error) => error.into(),
            StudyError::Folder { .. } | StudyError::Settings { .. } => {
                Self::new("the study", error, INPUT)
            }
            other => Self::new("the study", other, OTHER),
        }
    }
}
