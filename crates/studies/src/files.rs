//! The files that a study leaves behind.

use std::path::Path;

use crate::report::Page;
use lennard_core::Table;
use lennard_io::{write_json_atomically, write_table_csv, write_text_atomically};
use serde::Serialize;

use crate::StudyError;

/// Writes tables as CSV, the pictures of the page (in `figures/`), the study as the JSON file that is named, and
/// the page as `report.html`.
pub(crate) fn write_all(
    dir: &Path,
    tables: &[Table],
    (json, study): (&str, &impl Serialize),
    page: &Page,
) -> Result<(), StudyError> {
    let figure_dir = dir.join("figures");
    std::fs::create_dir_all(&figure_dir)
        .map_err(|source| StudyError::Folder { path: figure_dir.display().to_string(), source })?;
    for table in tables {
        write_table_csv(&dir.join(format!("{}.csv", table.name)), table)?;
    }
    for picture in page.pictures() {
        let path = figure_dir.join(format!("{}.svg", picture.name()));
        write_text_atomically(&path, &picture.to_svg()?)?;
    }
    write_json_atomically(&dir.join(json), study)?;
    write_text_atomically(&dir.join("report.html"), &page.to_html()?)?;
    Ok(())
}
