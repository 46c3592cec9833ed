//! Tables as CSV: one heading line, `name [unit]` or just `name` where there is no unit; then one row per
//! line. A number is the shortest text that reads back to the same bits, `nan` or `inf` where it is not finite.
//! A missing value is an empty field.

use std::fs;
use std::path::Path;

use lennard_core::{Cell, Column, Table, Value};

use crate::atomic::write_bytes_atomically;
use crate::error::excerpt;
use crate::formats::lines::{push_any_float, push_integer};
use crate::lines::open_regular;
use crate::sink::WholeFile;
use crate::{FileMark, FormatError, Sink, WriteError};

/// One record as CSV text, quoted where it must be.
fn push_record<F: AsRef<[u8]>>(
    to: &mut Vec<u8>,
    path: &Path,
    fields: impl IntoIterator<Item = F>,
) -> Result<(), WriteError> {
    let mut writer = csv::Writer::from_writer(to);
    writer
        .write_record(fields)
        .and_then(|()| writer.flush().map_err(csv::Error::from))
        .map_err(|e| WriteError::io(path, "write", std::io::Error::other(e)))
}

/// The headings of a column: its own, and one for the standard errors where it has any.
fn headings(column: &Column) -> impl Iterator<Item = String> {
    let error = column.has_errors.then(|| format!("{} standard error", column.name));
    std::iter::once(column.heading()).chain(error)
}

/// The fields of a cell: its value, and its standard error where the column has any.
fn fields(column: &Column, row: usize) -> impl Iterator<Item = Vec<u8>> {
    let cell = &column.cells[row];
    let error = column.has_errors.then(|| match cell.value {
        Value::Measured { error, .. } => number_text(error),
        _ => Vec::new(),
    });
    std::iter::once(field(cell)).chain(error)
}

/// The value of a cell.
fn field(cell: &Cell) -> Vec<u8> {
    let mut text = Vec::new();
    push_value(&mut text, cell);
    text
}

/// Appends the value of a cell; words are not quoted.
fn push_value(to: &mut Vec<u8>, cell: &Cell) {
    match &cell.value {
        Value::Missing => {}
        Value::Words(text) | Value::Figures(text) => to.extend_from_slice(text.as_bytes()),
        Value::Whole(value) => push_integer(to, *value),
        Value::Number { value, .. } | Value::Measured { value, .. } => push_any_float(to, *value),
    }
}

fn number_text(value: f64) -> Vec<u8> {
    let mut text = Vec::new();
    push_any_float(&mut text, value);
    text
}

/// Writes a table as CSV, whole or not at all.
///
/// # Errors
/// Where the columns differ in length, there is none, or the operating system refuses.
pub fn write_table_csv(path: &Path, table: &Table) -> Result<(), WriteError> {
    let lengths: Vec<usize> = table.columns.iter().map(|c| c.cells.len()).collect();
    if lengths.is_empty() || lengths.iter().any(|n| *n != table.rows()) {
        return Err(WriteError::Unwritable {
            path: path.to_path_buf(),
            what: "lengths of the columns",
            found: format!("{lengths:?}"),
            allowed: "at least one column, all of the same length".into(),
        });
    }
    let mut text = Vec::new();
    push_record(&mut text, path, table.columns.iter().flat_map(headings))?;
    for row in 0..table.rows() {
        push_record(&mut text, path, table.columns.iter().flat_map(|c| fields(c, row)))?;
    }
    write_bytes_atomically(path, &text)
}

/// Reads a table written by [`write_table_csv`] or [`TableWriter`]; its name is the stem of the file.
///
/// # Errors
/// Where the file cannot be read or a row holds anything but numbers.
pub fn read_table_csv(path: &Path) -> Result<Table, FormatError> {
    open_regular(path)?;
    let bytes = fs::read(path).map_err(|e| FormatError::io(path, e))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    table_from_bytes(&bytes, &name, path)
}

/// Like [`read_table_csv`], from memory.
///
/// # Errors
/// Where a row holds anything but numbers.
pub fn read_table_csv_bytes(bytes: &[u8]) -> Result<Table, FormatError> {
    table_from_bytes(bytes, "table", Path::new("table in memory"))
}

fn table_from_bytes(bytes: &[u8], name: &str, path: &Path) -> Result<Table, FormatError> {
    let content = |line, found, allowed: &str| FormatError::Content {
        file: path.to_path_buf(),
        line,
        found,
        allowed: allowed.into(),
    };
    let malformed = |e: csv::Error| {
        let line = e.position().map_or(1, csv::Position::line);
        content(line, e.to_string(), "rows as long as the heading line")
    };
    let mut reader = csv::Reader::from_reader(bytes);
    let headings = reader.byte_headers().map_err(malformed)?.clone();
    let mut columns: Vec<Column> =
        headings.iter().map(|text| Column::headed(&String::from_utf8_lossy(text))).collect();
    if columns.is_empty() {
        return Err(content(1, "no heading".into(), "one heading line"));
    }
    for record in reader.byte_records() {
        let record = record.map_err(malformed)?;
        let line = record.position().map_or(1, csv::Position::line);
        for (column, field) in columns.iter_mut().zip(&record) {
            let value: f64 = std::str::from_utf8(field)
                .ok()
                .and_then(|text| text.parse().ok())
                .ok_or_else(|| content(line, excerpt(field), "a number"))?;
            column.cells.push(value.into());
        }
    }
    Ok(Table { name: name.into(), caption: String::new(), columns })
}

