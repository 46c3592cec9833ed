//! Runs beside each other for a reader: tables of at most 100 columns, and curves drawn together.

use lennard_observables::quantities::{Quantity, quantity_of};
use lennard_observables::{Cell, Column, Table, Value, Verdict};

use super::beside::{Beside, ERRORS, MOST_COLUMNS, Measured};
use super::{Row, capital, quantity_words};
use crate::report::{
    Axis, Block, Figure, Look, Page, Picture, Point, Section, Series, counted, particles, thinned,
};
use crate::{Study, StudyError};

/// Quantities of a table with a row for each run: more do not fit into 100 columns.
const QUANTITIES_OF_A_TABLE: usize = 4;

/// A table of a run, the columns that are drawn, and words for what they show.
type Curve = (&'static str, [&'static str; 2], &'static str);

/// The first run that has a column, its heading, and the cell of a row.
type Part = (usize, &'static str, fn(&Row) -> Cell);

const CURVES: [Curve; 5] = [
    ("rdf", ["r", "g"], "radial distribution function g(r)"),
    ("msd", ["time", "msd"], "mean-square displacement"),
    ("measured", ["time", "temperature"], "temperature"),
    ("measured", ["time", "potential_energy"], "potential energy"),
    ("measured", ["time", "pressure"], "pressure"),
];

impl Study for Beside {
    const JSON: &'static str = "compare.json";

    fn tables(&self) -> Vec<Table> {
        let all: Vec<&Measured> = self.quantities.iter().collect();
        let curves = (0..self.names.len()).flat_map(|k| {
            let table =
                move |name: &str| self.folders[k].table(name).map(|t| (numbered(name, k), t));
            ["rdf", "msd", "measured"].into_iter().filter_map(table)
        });
        let curves = curves.map(|(name, table)| Table { name, ..table });
        std::iter::once(self.a_column_for_each(&all))
            .chain(self.own_table())
            .chain(curves)
            .collect()
    }

    fn page(&self) -> Result<Page, StudyError> {
        let mut sections = self.sections(false);
        // The lead has the headline.
        for section in &mut sections {
            section.blocks.retain(|block| !matches!(block, Block::Heading(_)));
        }
        let pictures = CURVES.iter().filter_map(|curve| self.picture(*curve)).collect();
        sections.insert(sections.len().min(1), Section::new("Drawn together").figures(pictures));
        Ok(Page {
            title: format!("{} side by side", counted(self.runs.len(), "run")),
            lead: format!(
                "{} Each verdict is on the difference from the first run, {}. Reduced units throughout (ε = σ = m = k_B = 1).",
                self.headline, self.names[0]
            ),
            sections,
            provenance: vec![
                ("version".into(), env!("CARGO_PKG_VERSION").into()),
                ("numbers".into(), "`compare.json` and the CSV files beside this page".into()),
            ],
            ..Page::default()
        })
    }
}

impl Beside {
    /// What a page and a terminal say: a user's own literature, the quantities of all runs, and how to read them. With `all` these
    /// are all quantities.
    #[must_use]
    pub fn sections(&self, all: bool) -> Vec<Section> {
        let mut sections = Vec::new();
        if let Some(table) = self.own_table() {
            let notes =
                self.own.iter().map(|own| format!("line {}: {}", own.given.line, own.row.remark));
            let rows = self.own.iter().map(|own| &own.row);
            let section = Section::new("Beside your own literature").table(table);
            sections.push(section.texts(notes).texts(meanings(rows)));
        }
        if let (Some(first), others) = (self.without_a_run.first(), self.without_a_run.len()) {
            sections.push(Section::new("").text(format!(
                "No run has measured {others} of the values at their T and ρ (within 0.5 %). The first is in line {}: {} at T = {}.",
                first.line, quantity_words(&first.quantity), first.temperature
            )));
        }
        let shown: Vec<&Measured> = self.quantities.iter().filter(|q| all || q.primary).collect();
        if shown.is_empty() {
            return sections;
        }
        let tables: Vec<Table> = match self.runs.len() <= MOST_COLUMNS {
            true => vec![self.a_column_for_each(&shown)],
            false => {
                shown.chunks(QUANTITIES_OF_A_TABLE).map(|some| self.a_row_for_each(some)).collect()
            }
        };
        let mut section = tables.into_iter().fold(Section::new("Side by side"), Section::table);
        if !self.headline.is_empty() {
            section = section.heading(&self.headline);
        }
        let runs = self.names.iter().zip(&self.runs).map(|(name, run)| {
            let of = particles(run.atoms as usize, run.molecules as usize);
            format!(
                "{name}: {}, {of}, {} measured steps, {}, {}",
                run.run,
                run.measured_steps,
                run.state.in_numbers(),
                run.model
            )
        });
        let first = &self.names[0];
        let reading = format!(
            "Differences and verdicts are from the first run, {first}, and not from the literature: `lennard compare {}` says that. In brackets or after ± \
             is one standard error. Allowed are {ERRORS} standard errors of the difference, which takes the runs for independent.",
            self.runs[0].run
        );
        let hidden = self.quantities.len() - shown.len();
        sections.push(
            section
                .texts(&self.remarks)
                .text(reading)
                .texts(meanings(shown.iter().flat_map(|q| q.rows.iter().flatten())))
                .texts((hidden > 0).then(|| {
                    format!("{hidden} more quantities: --verbose, and compare.csv of the page")
                }))
                .list(runs.collect()),
        );
        sections
    }

    /// The means of all runs, the differences of the other runs from the first, and the verdicts, each with its name.
    fn a_column_for_each(&self, shown: &[&Measured]) -> Table {
        let mut table = Table::rows_of("compare", shown).column("Quantity", |q| words(q)).table();
        let first: &str = if self.names.len() <= MOST_COLUMNS { &self.names[0] } else { "first" };
        let parts: [Part; 3] =
            [(0, "{}", mean), (1, "{} − {first}", difference), (1, "Verdict on {}", verdict)];
        for (from, heading, cell) in parts {
            for (k, name) in self.names.iter().enumerate().skip(from) {
                let heading = heading.replace("{first}", first).replace("{}", name);
                let of_run = shown.iter().map(|q| q.rows[k].as_ref());
                let cells = of_run.map(|row| row.map_or_else(Cell::default, cell)).collect();
                let has_errors = !heading.starts_with("Verdict");
                table.columns.push(Column { has_errors, cells, ..Column::new(heading, "") });
            }
        }
        table
    }

    /// The same with a row for each run, difference and verdict, but for differences that nothing has.
    fn a_row_for_each(&self, shown: &[&Measured]) -> Table {
        let mut columns = self.a_column_for_each(shown).columns;
        columns.retain(|column| column.cells.iter().any(|cell| cell.value != Value::Missing));
        let mut table = Table::rows_of("runs", &columns[1..]).column("Run", |c| &c.name).table();
        for (row, quantity) in shown.iter().enumerate() {
            let cells = columns[1..].iter().map(|column| column.cells[row].clone()).collect();
            table.columns.push(Column { cells, ..Column::new(words(quantity), "") });
        }
        table
    }

    /// Runs beside values of a user's own; `None` where there is no such value.
    fn own_table(&self) -> Option<Table> {
        let table = Table::rows_of("own_literature", &self.own)
            .column("Run", |own| self.names[own.run].as_str())
            .column("Quantity", |own| quantity_words(&own.row.quantity))
            .measured("Measured", |own| Some(own.row.mean()))
            .measured("Yours", |own| Some((own.given.value, own.given.error.unwrap_or(f64::NAN))))
            .measured("Difference", |own| own.row.off())
            .column("Verdict", |own| verdict(&own.row))
            .column("Source", |own| own.given.source.as_str());
        (!self.own.is_empty()).then(|| table.table())
    }

    /// One curve of all runs that have it.
    fn picture(&self, (table, [x, y], words): Curve) -> Option<Picture> {
        let axis = |name: &str| match table {
            "msd" => Axis::logarithmic(name),
            _ => Axis::linear(name),
        };
        let label = if table == "msd" { "⟨Δr²⟩ / σ²" } else { words };
        let curve = |k: usize| {
            let table = self.folders[k].table(table)?;
            let points = table.numbers(x)?.into_iter().zip(table.numbers(y)?);
            let is_finite = |(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
            let points = thinned(points.filter(is_finite).map(Point::from).collect());
            Some(Series::new(&self.names[k], Look::line(k), k, points))
        };
        let first = curve(0)?;
        let figure = Figure {
            series: std::iter::once(first).chain((1..self.names.len()).filter_map(curve)).collect(),
            ..Figure::new(
                y,
                capital(words),
                axis(if x == "r" { "r / σ" } else { "time / τ" }),
                axis(&quantity_of(y).map_or_else(|| label.to_owned(), Quantity::axis)),
            )
        };
        let file = format!("{}.csv", numbered(table, 0));
        (!figure.is_empty()).then(|| Picture::new(figure, "", file))
    }
}

/// A quantity with its unit, per particle or not.
fn words(quantity: &Measured) -> String {
    let words = quantity_words(&quantity.quantity);
    match quantity.unit.split(" per ").next().unwrap_or_default() {
        "" => words,
        unit => format!("{words}, {unit}"),
    }
}

/// File stem of a table of the `k`-th run.
fn numbered(table: &str, k: usize) -> String {
    format!("{table}-{}", k + 1)
}

fn mean(row: &Row) -> Cell {
    row.mean().into()
}

fn difference(row: &Row) -> Cell {
    row.off().map_or_else(Cell::default, |(off, error)| Cell::measured(off, error))
}

fn verdict(row: &Row) -> Cell {
    Cell::words(row.verdict.words()).toned(row.verdict.tone())
}

/// What the verdicts of a table mean, each once.
pub fn meanings<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<String> {
    let found: Vec<Verdict> = rows.map(|row| row.verdict).collect();
    let plain = [Verdict::Agrees, Verdict::NoReference];
    let shown = Verdict::ALL.into_iter().filter(|v| found.contains(v) && !plain.contains(v));
    shown.map(|v| format!("{}: {}", v.words(), v.meaning())).collect()
}
