//! The page of a run: made from its folder alone, so that it can be made again at any time.

mod figures;
mod particles;
mod phase_diagram;
mod results;
mod tables;

pub use results::quantities;

use std::path::Path;

use lennard_core::PeriodicBox;

use crate::compare::{ReadError, RunFolder, compare};
use crate::report::{Block, Page, ReportError, Section};

use self::figures::Figures;

/// Why a page cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The folder cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A figure cannot be drawn.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The page cannot be written.
    #[error(transparent)]
    Write(#[from] lennard_io::WriteError),
}

/// Makes `report.html` of a finished run from its folder, and `particles.svg`, which the page shows too.
///
/// # Errors
/// [`PageError`] where the run did not finish, or a file cannot be read or written.
pub fn write(folder: &Path) -> Result<(), PageError> {
    let page = page(&RunFolder::open(folder)?)?;
    let html = page.to_html()?;
    for picture in page.pictures().filter(|picture| picture.name() == particles::NAME) {
        lennard_io::write_text_atomically(&folder.join("particles.svg"), &picture.to_svg()?)?;
    }
    lennard_io::write_text_atomically(&folder.join("report.html"), &html)?;
    Ok(())
}

/// Makes `report.html` of a run that is under way, or that was stopped, from its rows so far. No mean stands on it: none is a result
/// before the end. `cell` is a box of the run, since its last one is in no file yet.
///
/// # Errors
/// [`PageError`] where a file cannot be read or written.
pub fn write_under_way(folder: &Path, cell: PeriodicBox) -> Result<(), PageError> {
    let run = RunFolder::under_way(folder, cell)?;
    let steps = run.table("thermo").and_then(|rows| rows.numbers("step")?.last().copied());
    let lead = format!(
        "This run has not finished: its rows reach step {} of {}. Means, their errors and all other figures come with its end.",
        steps.unwrap_or(0.0),
        run.scene.total_steps()
    );
    let figures = Figures::of(&run, false)?;
    let sections = vec![
        Section::new("So far").figures(figures.named(&figures::TIME_SERIES)),
        Section::new("What is run").table(tables::stages(&run)),
    ];
    let mut page = with_sections(&run, lead, sections);
    page.title += ", unfinished";
    lennard_io::write_text_atomically(&folder.join("report.html"), &page.to_html()?)?;
    Ok(())
}

/// The page of a run: what was found, then the pictures that show it, then all else by subject, folded. What the run has not got
/// has no place and no word on it.
fn page(run: &RunFolder) -> Result<Page, ReportError> {
    let compared = compare(run);
    let is_fluid = !compared.is_of_few_bodies();
    let has_means = is_fluid && !compared.rows.is_empty();
    let (record, fluid) = (&run.record, has_means.then_some(&compared));
    let mut diagrams = phase_diagram::phase_diagram(run, &compared).into_iter();
    let figures = Figures::of(run, is_fluid)?;
    let mut state = figures.named(&["interface_profile", "rdf"]);
    state.extend(particles::picture(run).into_iter().chain(diagrams.next()));
    let open = [
        results::beside_the_table(fluid),
        Section::new("Time series").figures(figures.named(&figures::TIME_SERIES)),
        Section::new("Structure and state").figures(state),
    ];
    let folded = [
        Section::new("Every quantity beside the literature")
            .with_all(fluid.map(tables::comparison))
            .list(fluid.map(tables::notes).unwrap_or_default()),
        Section::new("Every equation beside the run").with_all(fluid.map(tables::state_card)),
        Section::new("Averages and error bars")
            .with_all(fluid.map(|compared| vec![Block::Table(tables::averages(compared, record))]))
            .figures(if is_fluid { figures.named(&figures::BLOCKING) } else { Vec::new() }),
        Section::new("More against time").figures(figures.named(&figures::MORE_IN_TIME)),
        Section::new("Motion and transport").figures(figures.named(&figures::MOTION)),
        Section::new("Static structure factor").figures(figures.named(&["structure_factor"])),
        Section::new("Phase diagram in pressure").figures(diagrams.collect()),
        Section::new("What was run, and where the time went")
            .table(tables::stages(run))
            .table(tables::performance(record, is_fluid)),
        Section::new("Remarks").list(record.remarks.clone()),
    ];
    let sections = open.into_iter().chain(folded.map(Section::folded));
    let sections = sections.filter(|section| !section.blocks.is_empty()).collect();
    let mut page = with_sections(run, compared.headline.clone(), sections);
    page.provenance.insert(0, ("finished".to_owned(), finished_on(run)));
    Ok(page)
}

/// A page about a run with these sections.
fn with_sections(run: &RunFolder, lead: String, sections: Vec<Section>) -> Page {
    let record = &run.record;
    let particles = crate::report::particles(record.atoms as usize, run.molecules() as usize);
    let provenance = [
        ("scene", "`scene.toml` beside this page, every default written out".to_owned()),
        ("the same bits again", "`lennard run scene.toml`".to_owned()),
        ("seed", record.seed.to_string()),
        ("version", record.version.clone()),
        ("processor", record.host.cpu.clone()),
        ("instruction set of the pair kernel", record.host.isa.clone()),
        ("threads", record.host.threads.to_string()),
        ("numbers", "`run.json` and the CSV files beside this page".to_owned()),
    ];
    Page {
        title: format!("{}: {particles}", run.scene.name),
        lead,
        command: None,
        sections,
        provenance: provenance.map(|(name, value)| (name.to_owned(), value)).into(),
    }
}

/// The day on which the record of the run was written.
fn finished_on(run: &RunFolder) -> String {
    let record = run.folder.join("run.json");
    let written = std::fs::metadata(record).and_then(|about| about.modified());
    let time = written.map(|time| humantime::format_rfc3339_seconds(time).to_string());
    let day = time.map(|text| text.split('T').next().unwrap_or_default().to_owned());
    day.unwrap_or_else(|_| "on a day that is not known".into())
}
