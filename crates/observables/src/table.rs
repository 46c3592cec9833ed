//! Tables: named columns of typed cells.
//!
//! A table says once what it holds. The CSV writer, the JSON writer, the page and the terminal each show it in
//! their own way. A program gets every digit, and a reader gets the significant digits.

use serde::Serialize;
use serde::ser::{SerializeStruct, Serializer};

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Unit (`σ`, `ε`, or empty).
    pub unit: String,
    /// Whether a program gets the standard errors in a second column.
    #[serde(skip)]
    pub has_errors: bool,
    /// Cells, one per row.
    pub cells: Vec<Cell>,
}

impl Column {
    /// An empty column.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into(), has_errors: false, cells: Vec::new() }
    }

    /// An empty column with the heading `name [unit]`, or just `name` where there is no unit.
    #[must_use]
    pub fn headed(heading: &str) -> Self {
        let (name, unit) = heading
            .strip_suffix(']')
            .and_then(|text| text.rsplit_once(" ["))
            .unwrap_or((heading, ""));
        Self::new(name, unit)
    }

    /// The heading `name [unit]`, or just `name` where there is no unit.
    #[must_use]
    pub fn heading(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }

    /// The column as numbers; not a number where a cell is none.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        self.cells.iter().map(|c| c.value.number()).collect()
    }
}

/// A table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// File stem (`rdf`).
    pub name: String,
    /// What it holds, in a sentence or two.
    pub caption: String,
    /// Columns of equal length.
    pub columns: Vec<Column>,
}

impl Table {
    /// An empty table.
    #[must_use]
    pub fn new(name: impl Into<String>, caption: impl Into<String>) -> Self {
        Self { name: name.into(), caption: caption.into(), columns: Vec::new() }
    }

    /// Adds a column of numbers.
    #[must_use]
    pub fn with(
        mut self,
        name: impl Into<String>,
        unit: impl Into<String>,
        numbers: Vec<f64>,
    ) -> Self {
        self.columns.push(Column {
            cells: numbers.into_iter().map(Into::into).collect(),
            ..Column::new(name, unit)
        });
        self
    }

    /// A table with one row per item, whose columns are added by [`RowsOf::column`].
    #[must_use]
    pub fn rows_of<T>(name: impl Into<String>, items: &[T]) -> RowsOf<'_, T> {
        RowsOf { table: Self::new(name, ""), items }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.iter().map(|c| c.cells.len()).max().unwrap_or(0)
    }

    /// The cells of a row; missing ones where a column is shorter.
    pub fn row(&self, row: usize) -> impl Iterator<Item = Cell> {
        self.columns.iter().map(move |c| c.cells.get(row).cloned().unwrap_or_default())
    }

    /// A column as numbers; `None` where no column has the name.
    #[must_use]
    pub fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        let column = self.columns.iter().find(|c| c.name == name)?;
        Some(column.numbers())
    }

    /// The same table without the named columns, for a reader with less room.
    #[must_use]
    pub fn without(mut self, names: &[&str]) -> Self {
        self.columns.retain(|c| !names.contains(&c.name.as_str()));
        self
    }
}

/// A table that grows column by column, with one row per item.
#[derive(Debug)]
pub struct RowsOf<'a, T> {
    table: Table,
    items: &'a [T],
}

impl<'a, T> RowsOf<'a, T> {
    /// Says what the table holds.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.table.caption = caption.into();
        self
    }

    /// Adds a column with the heading `name [unit]`, or just `name`; `cell` gives the cell of an item.
    #[must_use]
    pub fn column<C: Into<Cell>>(mut self, heading: &str, cell: impl Fn(&'a T) -> C) -> Self {
        self.table.columns.push(Column {
            cells: self.items.iter().map(|item| cell(item).into()).collect(),
            ..Column::headed(heading)
        });
        self
    }

    /// Adds a column of numbers with standard errors, where an item has them.
    #[must_use]
    pub fn measured<P: Into<(f64, f64)>>(
        mut self,
        heading: &str,
        pair: impl Fn(&'a T) -> Option<P>,
    ) -> Self {
        let measured = |(value, error)| Cell::measured(value, error);
        let cell = |item| pair(item).map_or_else(Cell::default, |pair| measured(pair.into()));
        self.table.columns.push(Column {
            has_errors: true,
            cells: self.items.iter().map(cell).collect(),
            ..Column::headed(heading)
        });
        self
    }

    /// The finished table.
    #[must_use]
    pub fn table(self) -> Table {
        self.table
    }
}

// A cell of a table: a typed value, and a tone for a reader.

/// What a cell holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Value {
    /// Nothing: an empty field for a program, a dash for a reader.
    #[default]
    Missing,
    /// Words.
    Words(String),
    /// Figures that are written already, such as a range. They stand where numbers stand.
    Figures(String),
    /// A whole number.
    Whole(u64),
    /// A number.
    Number {
        /// The number.
        value: f64,
        /// Significant digits for a reader; `None` means as few as the number needs, four at most.
        digits: Option<usize>,
    },
    /// A number with its standard error.
    Measured {
        /// The number.
        value: f64,
        /// Its standard error; not a number where there is none.
        error: f64,
    },
}

