//! The readings of a sweep, and its files: record, table for programs, page and figures.

use std::path::Path;

use lennard_observables::{Cell, Remark, Table};
use lennard_scene::SceneError;
use lennard_scene::study::SHORT_KEYS;

use super::{Ending, SettingValue, Sweep, SweepError, SweepRecord, SweptPoint};
use crate::compare::{ComparedRun, Row};
use crate::lists::{grouped, unique};
use crate::readings::{Blocks, OPEN, READINGS, Reading, SHARED_SECTIONS, chosen};
use crate::report::{Block, Page, Picture, Section};
use crate::sweep::StudyPoints;

/// Name and version of the schema of [`SweepRecord`].
const SWEEP_SCHEMA: &str = lennard_io::schema!("sweep", 1);
/// Record, table and page.
const FILES: [&str; 3] = ["sweep.json", "table.csv", "report.html"];

/// The files that a sweep may write in its folder.
pub fn files() -> impl Iterator<Item = &'static str> {
    FILES.into_iter().chain(READINGS.iter().flat_map(|reading| reading.files).copied())
}

/// A sweep that has been read.
pub(super) struct ReadSweep {
    /// The record.
    pub record: SweepRecord,
    /// Figures that are files.
    figures: Vec<Picture>,
}

/// Reads the points of a sweep.
///
/// # Errors
/// [`SweepError::File`] where the study names a reading that its points have nothing for, though all have ended.
pub(super) fn read(
    sweep: &Sweep,
    points: Vec<SweptPoint>,
    ending: Ending,
    threads: usize,
) -> Result<ReadSweep, SweepError> {
    let mut found = Blocks::default();
    let mut figures: Vec<Picture> = Vec::new();
    let has_ended = matches!(ending, Ending::Finished | Ending::Failed);
    for reading in chosen(&sweep.readings) {
        let drawn: Vec<&str> = figures.iter().map(Picture::name).collect();
        let blocks = (reading.read)(&StudyPoints { sweep, swept: &points, drawn: &drawn });
        let is_empty = blocks.sections.is_empty() && blocks.tables.is_empty();
        if is_empty && has_ended && !sweep.readings.is_empty() {
            return Err(nothing_to_read(sweep, &points, reading).into());
        }
        let is_file = |p: &&Picture| reading.files.contains(&&*format!("{}.svg", p.name()));
        let pictures = blocks.sections.iter().flat_map(Section::pictures);
        figures.extend(pictures.filter(is_file).cloned());
        found.take(blocks);
    }
    let proves_nothing = found.failure.is_some() && ending == Ending::Finished;
    let record = SweepRecord {
        schema: SWEEP_SCHEMA,
        name: sweep.name.to_string(),
        ending: if proves_nothing { Ending::Failed } else { ending },
        version: env!("CARGO_PKG_VERSION"),
        cpu: lennard_io::cpu_name(),
        threads,
        points,
        left_out: sweep.left_out.clone(),
        found,
    };
    Ok(ReadSweep { record, figures })
}

/// That a reading has found nothing among points that have ended.
fn nothing_to_read(sweep: &Sweep, points: &[SweptPoint], reading: &Reading) -> SceneError {
    let failed: Vec<&SweptPoint> = points.iter().filter(|p| p.failure.is_some()).collect();
    let first = failed.first().and_then(|p| Some((&p.name, p.failure.as_ref()?)));
    let why = first.map_or(String::new(), |(name, failed)| {
        let reason = failed.reason.lines().next().unwrap_or_default();
        format!(", the first is {name}: {reason}")
    });
    sweep
        .source
        .refuse("reading", format!("has nothing to read: `{}`", reading.name))
        .found(format!("{} of {} points failed{why}", failed.len(), points.len()))
        .allowed(format!("{}: {}", reading.name, reading.about))
}

impl ReadSweep {
    /// Writes record, tables, figures and page.
    pub(super) fn write(self, folder: &Path, command: &str) -> Result<SweepRecord, SweepError> {
        let [json, table, report] = FILES.map(|name| folder.join(name));
        lennard_io::write_json_atomically(&json, &self.record)?;
        lennard_io::write_table_csv(&table, &table_for_programs(&self.record.points))?;
        for table in &self.record.found.tables {
            lennard_io::write_table_csv(&folder.join(format!("{}.csv", table.name)), table)?;
        }
        for picture in &self.figures {
            let path = folder.join(format!("{}.svg", picture.name()));
            lennard_io::write_text_atomically(&path, &picture.to_svg()?)?;
        }
        let page = page(&self.record, command);
        lennard_io::write_text_atomically(&report, &page.to_html()?)?;
        Ok(self.record)
    }
}

