//! Tables as CSV: one heading line of plain names, comment lines, then one row per line.
//!
//! ```text
//! time,potential_energy
//! # time [τ]
//! # potential_energy [ε per particle]: potential energy U/N
//! 0.5,-6.1
//! ```
//!
//! A heading is a name in every language: Latin letters, digits and `_`. Lines with `#` have unit, words and symbol of a column, and the
//! caption. They stand below the heading: `numpy.genfromtxt(names=True)` takes the first line for the heading, even one that begins with `#`.
//! A number is the shortest text that reads back to the same bits, `nan` or `inf` where it is not finite.
//! A missing value is an empty field.

use std::fs;
use std::path::Path;

use lennard_observables::quantities::{quantity_of, quantity_unit};
use lennard_observables::{Cell, Column, Table, Value};

use crate::atomic::write_bytes_atomically;
use crate::error::excerpt;
use crate::formats::lines::{push_any_float, push_integer};
use crate::frame::unwritable;
use crate::lines::read_regular;
use crate::sink::WholeFile;
use crate::{FileMark, FormatError, WriteError};

/// What begins a line of comments.
const COMMENT: u8 = b'#';

/// Names of letters that stand in words of columns.
const LETTERS: [(char, &str); 6] =
    [('ρ', "density"), ('χ', "chi"), ('τ', "tau"), ('²', "squared"), ('−', "minus"), ('/', "per")];

/// One record as CSV text, quoted where it must be.
fn push_record<F: AsRef<[u8]>>(
    to: &mut Vec<u8>,
    path: &Path,
    fields: impl IntoIterator<Item = F>,
) -> Result<(), WriteError> {
    let mut writer = csv::WriterBuilder::new().comment(Some(COMMENT)).from_writer(to);
    writer
        .write_record(fields)
        .and_then(|()| writer.flush().map_err(csv::Error::from))
        .map_err(|e| WriteError::io(path, "write", std::io::Error::other(e)))
}

/// The heading of a column: its name where code can use it, else a plain name made of its words.
fn plain(words: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if words.starts_with(|c: char| c.is_ascii_lowercase()) && words.chars().all(is_plain) {
        return words.to_owned();
    }
    let mut text = String::new();
    for letter in words.chars() {
        match LETTERS.iter().find(|(known, _)| *known == letter) {
            Some((_, name)) => text += &format!("_{name}_"),
            None if is_plain(letter) => text.push(letter.to_ascii_lowercase()),
            None => text.push('_'),
        }
    }
    let parts: Vec<&str> = text.split('_').filter(|part| !part.is_empty()).collect();
    match parts.first() {
        Some(first) if first.starts_with(|c: char| c.is_ascii_lowercase()) => parts.join("_"),
        _ => format!("column_{}", parts.join("_")),
    }
}

/// The heading line, and lines of comments: unit, words and symbol of each column, and the caption.
fn heading(path: &Path, columns: &[Column], caption: &str) -> Result<Vec<u8>, WriteError> {
    let mut names: Vec<String> = Vec::new();
    let mut comments = String::new();
    for column in columns {
        let mut name = plain(&column.name);
        while names.contains(&name) {
            name += "_";
        }
        let words = match quantity_of(&column.name) {
            Some(quantity) if quantity.words.contains(quantity.symbol) => quantity.words.to_owned(),
            Some(quantity) => quantity.name(),
            None if name == column.name => String::new(),
            None => column.name.clone(),
        };
        let unit = Some(&*column.unit).filter(|unit| !unit.is_empty());
        let about = Column::new(&name, unit.unwrap_or(quantity_unit(&column.name))).heading();
        if !words.is_empty() {
            comments += &format!("# {about}: {words}\n");
        } else if about != name {
            comments += &format!("# {about}\n");
        }
        let error = column.has_errors.then(|| format!("{name}_standard_error"));
        names.push(name);
        names.extend(error);
    }
    if !caption.is_empty() {
        comments += &format!("# {}\n", caption.split_whitespace().collect::<Vec<_>>().join(" "));
    }
    let mut text = Vec::new();
    push_record(&mut text, path, &names)?;
    text.extend_from_slice(comments.as_bytes());
    Ok(text)
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
        let allowed = "at least one column, all of the same length";
        return Err(unwritable(path, "lengths of the columns", format!("{lengths:?}"), allowed));
    }
    let mut text = heading(path, &table.columns, &table.caption)?;
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
    let bytes = read_regular(path)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    table_from_bytes(&bytes, &name, path)
}