/// What a cell says beyond its value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Tone {
    /// Nothing.
    #[default]
    Plain,
    /// The thing holds.
    Good,
    /// The thing does not hold.
    Bad,
    /// The thing wants care.
    Careful,
    /// The thing is shown, and nothing follows from it.
    Faint,
}

/// A cell of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cell {
    /// What it holds.
    pub value: Value,
    /// What it says beyond that.
    pub tone: Tone,
}

impl Cell {
    /// Words.
    #[must_use]
    pub fn words(words: impl Into<String>) -> Self {
        Value::Words(words.into()).into()
    }

    /// Figures that are written already.
    #[must_use]
    pub fn figures(figures: impl Into<String>) -> Self {
        Value::Figures(figures.into()).into()
    }

    /// A number of which a reader sees so many significant digits.
    #[must_use]
    pub fn rounded(value: impl Into<Option<f64>>, digits: usize) -> Self {
        let number = |value| Value::Number { value, digits: Some(digits) };
        value.into().map_or(Value::Missing, number).into()
    }

    /// A number with its standard error.
    #[must_use]
    pub fn measured(value: f64, error: f64) -> Self {
        Value::Measured { value, error }.into()
    }

    /// The same cell in another tone.
    #[must_use]
    pub fn toned(self, tone: Tone) -> Self {
        Self { tone, ..self }
    }
}

impl Value {
    /// Whether the value is a number, or stands where numbers stand.
    #[must_use]
    pub fn is_numeric(&self) -> bool {
        !matches!(self, Self::Missing | Self::Words(_))
    }

    /// The value as a number; not a number where it is none.
    #[must_use]
    pub fn number(&self) -> f64 {
        match self {
            Self::Whole(value) => *value as f64,
            Self::Number { value, .. } | Self::Measured { value, .. } => *value,
            Self::Missing | Self::Words(_) | Self::Figures(_) => f64::NAN,
        }
    }
}

impl From<Value> for Cell {
    fn from(value: Value) -> Self {
        Self { value, tone: Tone::Plain }
    }
}

/// What a cell of a value of each type holds.
macro_rules! cells {
    ($($type:ty: |$value:ident| $cell:expr;)*) => {$(
        impl From<$type> for Cell {
            fn from($value: $type) -> Self {
                $cell.into()
            }
        }
    )*};
}

cells! {
    f64: |value| Value::Number { value, digits: None };
    u64: |value| Value::Whole(value);
    u32: |value| u64::from(value);
    usize: |value| value as u64;
    bool: |value| value.to_string();
    String: |words| Value::Words(words);
    &str: |words| words.to_owned();
    &String: |words| words.clone();
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or_else(Self::default, Into::into)
    }
}

impl Serialize for Cell {
    /// Words as a string, a number as a number, a missing value as null; the tone is for readers only.
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match &self.value {
            Value::Missing => to.serialize_none(),
            Value::Words(text) | Value::Figures(text) => to.serialize_str(text),
            Value::Whole(value) => to.serialize_u64(*value),
            Value::Number { value, .. } => to.serialize_f64(*value),
            Value::Measured { value, error } => {
                let mut both = to.serialize_struct("Measured", 2)?;
                both.serialize_field("value", value)?;
                both.serialize_field("standard_error", error)?;
                both.end()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_is_taken_apart_and_put_together() {
        for (heading, name, unit) in [
            ("dt [tau]", "dt", "tau"),
            ("x [y] z", "x [y] z", ""),
            ("P [ε/σ³]", "P", "ε/σ³"),
            ("[σ]", "[σ]", ""),
        ] {
            let column = Column::headed(heading);
            assert_eq!((column.name.as_str(), column.unit.as_str()), (name, unit));
            assert_eq!(column.heading(), heading);
        }
    }

    #[test]
    fn a_table_of_items_has_a_row_for_each_and_gives_its_numbers_back() {
        let items = [("a", Some(1.5), 3_usize), ("b", None, 4)];
        let table = Table::rows_of("t", &items)
            .column("name", |i| i.0)
            .column("value [σ]", |i| i.1)
            .column("count", |i| i.2)
            .table();
        assert_eq!(table.rows(), 2);
        let last: Vec<Value> = table.row(1).map(|c| c.value).collect();
        let wanted = [Value::Words("b".into()), Value::Missing, Value::Whole(4)];
        assert_eq!(last, wanted);
        assert_eq!(table.numbers("count"), Some(vec![3.0, 4.0]));
        assert!(table.numbers("value").unwrap()[1].is_nan());
        assert_eq!(table.numbers("other"), None);
        assert_eq!(table.without(&["count", "value"]).columns.len(), 1);
    }
}
