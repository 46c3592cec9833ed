//! The readings of a sweep, and its files: record, table, page and figures.

use std::path::Path;

use lennard_scene::SceneError;

use super::{Ending, Sweep, SweepError, SweepRecord, SweptPoint, csv, page};
use crate::readings::{Blocks, READINGS, Reading, StudyPoints, chosen};
use crate::report::{Picture, Section};

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
        lennard_io::write_table_csv(&table, &csv::table(&self.record.points))?;
        for table in &self.record.found.tables {
            lennard_io::write_table_csv(&folder.join(format!("{}.csv", table.name)), table)?;
        }
        for picture in &self.figures {
            let path = folder.join(format!("{}.svg", picture.name()));
            lennard_io::write_text_atomically(&path, &picture.to_svg()?)?;
        }
        let page = page::page(&self.record, command);
        lennard_io::write_text_atomically(&report, &page.to_html()?)?;
        Ok(self.record)
    }
}