/// Writes a growing table, whole rows only.
#[derive(Debug)]
pub struct TableWriter {
    file: WholeFile,
    columns: usize,
    text: Vec<u8>,
}

impl TableWriter {
    /// A table with its heading line; `columns` are names with units. What stood at `path` before is gone.
    ///
    /// # Errors
    /// Where the operating system refuses or there is no column.
    pub fn create(path: &Path, columns: &[(&str, &str)]) -> Result<Self, WriteError> {
        Self::with_heading(WholeFile::create(path)?, columns)
    }

    /// A table to any sink: for tests that make writes fail.
    ///
    /// # Errors
    /// Where the sink refuses the heading or there is no column.
    pub fn to_sink(
        path: &Path,
        columns: &[(&str, &str)],
        sink: Box<dyn Sink>,
    ) -> Result<Self, WriteError> {
        Self::with_heading(WholeFile::over(path, sink), columns)
    }

    fn with_heading(mut file: WholeFile, columns: &[(&str, &str)]) -> Result<Self, WriteError> {
        if columns.is_empty() {
            return Err(WriteError::Unwritable {
                path: file.path().to_path_buf(),
                what: "columns",
                found: "none".into(),
                allowed: "at least one".into(),
            });
        }
        let mut text = Vec::new();
        let headings = columns.iter().map(|(name, unit)| Column::new(*name, *unit).heading());
        push_record(&mut text, file.path(), headings)?;
        file.append(&text)?;
        file.records_start_here();
        Ok(Self { file, columns: columns.len(), text })
    }

    /// Goes on after `mark` (from a checkpoint): later rows, whole or not, are cut off.
    ///
    /// # Errors Where the file cannot be opened or does not begin with the heading of these
    /// columns. Also where it is shorter than the mark, or has no line end there.
    pub fn resume_at(
        path: &Path,
        columns: &[(&str, &str)],
        mark: FileMark,
    ) -> Result<Self, WriteError> {
        let mut wanted = Vec::new();
        push_record(
            &mut wanted,
            path,
            columns.iter().map(|(name, unit)| Column::new(*name, *unit).heading()),
        )?;
        let found = read_start(path, wanted.len())
            .map_err(|e| WriteError::io(path, "open the file to go on", e))?;
        if found != wanted || mark.bytes < wanted.len() as u64 {
            return Err(WriteError::NotResumable {
                path: path.to_path_buf(),
                wanted: mark.bytes,
                reason: format!(
                    "it begins with {}, not with the heading {}",
                    excerpt(&found),
                    excerpt(&wanted)
                ),
            });
        }
        Ok(Self {
            file: WholeFile::resume_at(path, mark, true)?,
            columns: columns.len(),
            text: Vec::new(),
        })
    }

    /// Appends a row.
    ///
    /// # Errors
    /// Where the operating system refuses; the file then holds the rows before this one and nothing else.
    ///
    /// # Panics
    /// Where the row has another number of cells than the heading: that is a bug of the caller.
    pub fn write(&mut self, row: &[Cell]) -> Result<(), WriteError> {
        assert_eq!(row.len(), self.columns, "one cell for each heading");
        self.text.clear();
        let is_text = |c: &Cell| matches!(c.value, Value::Words(_) | Value::Figures(_));
        if row.iter().any(is_text) {
            push_record(&mut self.text, self.file.path(), row.iter().map(field))?;
        } else {
            // A row of numbers needs no quotes, and a running simulation writes many.
            for (i, cell) in row.iter().enumerate() {
                if i > 0 {
                    self.text.push(b',');
                }
                push_value(&mut self.text, cell);
            }
            self.text.push(b'\n');
        }
        self.file.append(&self.text)
    }

    /// How far it is written, in bytes and rows: what a checkpoint keeps for [`Self::resume_at`].
    #[must_use]
    pub fn mark(&self) -> FileMark {
        self.file.mark()
    }

    /// Waits until every row is on the disk.
    ///
    /// # Errors
    /// Where the operating system refuses.
    pub fn sync(&mut self) -> Result<(), WriteError> {
        self.file.sync()
    }

    /// Syncs and closes.
    ///
    /// # Errors
    /// Where the operating system refuses.
    pub fn finish(mut self) -> Result<FileMark, WriteError> {
        self.sync()?;
        Ok(self.mark())
    }
}

fn read_start(path: &Path, length: usize) -> std::io::Result<Vec<u8>> {
    use std::io::Read;
    let mut start = Vec::new();
    fs::File::open(path)?.take(length as u64).read_to_end(&mut start)?;
    Ok(start)
}
