//! A page in a file: its words, its figures as rows, and where its tables stand.
//!
//! ```toml
//! title = "Constraints, springs and collisions"
//! lead = "{ways} ways to hold a bond. {verdicts}."       # words in braces are given by the study
//!
//! [[figure]]                                             # one figure, or `each` value of a column: `{column}` is that value
//! name = "ways-energy"
//! title = "Bonds held in each way: energy"
//! table = "ways"                                         # ways.csv has the numbers; `data` names another file
//! x = { label = "h / τ", scale = "logarithmic" }
//! y = { label = "RMS of E − E(0) / ε", scale = "logarithmic", range = [1e-8, 10.0] }
//! series = [{ name = "{}", x = "dt", y = "energy RMS", look = "joined", by = "way" }]
//! caption = "RMS of the energy on the same run."         # or parts: one with a word that is not given is left out
//!
//! [[figure]]                                             # a figure `of` each of these names: `{of}` is the name
//! of = ["potential_energy", "pressure"]
//!
//! [[section]]
//! title = "A bond held in each way"
//! blocks = [
//!     { text = "Two dumbbells meet and part." },         # or heading, remark, equations; list of a name
//!     { figures = ["ways-energy"] },
//!     { table = "ways-in-a-line" },
//! ]
//! ```

use std::collections::BTreeMap;

use lennard_observables::{Cell, Column, Table, Value};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::lists::grouped;
use crate::report::{
    Axis, Block, Dash, Figure, Guide, Look, Page, Picture, Point, ReportError, Section, Series,
    Symbol,
};

