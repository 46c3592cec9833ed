//! `lennard stability` and `lennard mechanics`: studies of few bodies, theory and measurement in one picture.

use std::path::Path;

use lennard_studies::claims::Claim;
use lennard_studies::stability::{self, StabilityOptions};
use lennard_studies::{Progress, StudyError, mechanics};
use serde::Serialize;

use crate::program::args::StabilityArgs;
use crate::program::commands::{UNFINISHED, on_threads, output_folder, print_json, replace_if};
use crate::program::failure::{DONE, Failure, INPUT, OTHER};
use crate::program::progress::Display;
use crate::program::show;
use crate::program::signals::{Signals, StartUp};

/// A study: how it is run, how it is written, and what it claims.
struct Kind<S> {
    name: &'static str,
    run: fn(&StabilityOptions, &mut dyn Progress) -> Result<S, StudyError>,
    write: fn(&S, &Path) -> Result<(), StudyError>,
    claims: fn(&S) -> &[Claim],
}

/// Runs the study of integrators, writes its folder and prints its verdicts.
pub fn stability(args: &StabilityArgs) -> Result<u8, Failure> {
    study(
        args,
        &Kind {
            name: "stability",
            run: stability::run,
            write: stability::write,
            claims: |study| &study.claims,
        },
    )
}

/// Runs the study of constraints and collisions, writes its folder and prints its verdicts.
pub fn mechanics(args: &StabilityArgs) -> Result<u8, Failure> {
    study(
        args,
        &Kind {
            name: "mechanics",
            run: mechanics::run,
            write: mechanics::write,
            claims: |study| &study.claims,
        },
    )
}

fn study<S: Serialize + Send>(args: &StabilityArgs, kind: &Kind<S>) -> Result<u8, Failure> {
    let nothing = || StartUp::of_nothing(UNFINISHED);
    let signals = Signals::listen(nothing())?;
    let folder = signals.claim(
        || output_folder(args.out.as_deref(), replace_if(args.force), kind.name),
        |_| Some(nothing()),
    )?;
    let quick = if args.quick { " --quick" } else { "" };
    let threads = args.threads.map_or_else(lennard_core::parallel::processors, usize::from);
    let options = StabilityOptions {
        quick: args.quick,
        command: format!("lennard {}{quick}", kind.name),
        provenance: vec![
            ("version".into(), env!("CARGO_PKG_VERSION").into()),
            ("processor".into(), lennard_io::cpu_name()),
            ("threads".into(), threads.to_string()),
        ],
    };
    let mut progress = Display::of_study(args.quiet);
    let found = on_threads(threads, || {
        let study = (kind.run)(&options, &mut progress)?;
        (kind.write)(&study, folder.path())?;
        Ok(study)
    })?;
    drop(progress);
    if args.json {
        print_json(&found)?;
    } else if !args.quiet {
        show::verdicts((kind.claims)(&found), folder.path());
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