/// Reads a table of a user's own, whose cells stay text, with the line of each row.
///
/// # Errors
/// Where the file cannot be read, or a row has another length than the heading line.
pub fn read_words_csv(path: &Path) -> Result<(Table, Vec<u64>), FormatError> {
    let bytes = read_regular(path)?;
    rows(&bytes, path, |field| Ok(Cell::words(String::from_utf8_lossy(field).trim())))
}

/// Like [`read_table_csv`], from memory.
///
/// # Errors
/// Where a row holds anything but numbers.
pub fn read_table_csv_bytes(bytes: &[u8]) -> Result<Table, FormatError> {
    table_from_bytes(bytes, "table", Path::new("table in memory"))
}

fn table_from_bytes(bytes: &[u8], name: &str, path: &Path) -> Result<Table, FormatError> {
    let number = |field: &[u8]| {
        let number: Option<f64> =
            std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
        number.map(Cell::from).ok_or("a number")
    };
    Ok(Table { name: name.into(), ..rows(bytes, path, number)?.0 })
}

/// The rows of a table, with the line of each; `cell` reads a field, or says what may stand there.
fn rows(
    bytes: &[u8],
    path: &Path,
    cell: impl Fn(&[u8]) -> Result<Cell, &'static str>,
) -> Result<(Table, Vec<u64>), FormatError> {
    let malformed = |e: csv::Error| {
        let line = e.position().map_or(1, csv::Position::line);
        FormatError::content(path, line, &e.to_string(), "rows as long as the heading line")
    };
    // `# NAME [UNIT]: words`, where NAME is a heading.
    let text = String::from_utf8_lossy(bytes);
    let comments = text.lines().filter_map(|line| line.strip_prefix("# "));
    let about: Vec<Column> = comments
        .map(|line| Column::headed(line.split_once(": ").map_or(line, |(about, _)| about)))
        .collect();
    let mut reader = csv::ReaderBuilder::new().comment(Some(COMMENT)).from_reader(bytes);
    let headings = reader.byte_headers().map_err(malformed)?.clone();
    let mut columns: Vec<Column> = headings
        .iter()
        .map(|name| {
            let name = String::from_utf8_lossy(name);
            let unit = about.iter().find(|column| column.name == name).map(|c| c.unit.clone());
            Column::new(name, unit.unwrap_or_default())
        })
        .collect();
    if columns.is_empty() {
        return Err(FormatError::content(path, 1, "no heading", "one heading line"));
    }
    let mut lines = Vec::new();
    for record in reader.byte_records() {
        let record = record.map_err(malformed)?;
        let line = record.position().map_or(1, csv::Position::line);
        for (column, field) in columns.iter_mut().zip(&record) {
            let refused = |allowed| FormatError::content(path, line, &excerpt(field), allowed);
            column.cells.push(cell(field).map_err(refused)?);
        }
        lines.push(line);
    }
    Ok((Table { columns, ..Table::new("", "") }, lines))
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
        let mut file = WholeFile::create(path)?;
        if columns.is_empty() {
            return Err(unwritable(path, "columns", "none", "at least one"));
        }
        let text = heading(file.path(), &of(columns), "")?;
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
        let wanted = heading(path, &of(columns), "")?;
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
}

/// Empty columns of names with units.
fn of(columns: &[(&str, &str)]) -> Vec<Column> {
    columns.iter().map(|(name, unit)| Column::new(*name, *unit)).collect()
}

fn read_start(path: &Path, length: usize) -> std::io::Result<Vec<u8>> {
    use std::io::Read;
    let mut start = Vec::new();
    fs::File::open(path)?.take(length as u64).read_to_end(&mut start)?;
    Ok(start)
}