/// What the names and the braces of the text of a page stand for.
#[derive(Debug, Clone, Default)]
pub(crate) struct Given {
    /// The tables that figures are drawn from, and those on the page.
    pub(crate) tables: Vec<Table>,
    /// Words in braces.
    pub(crate) words: Vec<(&'static str, String)>,
    /// Lists.
    pub(crate) lists: Vec<(&'static str, Vec<String>)>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PageText {
    #[serde(default)]
    title: String,
    #[serde(default)]
    lead: String,
    figure: Vec<toml::Table>,
    #[serde(default)]
    section: Vec<SectionText>,
}

/// A figure. Its words are filled in, apart from words that a row of its table gives.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FigureText {
    name: String,
    title: String,
    table: String,
    data: Option<String>,
    each: Option<String>,
    #[serde(default)]
    only: Only,
    x: Axis,
    y: Axis,
    #[serde(default)]
    guides: Vec<Guide>,
    series: Vec<Columns>,
    caption: Caption,
}

/// A caption, or its parts, of which a part with an open word is left out.
#[derive(Deserialize)]
#[serde(untagged)]
enum Caption {
    Whole(String),
    Parts(Vec<String>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SectionText {
    title: String,
    blocks: Vec<BlockText>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum BlockText {
    Text(String),
    Heading(String),
    Remark(String),
    Equations(String),
    List(String),
    Figures(Vec<String>),
    Table(String),
}

/// A table with columns that are drawn alone.
pub(crate) trait Drawn {
    /// Adds a column with a cell for each row.
    fn and<C: Into<Cell>>(self, name: &str, cells: impl IntoIterator<Item = C>) -> Self;
}

impl Drawn for Table {
    fn and<C: Into<Cell>>(mut self, name: &str, cells: impl IntoIterator<Item = C>) -> Self {
        let cells = cells.into_iter().map(Into::into).collect();
        self.columns.push(Column { cells, ..Column::headed(name) });
        self
    }
}

/// A text with words in the place of their names in braces. Other braces stay, and so do braces in a word.
pub(crate) fn filled<N: AsRef<str>>(text: &str, words: &[(N, String)]) -> String {
    let mut parts = text.split('{');
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let word = part.split_once('}').and_then(|(name, rest)| {
            let (_, word) = words.iter().find(|(known, _)| known.as_ref() == name)?;
            Some([word, rest])
        });
        match word {
            Some(word) => filled += &word.concat(),
            None => filled.extend(["{", part]),
        }
    }
    filled
}

/// Fills in the words in all texts of a value.
fn fill<N: AsRef<str>>(value: &mut toml::Value, words: &[(N, String)]) {
    match value {
        toml::Value::String(text) => *text = filled(text, words),
        toml::Value::Array(values) => values.iter_mut().for_each(|value| fill(value, words)),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, value)| fill(value, words)),
        _ => {}
    }
}

/// The figures of a row of a text: one, or one `of` each of the names.
fn figures_of<N: AsRef<str>>(
    mut row: toml::Table,
    words: &[(N, String)],
) -> Result<Vec<FigureText>, ReportError> {
    let refused = |e: toml::de::Error| ReportError::Text(e.to_string());
    let names = row.remove("of").map(toml::Value::try_into::<Vec<String>>);
    let row = toml::Value::Table(row);
    let rows = match names.transpose().map_err(refused)? {
        None => vec![row],
        Some(names) => {
            let of = |name: String| {
                let mut row = row.clone();
                fill(&mut row, &[("of", name)]);
                row
            };
            names.into_iter().map(of).collect()
        }
    };
    let figure = |mut row: toml::Value| {
        fill(&mut row, words);
        row.try_into().map_err(refused)
    };
    rows.into_iter().map(figure).collect()
}

/// The pictures of a text that has figures alone. What has no table, or no numbers in it, is left out.
///
/// # Errors
/// [`ReportError::Text`] where the text has no figures.
pub(crate) fn pictures(
    text: &str,
    tables: &dyn Fn(&str) -> Option<Table>,
    words: &[(String, String)],
) -> Result<Vec<Picture>, ReportError> {
    let text: PageText = toml::from_str(text).map_err(|e| ReportError::Text(e.to_string()))?;
    let mut pictures = Vec::new();
    for row in text.figure {
        pictures.extend(figures_of(row, words)?.iter().flat_map(|figure| figure.drawn(tables)));
    }
    Ok(pictures)
}

/// The page of a text.
///
/// # Errors
/// [`ReportError::Text`] where the text is no page, or names a figure, a table, a column or a word that is not there.
pub(crate) fn written(text: &str, given: &Given) -> Result<Page, ReportError> {
    let text: PageText = toml::from_str(text).map_err(|e| ReportError::Text(e.to_string()))?;
    let mut pictures = Vec::new();
    for row in text.figure {
        let name = row.get("name").and_then(toml::Value::as_str).unwrap_or_default().to_owned();
        let figures = figures_of(row, &given.words)?;
        figures.iter().try_for_each(|figure| figure.check(given))?;
        let tables = |name: &str| given.table(name).ok().cloned();
        pictures.push((name, figures.iter().flat_map(|f| f.drawn(&tables)).collect()));
    }
    let section = |(i, section): (usize, SectionText)| {
        let blocks = section.blocks.into_iter().map(|block| block.of(given, &pictures));
        let blocks = blocks.collect::<Result<_, _>>()?;
        // What comes first answers the question of the study.
        Ok(Section { blocks, folded: i > 0, ..Section::new(section.title) })
    };
    Ok(Page {
        title: words_of(&text.title, given)?,
        lead: words_of(&text.lead, given)?,
        sections: text.section.into_iter().enumerate().map(section).collect::<Result<_, _>>()?,
        ..Page::default()
    })
}

/// The error for a name that stands for nothing.
fn missing(what: &str, name: &str) -> ReportError {
    ReportError::Text(format!("there is no {what} `{name}`"))
}

/// A text whose braces are all filled.
fn words_of(text: &str, given: &Given) -> Result<String, ReportError> {
    let text = filled(text, &given.words);
    match text.split_once('{') {
        Some((_, rest)) => {
            let name = rest.split('}').next().unwrap_or_default();
            Err(missing("word", name))
        }
        None => Ok(text),
    }
}

impl Given {
    fn table(&self, name: &str) -> Result<&Table, ReportError> {
        let table = self.tables.iter().find(|table| table.name == name);
        table.ok_or_else(|| missing("table", name))
    }
}

impl BlockText {
    fn of(self, given: &Given, pictures: &[(String, Vec<Picture>)]) -> Result<Block, ReportError> {
        Ok(match self {
            Self::Text(text) => Block::Text(words_of(&text, given)?),
            Self::Heading(text) => Block::Heading(text),
            Self::Remark(text) => Block::Remark(text),
            Self::Equations(text) => Block::Equations(text.lines().map(str::to_owned).collect()),
            Self::List(name) => {
                let list = given.lists.iter().find(|(known, _)| *known == name);
                Block::List(list.ok_or_else(|| missing("list", &name))?.1.clone())
            }
            Self::Table(name) => Block::Table(given.table(&name)?.clone()),
            Self::Figures(names) => {
                // The name is of a row, or of one of the figures of a row.
                let found = |name: &String| {
                    let row = pictures.iter().find(|(row, _)| row == name);
                    let mut all = pictures.iter().flat_map(|(_, drawn)| drawn);
                    let one = || Some(vec![all.find(|picture| picture.name() == name)?.clone()]);
                    let drawn = row.map(|(_, drawn)| drawn.clone()).or_else(one);
                    drawn.ok_or_else(|| missing("figure", name))
                };
                let found = names.iter().map(found).collect::<Result<Vec<_>, _>>()?;
                Block::Figures(found.concat())
            }
        })
    }
}

impl FigureText {
    /// Whether the tables and the columns are there that the figure names.
    fn check(&self, given: &Given) -> Result<(), ReportError> {
        for columns in self.columns(&self.only) {
            let table = given.table(columns.table.as_deref().unwrap_or(&self.table))?;
            if let Some(column) = columns.lacking(table) {
                let (name, table) = (&self.name, &table.name);
                let text = format!("figure `{name}`: the table `{table}` has no column `{column}`");
                return Err(ReportError::Text(text));
            }
        }
        given.table(&self.table).map(drop)
    }

