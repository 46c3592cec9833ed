//! Figures as rows of a list: each names a table, its columns and a look, and one function draws it.
//!
//! ```text
//! let energy = FigureRow {
//!     name: "ways-energy",                              // file stem of the SVG
//!     title: "Bonds held in each way: energy",
//!     x: Axis::logarithmic("h / τ"),
//!     y: Axis::logarithmic("RMS of E − E(0) / ε"),
//!     table: "ways",                                    // ways.csv holds the numbers
//!     columns: vec![Columns::new("{}", ["dt", "energy RMS"], Look::joined).by("way")],
//!     caption: "RMS of the energy on the same run.".into(),
//!     ..FigureRow::default()
//! };
//! let picture = energy.draw(|name| csv.iter().find(|table| table.name == name).cloned());
//! ```
//!
//! `by` draws one series for each value of a column, in the order of the table, and `{}` in the name stands for this value.
//! The page of a study has such rows in a file: see [`super::written`].
//! `error` names the column of standard errors. Curves that are no columns, such as a law, are `theory`.

use std::borrow::Cow;
use std::collections::BTreeMap;

use lennard_observables::{Cell, Table, Value};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::lists::grouped;
use crate::report::{Axis, Dash, Figure, Guide, Look, Picture, Point, Series, Symbol};

/// Points of a line that can be told apart on a page.
const MOST_POINTS: usize = 600;

/// A figure of a table.
#[derive(Debug, Clone, Default)]
pub struct FigureRow<'a> {
    /// File stem of the figure.
    pub name: &'a str,
    /// Heading inside the figure.
    pub title: &'a str,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// File stem of the table.
    pub table: &'a str,
    /// The columns that are drawn.
    pub columns: Vec<Columns<'a>>,
    /// Curves that are no columns; they lie below.
    pub theory: Vec<Series>,
    /// Lines across.
    pub guides: Vec<Guide>,
    /// What it shows, with inline markup.
    pub caption: String,
}

/// Columns that are drawn: one series, or one for each value of another column.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Columns<'a> {
    /// Name in the legend; `{}` stands for the value of the column that divides the rows.
    #[serde(default)]
    name: Cow<'a, str>,
    /// The table, where it is not the one of the figure.
    pub(super) table: Option<Cow<'a, str>>,
    /// The column of abscissae.
    x: Cow<'a, str>,
    /// The column of ordinates.
    y: Cow<'a, str>,
    /// The column of standard errors.
    error: Option<Cow<'a, str>>,
    /// The column with what a reader sees who points at a mark.
    note: Option<Cow<'a, str>>,
    /// The column with the abscissae of failed runs.
    failed: Option<Cow<'a, str>>,
    /// The look of the series of an index.
    #[serde(deserialize_with = "look_of_name")]
    look: LookOf,
    /// The index of the first series.
    #[serde(default, rename = "at")]
    first: usize,
    /// The column with the index of a series, in place of their order.
    index: Option<Cow<'a, str>>,
    /// The column that divides the rows.
    by: Option<Cow<'a, str>>,
    /// The rows that are drawn: columns with the values that they must have, as they are written.
    #[serde(default)]
    pub(super) only: Only,
    /// Of each series, the first point that is drawn …
    #[serde(default)]
    from: usize,
    /// … and each so manieth after it; zero for all.
    #[serde(default)]
    every: usize,
}

/// The look of the series of an index.
type LookOf = fn(usize) -> Look;

/// Columns with the values that their rows must have, as they are written.
pub(super) type Only = BTreeMap<String, Vec<String>>;

/// The looks by the names that a file has for them.
fn look_of_name<'de, D: Deserializer<'de>>(from: D) -> Result<LookOf, D::Error> {
    const LOOKS: [(&str, LookOf); 9] = [
        ("line", Look::line),
        ("marks", Look::marks),
        ("joined", Look::joined),
        ("disc", |_| Look::Points(Symbol::Disc)),
        ("ring", |_| Look::Points(Symbol::Ring)),
        ("solid", |_| Look::Line(Dash::Solid)),
        ("dashed", |_| Look::Line(Dash::Dashed)),
        ("dotted", |_| Look::Line(Dash::Dotted)),
        ("dashed marks", |i| Look::LineAndPoints(Dash::Dashed, Symbol::cycle(i))),
    ];
    let name = String::deserialize(from)?;
    let look = LOOKS.iter().find(|(known, _)| *known == name);
    look.map(|(_, look)| *look).ok_or_else(|| D::Error::custom(format!("no look `{name}`")))
}