/// Every point with all that it has measured, beside its references.
fn table_for_programs(points: &[SweptPoint]) -> Table {
    let compared =
        |p: &SweptPoint, number: fn(&ComparedRun) -> u64| p.compared.as_ref().map_or(0, number);
    let mean = |p: &SweptPoint, quantity: &str| p.row(quantity).map(|r| r.measured);
    let mut table = Table::rows_of("table", points)
        .column("name", |p| &p.name)
        .column("density", |p| p.state().density)
        .column("temperature", |p| p.state().temperature)
        .column("temperature_whole_steps", |p| mean(p, "temperature"))
        .column("temperature_half_steps", |p| mean(p, "temperature_half_steps"))
        .column("phase", |p| p.state().phase.map_or("unknown", |p| p.describe()))
        .column("steps", |p| compared(p, |c| c.measured_steps))
        .column("atoms", |p| compared(p, |c| c.atoms));
    for key in keys(points) {
        let setting = |p: &SweptPoint| p.settings.iter().find(|s| s.key == key).cloned();
        // The first column has the names of the points.
        let heading = if key == "name" { "row" } else { &key };
        table = table.column(heading, |p| {
            setting(p).map(|setting| match setting.value {
                SettingValue::Number(number) => Cell::from(number),
                SettingValue::Words(words) => Cell::words(words),
            })
        });
    }
    for name in measured(points) {
        table = table.measured(&name, |p| p.row(&name).map(Row::mean));
        if points.iter().filter_map(|p| p.row(&name)).any(|r| r.reference.is_some()) {
            table = table
                .column(&format!("{name}_reference"), |p| p.row(&name)?.reference)
                .measured(&format!("{name}_difference"), |p| p.row(&name)?.off())
                .column(&format!("{name}_verdict"), |p| p.row(&name).map(|r| r.verdict.words()));
        }
    }
    table.table()
}

/// The keys that a study of its own changes: with a key that has no short name, every key is a column.
fn keys(points: &[SweptPoint]) -> Vec<String> {
    let mut keys = unique(points.iter().flat_map(|p| &p.settings).map(|s| s.key.clone()));
    let is_short = |key: &String| SHORT_KEYS.iter().any(|short| short.name == key);
    if keys.iter().all(is_short) {
        return Vec::new();
    }
    keys.retain(|key| !["density", "temperature"].contains(&key.as_str()));
    keys
}

/// Every quantity that any point has measured, besides its density and temperatures.
fn measured(points: &[SweptPoint]) -> Vec<String> {
    let rows = points.iter().filter_map(|p| p.compared.as_ref()).flat_map(|c| &c.rows);
    let names = rows.map(|row| row.quantity.clone());
    unique(names.filter(|name| name != "density" && !name.starts_with("temperature")))
}

/// The page of a sweep.
fn page(record: &SweepRecord, command: &str) -> Page {
    let finished = record.points.iter().filter(|p| p.compared.is_some()).count();
    let mut sections = together(&record.found.sections);
    let left_out = record.left_out.iter().map(|l| format!("{}: {}", l.what, l.why));
    sections.push(Section::new("Remarks").list(remarks(&record.points)).folded());
    sections.push(Section::new("Left out").list(left_out.collect()).folded());
    sections.retain(|section| !section.blocks.is_empty());
    // A study without a picture of its own shows its properties.
    let has_picture = |section: &Section| !section.folded && section.pictures().next().is_some();
    if !sections.iter().any(has_picture)
        && let Some(at) = sections.iter().position(|s| s.pictures().next().is_some())
    {
        let first = Section { folded: false, ..sections.remove(at) };
        sections.insert(0, first);
    }
    Page {
        title: format!("Sweep {}", record.name),
        lead: format!(
            "{finished} of {} points are finished. {}",
            record.points.len(),
            record.found.lead
        ),
        command: None,
        sections,
        provenance: vec![
            ("command".into(), format!("`{command}`")),
            ("version".into(), record.version.into()),
            ("processor".into(), record.cpu.clone()),
            ("threads for all points together".into(), record.threads.to_string()),
        ],
    }
}

/// The blocks of sections with one title in one section, those that readings share first. Figures stand side by side.
fn together(sections: &[Section]) -> Vec<Section> {
    let mut all: Vec<Section> = SHARED_SECTIONS.map(Section::new).into();
    all.iter_mut().skip(OPEN).for_each(|section| section.folded = true);
    for section in sections {
        let at = all.iter().position(|s| s.title == section.title).unwrap_or_else(|| {
            all.push(Section::new(section.title.clone()));
            all.len() - 1
        });
        for block in &section.blocks {
            match (all[at].blocks.last_mut(), block) {
                (Some(Block::Figures(side_by_side)), Block::Figures(more)) => {
                    side_by_side.extend(more.iter().cloned());
                }
                (_, block) => all[at].blocks.push(block.clone()),
            }
        }
    }
    all
}

/// Remarks of all points, each once, with how many points they belong to.
fn remarks(points: &[SweptPoint]) -> Vec<String> {
    let compared = points.iter().filter_map(|p| p.compared.as_ref());
    let counted = grouped(compared.flat_map(|c| &c.remarks).map(|remark| (remark, ())));
    let in_words = |(remark, found): (&Remark, Vec<()>)| match found.len() {
        1 => remark.to_string(),
        n => format!("{remark} ({n} points)"),
    };
    let failed =
        points.iter().filter_map(|p| Some(format!("{}: {}", p.name, p.failure.as_ref()?.reason)));
    counted.into_iter().map(in_words).chain(failed).collect()
}
