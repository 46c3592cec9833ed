//! `lennard compare`: finished runs beside the literature.

use lennard_studies::compare::{ComparedRun, ReadError, RunFolder};
use lennard_studies::run_page::PageError;
use serde_json::json;

use crate::program::args::CompareArgs;
use crate::program::commands::answer;
use crate::program::failure::{Failure, INPUT, OTHER};
use crate::program::show::{self, Style};

/// Prints every quantity of every run beside its reference.
pub fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    // Nothing is printed before every run was read: a table without one of them could be taken for all.
    let compared: Vec<ComparedRun> = args
        .runs
        .iter()
        .map(|folder| Ok(lennard_studies::compare::compare(&RunFolder::open(folder)?)))
        .collect::<Result<_, ReadError>>()?;
    let style = if args.verbose { Style::Ruled } else { Style::Open };
    let schema = lennard_io::schema!("compare", 1);
    answer(args.json, false, &json!({ "schema": schema, "runs": compared }), || {
        compared.iter().for_each(|run| show::print(&show::compared(run, args.verbose), style));
    })
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
