//! A user's own literature: values at states, with errors and sources, in a CSV file.
//!
//! ```text
//! quantity,value,error,temperature,density,source
//! pressure,1.02,0.01,0.722,0.8442,"Verlet 1967, table I"
//! ```
//!
//! Quantities are the keys of `lennard list quantities`. An empty error is not known, and an empty density stands for any.

use std::path::Path;

use lennard_io::FormatError;
use lennard_observables::quantities::QUANTITIES;
use lennard_observables::{Table, Value};
use serde::Serialize;

use super::RunFolder;

/// The columns that the file must have; more are allowed.
const COLUMNS: [&str; 6] = ["quantity", "value", "error", "temperature", "density", "source"];
/// Temperature and density of a run are at a state where they are off by no more than this part.
const SAME_STATE: f64 = 0.005;

/// A value of the literature.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OwnValue {
    /// Key of the quantity.
    pub quantity: String,
    /// Value in reduced units.
    pub value: f64,
    /// One standard error, where the source gives one.
    pub error: Option<f64>,
    /// Temperature, ε/k_B.
    pub temperature: f64,
    /// Density, σ⁻³; absent where the value is of any density.
    pub density: Option<f64>,
    /// Where it is from.
    pub source: String,
    /// Its line in the file.
    pub line: u64,
}

impl OwnValue {
    /// Whether the value is of this density and temperature.
    pub(super) fn is_at(&self, [density, temperature]: [f64; 2]) -> bool {
        same(self.density.unwrap_or(density), density) && same(self.temperature, temperature)
    }
}

/// Whether two densities or temperatures are the same within half a percent.
pub(super) fn same(one: f64, other: f64) -> bool {
    (one - other).abs() <= SAME_STATE * one.abs()
}

/// Reads the file. Its quantities are known to the program, or measured by one of the runs.
///
/// # Errors
/// [`FormatError`] with the line where a column is missing, a quantity is not known, or a value is no number.
pub fn read(path: &Path, runs: &[RunFolder]) -> Result<Vec<OwnValue>, FormatError> {
    let (table, lines) = lennard_io::read_words_csv(path)?;
    let refused = |line: u64, found: String, allowed: String, near: Option<String>| {
        let near = near.map_or_else(String::new, |name| format!("; nearest: {name}"));
        FormatError::Content { file: path.to_owned(), line, found, allowed: allowed + &near }
    };
    let headings: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
    if let Some(missing) = COLUMNS.into_iter().find(|name| !headings.contains(name)) {
        let near = lennard_scene::nearest(missing, headings.iter().copied());
        let found = format!("no column `{missing}` among {}", headings.join(", "));
        return Err(refused(1, found, format!("the columns {}", COLUMNS.join(", ")), near));
    }
    let measured = runs.iter().flat_map(|run| run.record.averages.keys().map(String::as_str));
    let known: Vec<&str> = QUANTITIES.iter().map(|q| q.key).chain(measured).collect();
    let value = |row: usize, line: u64| {
        let text = |column| word(&table, column, row);
        let number = |column: &'static str| match text(column) {
            "" => Ok(None),
            text => match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(Some(number)),
                _ => Err(refused(
                    line,
                    format!("{column} = `{text}`"),
                    "a finite number".into(),
                    None,
                )),
            },
        };
        let needed = |column: &'static str| {
            let missing = || refused(line, format!("no {column}"), "a finite number".into(), None);
            number(column)?.ok_or_else(missing)
        };
        let quantity = text("quantity");
        if !known.contains(&quantity) {
            let near = lennard_scene::nearest(quantity, known.iter().copied());
            let allowed = "a name of `lennard list quantities`, or of a mean of these runs".into();
            return Err(refused(line, format!("quantity = `{quantity}`"), allowed, near));
        }
        let error = number("error")?;
        if let Some(error) = error.filter(|error| *error < 0.0) {
            return Err(refused(line, format!("error = {error}"), "at least 0".into(), None));
        }
        Ok(OwnValue {
            quantity: quantity.to_owned(),
            value: needed("value")?,
            error,
            temperature: needed("temperature")?,
            density: number("density")?,
            source: text("source").to_owned(),
            line,
        })
    };
    lines.iter().enumerate().map(|(row, line)| value(row, *line)).collect()
}

/// A cell of a column that is there.
fn word<'a>(table: &'a Table, column: &str, row: usize) -> &'a str {
    let column = table.columns.iter().find(|c| c.name == column);
    match column.map(|column| &column.cells[row].value) {
        Some(Value::Words(text)) => text,
        _ => "",
    }
}
