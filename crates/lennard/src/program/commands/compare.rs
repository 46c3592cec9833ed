//! `lennard compare`: finished runs beside the literature, and beside each other.

use lennard_io::Existing;
use lennard_studies::Study;
use lennard_studies::compare::{ReadError, RunFolder, beside, meanings, own_literature};
use lennard_studies::run_page::PageError;

use crate::program::args::CompareArgs;
use crate::program::commands::{answer, output_folder};
use crate::program::failure::{Failure, INPUT, OTHER};
use crate::program::show::{self, Style};

/// Prints every quantity of a run beside its reference. Several runs stand beside each other, on a page too.
pub fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    // Nothing is printed before every run was read: a table without one of them could be taken for all.
    let runs: Vec<Vec<RunFolder>> =
        args.runs.iter().map(|run| RunFolder::open_each(run)).collect::<Result<_, ReadError>>()?;
    let runs = runs.concat();
    let own = match &args.reference {
        Some(path) => own_literature::read(path, &runs)
            .map_err(|e| Failure::new("reading the literature of your own", e, INPUT))?,
        None => Vec::new(),
    };
    let found = beside(&runs, own);
    let by_itself = runs.len() > 1 && !args.json && !args.no_report;
    let folder = match args.out.is_some() || by_itself {
        true => Some(output_folder(args.out.as_deref(), Existing::Refuse, "compare")?),
        false => None,
    };
    if let Some(folder) = &folder {
        found.write(folder.path())?;
    }
    let style = if args.verbose { Style::Ruled } else { Style::Open };
    answer(args.json, false, &found, || {
        if let [run] = found.runs.as_slice() {
            let shown = run.rows.iter().filter(|row| row.primary || args.verbose);
            show::print(&show::compared(run, args.verbose).texts(meanings(shown)), style);
        }
        found.sections(args.verbose).iter().for_each(|some| show::print(some, Style::Open));
        if let Some(folder) = &folder {
            println!("page: {}", folder.path().join("report.html").display());
        }
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