    /// The figure, or one for each value of the column that it names; none where its columns are empty.
    fn drawn(&self, tables: &dyn Fn(&str) -> Option<Table>) -> Vec<Picture> {
        let Some(table) = tables(&self.table) else {
            return Vec::new();
        };
        let Some(each) = &self.each else {
            return self.picture(&table, tables, &self.only, &[]).into_iter().collect();
        };
        let mut only = self.only.clone();
        let rows = (0..table.rows()).filter(|row| takes(&self.only, &table, *row));
        let values = grouped(rows.filter_map(|row| Some((value_of(&table, each, row)?, row))));
        let pictures = values.into_iter().filter_map(|(value, rows)| {
            only.insert(each.clone(), vec![value]);
            let named = |name: &str| Some((name.to_owned(), value_of(&table, name, rows[0])?));
            let words: Vec<_> = table.columns.iter().filter_map(|c| named(&c.name)).collect();
            self.picture(&table, tables, &only, &words)
        });
        pictures.collect()
    }

    /// What is drawn, of these rows of the table of the figure.
    fn columns(&self, only: &Only) -> Vec<Columns> {
        let mut all = self.series.clone();
        for columns in all.iter_mut().filter(|columns| columns.table.is_none()) {
            columns.only.extend(only.clone());
        }
        all
    }

    fn picture(
        &self,
        table: &Table,
        tables: &dyn Fn(&str) -> Option<Table>,
        only: &Only,
        words: &[(String, String)],
    ) -> Option<Picture> {
        let series = |columns: &Columns| match &columns.table {
            Some(other) => columns.series(&tables(other)?),
            None => columns.series(table),
        };
        let data = self.data.as_ref().unwrap_or(&self.table);
        let [name, title, data] = [&self.name, &self.title, data].map(|text| filled(text, words));
        let figure = Figure {
            series: self.columns(only).iter().filter_map(series).flatten().collect(),
            guides: self.guides.clone(),
            ..Figure::new(name, title, self.x.clone(), self.y.clone())
        };
        let caption = match &self.caption {
            Caption::Whole(text) => filled(text, words),
            Caption::Parts(parts) => parts.iter().filter(|p| !p.contains('{')).cloned().collect(),
        };
        (!figure.is_empty()).then(|| Picture::new(figure, caption, format!("{data}.csv")))
    }
}

/// Points of a line that can be told apart on a page.
const MOST_POINTS: usize = 600;

/// Columns that are drawn: one series, or one for each value of another column.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Columns {
    /// Name in the legend, empty where there is none; `{}` stands for the value of the column that divides the rows.
    #[serde(default)]
    name: String,
    /// The table, where it is not the one of the figure.
    table: Option<String>,
    /// The column of abscissae.
    x: String,
    /// The column of ordinates.
    y: String,
    /// The column of standard errors; where it is the column that is drawn, the errors in its cells.
    error: Option<String>,
    /// The column with what a reader sees who points at a mark.
    note: Option<String>,
    /// The column with the abscissae of failed runs.
    failed: Option<String>,
    /// The look of the series of an index.
    #[serde(deserialize_with = "look_of_name")]
    look: LookOf,
    /// The index of the first series.
    #[serde(default, rename = "at")]
    first: usize,
    /// The column with the index of a series, in place of their order.
    index: Option<String>,
    /// The column that divides the rows.
    by: Option<String>,
    /// The rows that are drawn: columns with the values that they must have, as they are written.
    #[serde(default)]
    only: Only,
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
type Only = BTreeMap<String, Vec<String>>;

/// The looks by the names that a file has for them.
fn look_of_name<'de, D: Deserializer<'de>>(from: D) -> Result<LookOf, D::Error> {
    const LOOKS: [(&str, LookOf); 10] = [
        ("line", Look::line),
        ("marks", Look::marks),
        ("joined", Look::joined),
        ("disc", |_| Look::Points(Symbol::Disc)),
        ("ring", |_| Look::Points(Symbol::Ring)),
        ("solid", |_| Look::Line(Dash::Solid)),
        ("dashed", |_| Look::Line(Dash::Dashed)),
        ("dotted", |_| Look::Line(Dash::Dotted)),
        ("dotted discs", |_| Look::LineAndPoints(Dash::Dotted, Symbol::Disc)),
        ("dashed marks", |i| Look::LineAndPoints(Dash::Dashed, Symbol::cycle(i))),
    ];
    let name = String::deserialize(from)?;
    let look = LOOKS.iter().find(|(known, _)| *known == name);
    look.map(|(_, look)| *look).ok_or_else(|| D::Error::custom(format!("no look `{name}`")))
}

impl Columns {
    /// The first column that a table lacks.
    fn lacking(&self, table: &Table) -> Option<&str> {
        let options = [&self.error, &self.note, &self.failed, &self.index, &self.by];
        let named = options.into_iter().flatten().chain([&self.x, &self.y]).map(String::as_str);
        let mut all = named.chain(self.only.keys().map(String::as_str));
        all.find(|name| !table.columns.iter().any(|column| column.name == *name))
    }