impl<'a> Columns<'a> {
    /// Abscissa and ordinate under a name in the legend; an empty one keeps them out.
    #[must_use]
    pub fn new(name: &'a str, [x, y]: [&'a str; 2], look: LookOf) -> Self {
        Self {
            name: name.into(),
            table: None,
            x: x.into(),
            y: y.into(),
            error: None,
            note: None,
            failed: None,
            look,
            first: 0,
            index: None,
            by: None,
            only: Only::new(),
            from: 0,
            every: 0,
        }
    }

    /// The same with the standard errors of this column: its numbers, or the errors in it where it is the column that is drawn.
    #[must_use]
    pub fn error(self, column: &'a str) -> Self {
        Self { error: Some(column.into()), ..self }
    }

    /// The same with the look and the color of the `index`-th series.
    #[must_use]
    pub fn at(self, index: usize) -> Self {
        Self { first: index, ..self }
    }

    /// The same from another table than the one of the figure.
    #[must_use]
    pub fn of(self, table: &'a str) -> Self {
        Self { table: Some(table.into()), ..self }
    }

    /// One series for each value of this column.
    #[must_use]
    pub fn by(self, column: &'a str) -> Self {
        Self { by: Some(column.into()), ..self }
    }

    /// The first column that a table lacks.
    pub(super) fn lacking(&self, table: &Table) -> Option<&str> {
        let options = [&self.error, &self.note, &self.failed, &self.index, &self.by];
        let named = options.into_iter().flatten().chain([&self.x, &self.y]).map(|name| &**name);
        let mut all = named.chain(self.only.keys().map(String::as_str));
        all.find(|name| !table.columns.iter().any(|column| column.name == *name))
    }

    /// The series of a table; none where it lacks a column.
    fn series(&self, table: &Table) -> Option<Vec<Series>> {
        if self.lacking(table).is_some() {
            return None;
        }
        let numbers = |name: &Option<Cow<'_, str>>| table.numbers(name.as_deref()?);
        let (x, y) = (table.numbers(&self.x)?, table.numbers(&self.y)?);
        let [failed, index] = [&self.failed, &self.index].map(numbers);
        let error = self.error.as_ref().and_then(|name| match *name == self.y {
            true => own_errors(table, name),
            false => table.numbers(name),
        });
        let rows = (0..table.rows()).filter(|row| takes(&self.only, table, *row));
        let by = |row| match &self.by {
            Some(by) => value_of(table, by, row),
            None => Some(String::new()),
        };
        let groups = grouped(rows.map(|row| Some((by(row)?, row))).collect::<Option<Vec<_>>>()?);
        let point = |row: usize| Point {
            error: error.as_ref().map(|error| error[row]),
            note: self.note.as_ref().and_then(|note| value_of(table, note, row)),
            ..Point::from((x[row], y[row]))
        };
        let series = groups.into_iter().enumerate().map(|(i, (value, rows))| {
            let index = index.as_ref().map_or(self.first + i, |index| index[rows[0]] as usize);
            let failed = rows.iter().filter_map(|row| Some(failed.as_ref()?[*row]));
            let failures = failed.filter(|x| x.is_finite()).map(|x| (x, f64::NAN));
            let points: Vec<Point> = rows
                .iter()
                .map(|row| point(*row))
                .filter(|p| p.x.is_finite() && p.y.is_finite())
                .skip(self.from)
                .step_by(self.every.max(1))
                .collect();
            let look = (self.look)(index);
            let points = if matches!(look, Look::Line(_)) { thinned(points) } else { points };
            Series::new(self.name.replace("{}", &value), look, index, points)
                .with_failures(failures)
        });
        Some(series.collect())
    }
}

