//! `lennard compare`: finished runs beside the literature.

use lennard_studies::compare::{ComparedRun, ReadError, RunFolder};
use lennard_studies::run_page::PageError;
use serde::Serialize;

use crate::program::args::CompareArgs;
use crate::program::commands::print_json;
use crate::program::failure::{DONE, Failure, INPUT, OTHER};
use crate::program::show;

/// Prints every quantity of every run beside its reference.
pub fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    // Nothing is printed before every run was read: a table without one of them could be taken for all.
    let compared: Vec<ComparedRun> = args
        .runs
        .iter()
        .map(|folder| Ok(lennard_studies::compare::compare(&RunFolder::open(folder)?)))
        .collect::<Result<_, ReadError>>()?;
    if args.json {
        #[derive(Serialize)]
        struct Document<'a> {
            schema: &'static str,
            runs: &'a [ComparedRun],
        }
        print_json(&Document { schema: lennard_io::schema!("compare", 1), runs: &compared })?;
    } else {
        for run in &compared {
            show::compared(run, args.verbose);
        }
    }
    Ok(DONE)
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Self::new("reading a run", error, INPUT)
    }
}

impl From<PageError> for Failure {
    fn from(error: PageError) -> Self {
        Self::new("writing the report", error, OTHER)
    }
}
