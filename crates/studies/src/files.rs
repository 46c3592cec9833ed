//! What a study leaves behind: figures with captions, tables with words and numbers, and their writing.

use std::path::Path;

use lennard_io::{write_json_atomically, write_text_atomically};
use lennard_report::{BarFigure, Figure, PageFigure, ReportError};
use serde::Serialize;

use crate::StudyError;

/// A table of words and numbers, one CSV file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct TextTable {
    /// File stem.
    pub(crate) name: &'static str,
    /// Headings, with units in brackets.
    pub(crate) header: Vec<String>,
    /// Rows as long as the header.
    pub(crate) rows: Vec<Vec<String>>,
}

impl TextTable {
    pub(crate) fn new(name: &'static str, header: &[&str]) -> Self {
        Self {
            name,
            header: header.iter().map(|h| (*h).to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    pub(crate) fn push(&mut self, row: impl IntoIterator<Item = String>) {
        self.rows.push(row.into_iter().collect());
    }

    pub(crate) fn to_csv(&self) -> Result<String, StudyError> {
        let failed = |reason: String| StudyError::Csv {
            name: self.name,
            reason,
        };
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer
            .write_record(&self.header)
            .map_err(|e| failed(e.to_string()))?;
        for row in &self.rows {
            writer
                .write_record(row)
                .map_err(|e| failed(e.to_string()))?;
        }
        let bytes = writer.into_inner().map_err(|e| failed(e.to_string()))?;
        String::from_utf8(bytes).map_err(|e| failed(e.to_string()))
    }
}

/// A number as the shortest text that reads back to the same bits.
pub(crate) fn exact(value: f64) -> String {
    format!("{value:?}")
}

/// The same for a number that may be missing.
pub(crate) fn exact_or_empty(value: Option<f64>) -> String {
    value.map(exact).unwrap_or_default()
}

/// A figure of any kind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Drawing {
    /// Points and lines.
    Plot(Figure),
    /// Bars in groups.
    Bars(BarFigure),
}

impl From<Figure> for Drawing {
    fn from(figure: Figure) -> Self {
        Self::Plot(figure)
    }
}

impl From<BarFigure> for Drawing {
    fn from(figure: BarFigure) -> Self {
        Self::Bars(figure)
    }
}

impl Drawing {
    /// File stem.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Plot(figure) => &figure.name,
            Self::Bars(figure) => &figure.name,
        }
    }

    fn to_svg(&self) -> Result<String, ReportError> {
        match self {
            Self::Plot(figure) => figure.to_svg(),
            Self::Bars(figure) => figure.to_svg(),
        }
    }
}

/// A figure with the words below it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Captioned {
    pub(crate) figure: Drawing,
    pub(crate) caption: String,
    /// Name of the CSV file with its numbers.
    pub(crate) data: String,
}

impl Captioned {
    pub(crate) fn new(
        figure: impl Into<Drawing>,
        caption: impl Into<String>,
        data: impl Into<String>,
    ) -> Self {
        Self {
            figure: figure.into(),
            caption: caption.into(),
            data: data.into(),
        }
    }

    pub(crate) fn on_page(&self, command: &str) -> Result<PageFigure, StudyError> {
        Ok(PageFigure {
            svg: self.figure.to_svg()?,
            caption: self.caption.clone(),
            command: Some(command.to_owned()),
            data: Some(self.data.clone()),
        })
    }
}

/// Writes tables, figures (in `figures/`), the study as the JSON file that is named, and the page as `report.html`.
pub(crate) fn write_all(
    dir: &Path,
    tables: &[TextTable],
    figures: &[Captioned],
    (json, study): (&str, &impl Serialize),
    page: &str,
) -> Result<(), StudyError> {
    let figure_dir = dir.join("figures");
    std::fs::create_dir_all(&figure_dir).map_err(|source| StudyError::Folder {
        path: figure_dir.display().to_string(),
        source,
    })?;
    for table in tables {
        write_text_atomically(&dir.join(format!("{}.csv", table.name)), &table.to_csv()?)?;
    }
    for item in figures {
        let path = figure_dir.join(format!("{}.svg", item.figure.name()));
        write_text_atomically(&path, &item.figure.to_svg()?)?;
    }
    write_json_atomically(&dir.join(json), study)?;
    write_text_atomically(&dir.join("report.html"), page)?;
    Ok(())
}
