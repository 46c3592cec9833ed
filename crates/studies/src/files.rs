//! The files that a study leaves behind.

use std::path::Path;

use lennard_io::{write_json_atomically, write_table_csv, write_text_atomically};
use lennard_observables::Table;
use lennard_scene::Scene;
use serde::Serialize;

use crate::StudyError;
use crate::report::{Page, Picture, ReportError};

/// What a study with claims is asked for, and how it is named.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct StudyOptions {
    /// Shorter runs on coarser grids, for tests.
    pub quick: bool,
    /// The command that is printed below figures and tables.
    pub command: String,
    /// Names and values for the footer of the page (machine, date), which the study itself does not look up.
    pub provenance: Vec<(String, String)>,
}

/// A study that has run: all that it has measured, as JSON, as tables and as a page.
pub trait Study: Serialize + Sized {
    /// Name of the file with all that it has measured.
    const JSON: &'static str = "study.json";

    /// The tables with every digit.
    fn tables(&self) -> Vec<Table>;

    /// The page, whose brief sections a terminal shows too.
    ///
    /// # Errors
    /// [`StudyError::Report`] where the text of the page names what the study does not have.
    fn page(&self) -> Result<Page, StudyError>;

    /// Writes tables as CSV, the pictures of the page (in `figures/`), the study as JSON, and the page as `report.html`.
    ///
    /// # Errors
    /// [`StudyError`] where a figure cannot be drawn or a file cannot be written.
    fn write(&self, dir: &Path) -> Result<(), StudyError> {
        write_all(dir, &self.tables(), (Self::JSON, self), &self.page()?)
    }
}

/// Writes tables as CSV, the pictures of the page (in `figures/`), the study as the JSON file that is named, and
/// the page as `report.html`.
pub(crate) fn write_all(
    dir: &Path,
    tables: &[Table],
    (json, study): (&str, &impl Serialize),
    page: &Page,
) -> Result<(), StudyError> {
    // What cannot be drawn is told before anything is written.
    let drawn = |picture: &Picture| Ok((format!("{}.svg", picture.name()), picture.to_svg()?));
    let pictures = page.pictures().map(drawn).collect::<Result<Vec<_>, ReportError>>()?;
    let html = page.to_html()?;
    let figure_dir = dir.join("figures");
    std::fs::create_dir_all(&figure_dir)
        .map_err(|source| StudyError::Folder { path: figure_dir.display().to_string(), source })?;
    for table in tables {
        write_table_csv(&dir.join(format!("{}.csv", table.name)), table)?;
    }
    for (name, svg) in &pictures {
        write_text_atomically(&figure_dir.join(name), svg)?;
    }
    write_json_atomically(&dir.join(json), &study)?;
    write_text_atomically(&dir.join("report.html"), &html)?;
    Ok(())
}

/// Name of the file with the scene that a folder belongs to, every default written out.
pub(crate) const SCENE_FILE: &str = "scene.toml";

/// Whether the folder belongs to this very scene; `None` where it says nothing of a scene.
pub(crate) fn same_scene(folder: &Path, scene: &Scene) -> Option<bool> {
    let file = folder.join(SCENE_FILE);
    file.exists().then(|| Scene::load(&file, &[]).is_ok_and(|there| there == *scene))
}