    /// The series of a table; none where it lacks a column.
    fn series(&self, table: &Table) -> Option<Vec<Series>> {
        if self.lacking(table).is_some() {
            return None;
        }
        let numbers = |name: &Option<String>| table.numbers(name.as_deref()?);
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
fn takes(only: &Only, table: &Table, row: usize) -> bool {
    let has = |(column, values): (&String, &Vec<String>)| {
        value_of(table, column, row).is_some_and(|value| values.contains(&value))
    };
    only.iter().all(has)
}

/// The value of a cell, as it is written.
fn value_of(table: &Table, column: &str, row: usize) -> Option<String> {
    let column = table.columns.iter().find(|c| c.name == column)?;
    Some(match &column.cells.get(row)?.value {
        Value::Words(words) | Value::Figures(words) => words.clone(),
        number => number.number().to_string(),
    })
}

/// A line with neighbors averaged where there are more than can be seen.
pub(crate) fn thinned(points: Vec<Point>) -> Vec<Point> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Drawing;

    const PAGE: &str = r#"
        title = "T of {n}"
        lead = "{n} runs."
        [[figure]]
        name = "energy-{case}"
        title = "Energy, {case}"
        table = "runs"
        data = "all"
        each = "case"
        only = { drawn = ["yes"] }
        x = { label = "dt" }
        y = { label = "E", scale = "logarithmic", range = [0.1, 10.0] }
        guides = [{ horizontal = [1.0, "one"] }]
        series = [{ name = "by {}", x = "dt", y = "E", look = "joined", by = "method", index = "index", failed = "failed" }]
        caption = "Of {case}."
        [[section]]
        title = "S"
        blocks = [{ text = "Of {n}." }, { figures = ["energy-b", "energy-{case}"] }, { list = "all" }, { table = "runs" }]
        [[section]]
        title = "More"
        blocks = [{ text = "All else." }]
    "#;

    fn given() -> Given {
        let rows = [
            ("a", "m", 0.1, Some(1.0), "yes"),
            ("b", "m", 0.1, Some(2.0), "yes"),
            ("b", "m", 0.2, None, "yes"),
            ("b", "n", 0.1, Some(3.0), "no"),
        ];
        let table = Table::rows_of("runs", &rows)
            .column("case", |r| r.0)
            .column("method", |r| r.1)
            .column("dt [τ]", |r| r.2)
            .column("E", |r| r.3)
            .column("drawn", |r| r.4)
            .table()
            .and("index", [4.0; 4])
            .and("failed", rows.iter().map(|r| Some(r.2).filter(|_| r.3.is_none())));
        let lists = vec![("all", vec!["one".to_owned()])];
        Given { tables: vec![table], words: vec![("n", "3".to_owned())], lists }
    }

    #[test]
    fn a_page_has_its_words_and_a_figure_for_each_value_with_the_rows_that_are_chosen() {
        let page = written(PAGE, &given()).unwrap();
        assert_eq!((page.lead.as_str(), page.sections[0].blocks.len()), ("3 runs.", 4));
        assert_eq!(page.title, "T of 3");
        // The answer is open, all else is folded.
        assert_eq!(page.sections.iter().map(|s| s.folded).collect::<Vec<_>>(), [false, true]);
        let pictures: Vec<&Picture> = page.pictures().collect();
        let names: Vec<&str> = pictures.iter().map(|p| p.name()).collect();
        assert_eq!(names, ["energy-b", "energy-a", "energy-b"]);
        assert_eq!((pictures[0].data.as_str(), pictures[0].caption.as_str()), ("all.csv", "Of b."));
        let Drawing::Plot(figure) = &pictures[0].drawing else { panic!("a plot") };
        // The row of `n` is not drawn; the run without a number is a cross.
        let [series] = &figure.series[..] else { panic!("{:?}", figure.series) };
        assert_eq!((series.name.as_str(), series.color, series.points.len()), ("by m", 4, 1));
        assert_eq!(series.failures.iter().map(|f| f.x).collect::<Vec<_>>(), [0.2]);
    }

    #[test]
    fn what_a_page_names_and_is_not_there_is_an_error_that_names_it() {
        for (from, to, said) in [
            (
                "y = \"E\"",
                "y = \"F\"",
                "figure `energy-{case}`: the table `runs` has no column `F`",
            ),
            ("drawn = [", "drwan = [", "has no column `drwan`"),
            ("table = \"runs\" }]", "table = \"rums\" }]", "there is no table `rums`"),
            ("energy-b", "energy-c", "there is no figure `energy-c`"),
            ("list = \"all\"", "list = \"any\"", "there is no list `any`"),
            ("Of {n}.", "Of {m}.", "there is no word `m`"),
            ("look = \"joined\"", "look = \"jined\"", "no look `jined`"),
            ("scale =", "scael =", "unknown field `scael`"),
        ] {
            let text = PAGE.replacen(from, to, 1);
            assert_ne!(text, PAGE);
            let error = written(&text, &given()).unwrap_err().to_string();
            assert!(error.starts_with("the text of the page: ") && error.contains(said), "{error}");
        }
    }

    fn drawn(series: &str) -> Option<Figure> {
        let text = format!(
            "[[figure]]\nof = [\"dt\"]\nname = \"f\"\ntitle = \"\"\ntable = \"runs\"\nx = {{ label = \"\" }}\n\
             y = {{ label = \"\" }}\nseries = [{{ x = \"{{of}}\", {series} }}]\ncaption = [\"Of {{n}}\", \"all\"]"
        );
        let picture =
            pictures(&text, &|name| given().table(name).ok().cloned(), &[]).unwrap().pop()?;
        assert_eq!((picture.data.as_str(), picture.caption.as_str()), ("runs.csv", "all"));
        match picture.drawing {
            Drawing::Plot(figure) => Some(figure),
            _ => None,
        }
    }

    #[test]
    fn a_column_divides_the_rows_into_series_and_what_is_no_number_is_left_out() {
        let figure =
            drawn("y = \"E\", look = \"joined\", by = \"case\", name = \"case {}\"").unwrap();
        let series = |k: usize| (figure.series[k].name.as_str(), figure.series[k].points.len());
        assert_eq!([series(0), series(1)], [("case a", 1), ("case b", 2)]);
        assert_ne!(figure.series[0].color, figure.series[1].color);
        let one = drawn("y = \"E\", look = \"marks\", at = 3").unwrap();
        assert_eq!((one.series.len(), one.series[0].points.len(), one.series[0].color), (1, 3, 3));
        assert!(drawn("y = \"z\", look = \"line\"").is_none());
    }

    #[test]
    fn a_long_line_is_averaged_and_marks_are_not() {
        let numbers: Vec<f64> = (0..6000).map(f64::from).collect();
        let table = Table::new("t", "").with("x", "", numbers.clone()).with("y", "", numbers);
        let points = |look| {
            let text = format!("x = \"x\"\ny = \"y\"\nlook = \"{look}\"");
            toml::from_str::<Columns>(&text).unwrap().series(&table).unwrap()[0].points.len()
        };
        assert_eq!(points("line"), 600);
        assert_eq!(points("marks"), 6000);
    }
}
