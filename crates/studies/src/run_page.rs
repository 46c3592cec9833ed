//! The page of a run: made from its folder alone, so that it can be made again at any time.

mod figures;
mod tables;

use std::path::Path;

use lennard_report::{Block, Page, PageFigure, ReportError, Section};

use crate::compare::{ReadError, RunFolder, compare};

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

/// Makes `report.html` of a finished run from its folder.
///
/// # Errors
/// [`PageError`] where the run did not finish, or a file cannot be read or written.
pub fn write(folder: &Path) -> Result<(), PageError> {
    let page = page(&RunFolder::open(folder)?)?;
    lennard_io::write_text_atomically(&folder.join("report.html"), &page.to_html())?;
    Ok(())
}

/// The page of a finished run.
///
/// # Errors
/// [`ReportError`] where a figure cannot be drawn.
pub fn page(run: &RunFolder) -> Result<Page, ReportError> {
    let compared = compare(run);
    let record = &run.record;
    let lead = format!(
        "{} particles, {}: {} at ρ = {:.4}, {} = {:.4}. {} Reduced units throughout (ε = σ = m = k_B = 1).",
        record.atoms,
        compared.model,
        compared.state.words,
        compared.state.density,
        compared.state.temperature_words(),
        compared.state.temperature,
        compared.headline,
    );
    let mut sections = vec![
        Section::new("Beside the literature").with(Block::Table(tables::comparison(&compared))),
        Section::new("What was run, and what was left out")
            .with(Block::Table(tables::stages(run)))
            .with(Block::List(tables::left_out(run))),
        Section::new("Averages").with(Block::Table(tables::averages(&compared, record))),
    ];
    sections[0] = sections[0]
        .clone()
        .with(Block::List(tables::sources(&compared)));
    for (title, text, figures) in [
        (
            "Time series",
            figures::TIME_SERIES,
            figures::time_series(run),
        ),
        ("Error bars", figures::ERROR_BARS, figures::blocking(run)),
        ("Structure", figures::STRUCTURE, figures::structure(run)),
        (
            "Motion and transport",
            figures::MOTION,
            figures::motion(run),
        ),
    ] {
        let drawn: Vec<PageFigure> = figures
            .into_iter()
            .map(figures::Captioned::on_page)
            .collect::<Result<_, _>>()?;
        if !drawn.is_empty() {
            sections.push(Section::new(title).text(text).with(Block::Figures(drawn)));
        }
    }
    sections.push(Section::new("Performance").with(Block::Table(tables::performance(record))));
    if !record.remarks.is_empty() {
        sections.push(Section::new("Remarks").with(Block::List(record.remarks.clone())));
    }
    Ok(Page {
        title: format!("{}: {} particles", run.scene.name, record.atoms),
        lead,
        sections,
        provenance: vec![
            (
                "scene".into(),
                "`scene.toml` beside this page, every default written out".into(),
            ),
            ("seed".into(), record.seed.to_string()),
            ("version".into(), record.version.clone()),
            ("processor".into(), record.host.cpu.clone()),
            (
                "instruction set of the pair kernel".into(),
                record.host.isa.clone(),
            ),
            ("threads".into(), record.host.threads.to_string()),
            (
                "numbers".into(),
                "`run.json` and the CSV files beside this page".into(),
            ),
        ],
    })
}
