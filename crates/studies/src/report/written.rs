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
//! caption = "RMS of the energy on the same run."
//!
//! [[section]]
//! title = "A bond held in each way"
//! blocks = [
//!     { text = "Two dumbbells meet and part." },         # or heading, remark, equations; list of a name
//!     { figures = ["ways-energy"] },
//!     { table = "ways-in-a-line" },
//! ]
//! ```

use lennard_observables::{Cell, Column, Table};
use serde::Deserialize;

use super::row::{Only, takes, value_of};
use crate::lists::grouped;
use crate::report::{Axis, Block, Columns, FigureRow, Guide, Page, Picture, ReportError, Section};

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
    title: String,
    lead: String,
    figure: Vec<FigureText>,
    section: Vec<SectionText>,
}

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
    series: Vec<Columns<'static>>,
    caption: String,
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

/// A text with words in the place of their names in braces.
pub(crate) fn filled<N: AsRef<str>>(text: &str, words: &[(N, String)]) -> String {
    let fill = |text: String, (name, word): &(N, String)| {
        text.replace(&format!("{{{}}}", name.as_ref()), word)
    };
    words.iter().fold(text.to_owned(), fill)
}

/// The page of a text.
///
/// # Errors
/// [`ReportError::Text`] where the text is no page, or names a figure, a table, a column or a word that is not there.
pub(crate) fn written(text: &str, given: &Given) -> Result<Page, ReportError> {
    let text: PageText = toml::from_str(text).map_err(|e| ReportError::Text(e.to_string()))?;
    let mut pictures = Vec::new();
    for figure in &text.figure {
        let drawn = figure.drawn(given)?;
        pictures.push((figure.name.as_str(), drawn));
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
    fn of(self, given: &Given, pictures: &[(&str, Vec<Picture>)]) -> Result<Block, ReportError> {
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
    /// The figure, or one for each value of the column that it names; none where its columns are empty.
    fn drawn(&self, given: &Given) -> Result<Vec<Picture>, ReportError> {
        let table = given.table(&self.table)?;
        for columns in self.columns(&self.only) {
            let table = given.table(columns.table.as_deref().unwrap_or(&self.table))?;
            if let Some(column) = columns.lacking(table) {
                let (name, table) = (&self.name, &table.name);
                let text = format!("figure `{name}`: the table `{table}` has no column `{column}`");
                return Err(ReportError::Text(text));
            }
        }
        let Some(each) = &self.each else {
            return Ok(self.picture(given, &self.only, &[]).into_iter().collect());
        };
        let mut only = self.only.clone();
        let rows = (0..table.rows()).filter(|row| takes(&self.only, table, *row));
        let values = grouped(rows.filter_map(|row| Some((value_of(table, each, row)?, row))));
        let pictures = values.into_iter().filter_map(|(value, rows)| {
            only.insert(each.clone(), vec![value]);
            let named = |name: &str| Some((name.to_owned(), value_of(table, name, rows[0])?));
            let words: Vec<_> = table.columns.iter().filter_map(|c| named(&c.name)).collect();
            self.picture(given, &only, &words)
        });
        Ok(pictures.collect())
    }

    /// What is drawn, of these rows of the table of the figure.
    fn columns(&self, only: &Only) -> Vec<Columns<'static>> {
        let mut all = self.series.clone();
        for columns in all.iter_mut().filter(|columns| columns.table.is_none()) {
            columns.only.extend(only.clone());
        }
        all
    }

    fn picture(&self, given: &Given, only: &Only, words: &[(String, String)]) -> Option<Picture> {
        let data = self.data.as_ref().unwrap_or(&self.table);
        let [name, title, data] = [&self.name, &self.title, data].map(|text| filled(text, words));
        let row = FigureRow {
            name: &name,
            title: &title,
            x: self.x.clone(),
            y: self.y.clone(),
            table: &self.table,
            columns: self.columns(only),
            theory: Vec::new(),
            guides: self.guides.clone(),
            caption: filled(&self.caption, words),
        };
        let picture = row.draw(|name| given.table(name).ok().cloned())?;
        Some(Picture { data: format!("{data}.csv"), ..picture })
    }
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
}
