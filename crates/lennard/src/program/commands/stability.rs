//! `lennard study stability` and `lennard study mechanics`: few bodies and a fluid, theory and measurement in one picture.

use std::path::Path;

use lennard_studies::claims::ClaimsStudy;
use lennard_studies::{
    FluidStudy, Progress, Study, StudyError, StudyOptions, mechanics, stability,
};

use crate::program::args::StudyArgs;
use crate::program::commands::{Inputs, answer, on_threads, study_folder};
use crate::program::failure::{Failure, INPUT, OTHER};
use crate::program::progress::Display;
use crate::program::show;
use crate::program::typed;

/// Runs the study of integrators, writes its folder and prints its verdicts.
pub fn stability(args: &StudyArgs) -> Result<u8, Failure> {
    study(args, "stability", stability::run)
}

/// Runs the study of constraints and collisions, writes its folder and prints its verdicts.
pub fn mechanics(args: &StudyArgs) -> Result<u8, Failure> {
    study(args, "mechanics", mechanics::run)
}

/// A study of the library.
type Run = fn(&FluidStudy, &StudyOptions, &mut dyn Progress) -> Result<ClaimsStudy, StudyError>;

fn study(args: &StudyArgs, name: &str, run: Run) -> Result<u8, Failure> {
    let fluid = FluidStudy::read(name, args.study.as_deref(), args.quick)?;
    if let (Some(file), Some(folder)) = (&args.study, &args.out) {
        let base = &fluid.base;
        Inputs::of_scene(Path::new(base.source.file()), None, base).with(file).not_in(folder)?;
    }
    let folder = study_folder(args.out.as_deref(), args.force, name)?;
    let threads = args.threads.map_or_else(lennard_core::parallel::processors, usize::from);
    let options = StudyOptions {
        quick: args.quick,
        command: typed::again(None, &[]),
        provenance: vec![
            ("version".into(), env!("CARGO_PKG_VERSION").into()),
            ("processor".into(), lennard_io::cpu_name()),
            ("threads".into(), threads.to_string()),
        ],
    };
    let mut progress = Display::of_study(args.quiet);
    let (study, page) = on_threads(threads, || {
        let study = run(&fluid, &options, &mut progress)?;
        study.write(folder.path())?;
        let page = study.page()?;
        Ok((study, page))
    })?;
    drop(progress);
    answer(args.json, args.quiet, &study, || show::page(&page, folder.path()))
}

impl Failure {
    /// A study, or a chart, that failed while it did this.
    pub fn of_study(doing: &str, error: StudyError) -> Self {
        match error {
            StudyError::Engine(error) => error.into(),
            StudyError::Write(error) => error.into(),
            StudyError::Scene(_) | StudyError::Folder { .. } | StudyError::Settings { .. } => {
                Self::new(doing, error, INPUT)
            }
            other => Self::new(doing, other, OTHER),
        }
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Scene(error) => error.into(),
            other => Self::of_study("the study", other),
        }
    }
}
