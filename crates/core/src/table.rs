//! Tables: named columns of typed cells.
//!
//! A table says once what it holds. The CSV writer, the JSON writer, the page and the terminal each show it in
//! their own way. A program gets every digit, and a reader gets the significant digits.

mod cell;

use serde::Serialize;

pub use cell::{Cell, Tone, Value};

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
    pub fn measured(mut self, heading: &str, pair: impl Fn(&'a T) -> Option<(f64, f64)>) -> Self {
        let cell = |item| pair(item).map_or_else(Cell::default, |(v, e)| Cell::measured(v, e));
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
