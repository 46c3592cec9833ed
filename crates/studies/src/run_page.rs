//! The page of a run: made from its folder alone, so that it can be made again at any time.

mod figures;
mod particles;
mod phase_diagram;
mod tables;

use std::path::Path;

use lennard_core::PeriodicBox;

use crate::report::{Page, ParticleFigure, Picture, ReportError, Section};

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

/// Makes `report.html` of a finished run from its folder, and `particles.svg`, which the page shows too.
///
/// # Errors
/// [`PageError`] where the run did not finish, or a file cannot be read or written.
pub fn write(folder: &Path) -> Result<(), PageError> {
    let run = RunFolder::open(folder)?;
    let particles = particles::particles(&run);
    let html = page_with(&run, particles.as_ref()).to_html()?;
    if let Some(figure) = particles {
        lennard_io::write_text_atomically(&folder.join("particles.svg"), &figure.to_svg()?)?;
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
    let mut run = RunFolder::under_way(folder, cell)?;
    run.record.averages.clear();
    let steps = run.table("thermo").and_then(|rows| rows.numbers("step")?.last().copied());
    let total = run.scene.total_steps();
    let mut page = page(&run);
    page.title += ", unfinished";
    page.lead = format!(
        "This run has not finished: its rows reach step {} of {total}. Means, their errors and all other figures come with its end.",
        steps.unwrap_or(0.0)
    );
    lennard_io::write_text_atomically(&folder.join("report.html"), &page.to_html()?)?;
    Ok(())
}

/// The page of a finished run.
#[must_use]
pub fn page(run: &RunFolder) -> Page {
    page_with(run, particles::particles(run).as_ref())
}

fn page_with(run: &RunFolder, last: Option<&ParticleFigure>) -> Page {
    let compared = compare(run);
    let record = &run.record;
    let particles = crate::report::particles(compared.atoms as usize, compared.molecules as usize);
    let is_fluid = !compared.is_of_few_bodies();
    let state = match is_fluid {
        true => format!(": {} at {}", compared.state.words, compared.state.in_numbers()),
        false => String::new(),
    };
    let lead = format!(
        "{particles}, {}{state}. {} Reduced units throughout (ε = σ = m = k_B = 1).",
        compared.model, compared.headline,
    );
    let drawn = |(title, text, figures): (&str, &str, Vec<Picture>)| {
        let section = Section::new(title).text(text);
        (!figures.is_empty()).then(|| section.figures(figures))
    };
    let at_a_glance = [
        ("Particles", particles::PARTICLES, particles::pictures(last)),
        (
            "Phase diagram",
            phase_diagram::PHASE_DIAGRAM,
            phase_diagram::phase_diagram(run, &compared),
        ),
    ];
    let figures = [
        ("All stages", figures::ALL_STAGES, figures::all_stages(run)),
        (
            "Time series",
            match is_fluid {
                true => figures::TIME_SERIES,
                false => figures::MOTION_OF_BODIES,
            },
            figures::time_series(run, is_fluid),
        ),
        (
            "Error bars",
            figures::ERROR_BARS,
            if is_fluid { figures::blocking(run) } else { Vec::new() },
        ),
        ("Interface", figures::INTERFACE, figures::interface(run)),
        ("Structure", figures::STRUCTURE, figures::structure(run)),
        ("Motion and transport", figures::MOTION, figures::motion(run)),
    ];
    let mut sections: Vec<Section> = at_a_glance.into_iter().filter_map(drawn).collect();
    // Means over few bodies are no properties of a fluid, and nothing is said of their errors.
    if is_fluid {
        sections.push(
            Section::new("Beside the literature")
                .table(tables::comparison(&compared))
                .list(tables::notes(&compared)),
        );
        sections.push(tables::state_card(&compared));
    }
    sections.extend(figures.into_iter().filter_map(drawn));
    sections.push(
        Section::new("What was run, and what was left out")
            .table(tables::stages(run))
            .list(tables::left_out(run)),
    );
    if is_fluid {
        sections.push(Section::new("Averages").table(tables::averages(&compared, record)));
    }
    sections.push(Section::new("Performance").table(tables::performance(record, is_fluid)));
    if !record.remarks.is_empty() {
        sections.push(Section::new("Remarks").list(record.remarks.clone()));
    }
    Page {
        title: format!("{}: {particles}", run.scene.name),
        lead,
        command: None,
        sections,
        provenance: vec![
            ("finished".into(), finished_on(run)),
            ("scene".into(), "`scene.toml` beside this page, every default written out".into()),
            ("the same bits again".into(), "`lennard run scene.toml`".into()),
            ("seed".into(), record.seed.to_string()),
            ("version".into(), record.version.clone()),
            ("processor".into(), record.host.cpu.clone()),
            ("instruction set of the pair kernel".into(), record.host.isa.clone()),
            ("threads".into(), record.host.threads.to_string()),
            ("numbers".into(), "`run.json` and the CSV files beside this page".into()),
        ],
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