/// The standard errors of a column of measured numbers.
fn own_errors(table: &Table, name: &str) -> Option<Vec<f64>> {
    let column = table.columns.iter().find(|column| column.name == name)?;
    let error = |cell: &Cell| match cell.value {
        Value::Measured { error, .. } => error,
        _ => f64::NAN,
    };
    Some(column.cells.iter().map(error).collect())
}

/// Whether a row has the values that it must have.
pub(super) fn takes(only: &Only, table: &Table, row: usize) -> bool {
    let has = |(column, values): (&String, &Vec<String>)| {
        value_of(table, column, row).is_some_and(|value| values.contains(&value))
    };
    only.iter().all(has)
}

/// The value of a cell, as it is written.
pub(super) fn value_of(table: &Table, column: &str, row: usize) -> Option<String> {
    let column = table.columns.iter().find(|c| c.name == column)?;
    Some(match &column.cells.get(row)?.value {
        Value::Words(words) | Value::Figures(words) => words.clone(),
        number => number.number().to_string(),
    })
}

/// A line with neighbors averaged where there are more than can be seen.
fn thinned(points: Vec<Point>) -> Vec<Point> {
    let group = points.len().div_ceil(MOST_POINTS).max(1);
    if group == 1 {
        return points;
    }
    let mean = |c: &[Point]| {
        let n = c.len() as f64;
        let (x, y) = c.iter().fold((0.0, 0.0), |(x, y), p| (x + p.x, y + p.y));
        Point::from((x / n, y / n))
    };
    points.chunks(group).map(mean).collect()
}

impl FigureRow<'_> {
    /// The figure with its caption; none where there is no such table, or nothing in its columns.
    pub fn draw(self, tables: impl Fn(&str) -> Option<Table>) -> Option<Picture> {
        let table = tables(self.table)?;
        let series = |columns: &Columns<'_>| match &columns.table {
            Some(other) => columns.series(&tables(other)?),
            None => columns.series(&table),
        };
        let drawn = self.columns.iter().filter_map(series).flatten();
        let figure = Figure {
            series: self.theory.into_iter().chain(drawn).collect(),
            guides: self.guides,
            ..Figure::new(self.name, self.title, self.x, self.y)
        };
        (!figure.is_empty())
            .then(|| Picture::new(figure, self.caption, format!("{}.csv", self.table)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Drawing;

    fn table() -> Table {
        let rows = [("a", 1.0, 2.0), ("b", 1.0, 3.0), ("a", 2.0, 4.0), ("b", 2.0, f64::NAN)];
        Table::rows_of("t", &rows)
            .column("way", |r| r.0)
            .column("x [σ]", |r| r.1)
            .column("y", |r| r.2)
            .table()
    }

    fn drawn(columns: Columns<'_>) -> Option<Figure> {
        let row = FigureRow { name: "f", table: "t", columns: vec![columns], ..Default::default() };
        let picture = row.draw(|name| (name == "t").then(table))?;
        assert_eq!(picture.data, "t.csv");
        match picture.drawing {
            Drawing::Plot(figure) => Some(figure),
            _ => None,
        }
    }

    #[test]
    fn a_column_divides_the_rows_into_series_and_what_is_no_number_is_left_out() {
        let figure = drawn(Columns::new("way {}", ["x", "y"], Look::joined).by("way")).unwrap();
        let series = |k: usize| (figure.series[k].name.as_str(), figure.series[k].points.len());
        assert_eq!([series(0), series(1)], [("way a", 2), ("way b", 1)]);
        assert_ne!(figure.series[0].color, figure.series[1].color);
        let one = drawn(Columns::new("all", ["x", "y"], Look::marks).at(3)).unwrap();
        assert_eq!((one.series.len(), one.series[0].points.len(), one.series[0].color), (1, 3, 3));
        assert!(drawn(Columns::new("all", ["x", "z"], Look::line)).is_none());
    }

    #[test]
    fn a_long_line_is_averaged_and_marks_are_not() {
        let numbers: Vec<f64> = (0..6000).map(f64::from).collect();
        let table = Table::new("t", "").with("x", "", numbers.clone()).with("y", "", numbers);
        let points =
            |look| Columns::new("", ["x", "y"], look).series(&table).unwrap()[0].points.len();
        assert_eq!(points(Look::line), 600);
        assert_eq!(points(Look::marks), 6000);
    }
}
