//! The tables and the page of a sweep.

use crate::report::{Axis, Figure, Look, Page, Picture, Point, Section, Series, Symbol};
use lennard_core::{Cell, Table, Tone};

use super::equations::{self, Judgement};
use super::figures::Pictures;
use super::point_table::{Kind, point_table, second_temperature, state};
use super::{SweepRecord, SweptPoint, probability_words};
use crate::compare::{ComparedRun, Row, quantity_words};

/// The quantities of a sweep with their short names.
const QUANTITIES: [(&str, &str); 3] =
    [("potential_energy", "u"), ("pressure", "p"), ("heat_capacity", "cv")];

/// The points with U, P and c_v beside the equation of state, as CSV.
pub(super) fn csv(record: &SweepRecord) -> Table {
    let compared =
        |p: &SweptPoint, number: fn(&ComparedRun) -> u64| p.compared.as_ref().map_or(0, number);
    let mean = |p: &SweptPoint, quantity: &str| p.row(quantity).map(|r| r.measured);
    let mut table = Table::rows_of("table", &record.points)
        .column("name", |p| &p.name)
        .column("density", |p| state(p).density)
        .column("temperature", |p| state(p).temperature)
        .column("temperature_whole_steps", |p| mean(p, "temperature"))
        .column("temperature_half_steps", |p| mean(p, "temperature_half_steps"))
        .column("phase", |p| state(p).phase.map_or("unknown", |p| p.describe()))
        .column("steps", |p| compared(p, |c| c.measured_steps))
        .column("atoms", |p| compared(p, |c| c.atoms));
    for (quantity, short) in QUANTITIES {
        let of = |p: &SweptPoint, number: fn(&Row) -> Option<f64>| p.row(quantity).and_then(number);
        table = table
            .column(short, |p| mean(p, quantity))
            .column(&format!("{short}_se"), |p| of(p, |r| Some(r.standard_error)))
            .column(&format!("{short}_reference"), |p| of(p, |r| r.reference))
            .column(&format!("{short}_difference"), |p| of(p, |r| r.difference))
            .column(&format!("{short}_difference_se"), |p| of(p, |r| r.combined_error))
            .column(&format!("{short}_verdict"), |p| p.row(quantity).map(|r| r.verdict.words()));
    }
    for quantity in others(record) {
        table = table
            .column(&quantity, |p| mean(p, &quantity))
            .column(&format!("{quantity}_se"), |p| p.row(&quantity).map(|r| r.standard_error));
        let reference = |p: &SweptPoint| p.row(&quantity).and_then(|r| r.reference);
        if record.points.iter().any(|p| reference(p).is_some()) {
            table = table
                .column(&format!("{quantity}_reference"), reference)
                .column(&format!("{quantity}_verdict"), |p| {
                    p.row(&quantity).map(|r| r.verdict.words())
                });
        }
    }
    table.table()
}

/// Every other quantity that any point has measured.
fn others(record: &SweepRecord) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let rows = record.points.iter().filter_map(|p| p.compared.as_ref());
    for row in rows.flat_map(|c| &c.rows) {
        let has_columns = QUANTITIES.iter().any(|(q, _)| *q == row.quantity)
            || row.quantity == "density"
            || row.quantity.starts_with("temperature");
        if !has_columns && !names.contains(&row.quantity) {
            names.push(row.quantity.clone());
        }
    }
    names
}

/// The table of points with a link from each name to its page.
fn linked(mut table: Table, record: &SweepRecord) -> Table {
    if let Some(names) = table.columns.first_mut() {
        for (cell, point) in names.cells.iter_mut().zip(&record.points) {
            if let Some(page) = &point.page {
                *cell = Cell::words(format!("[{}]({page})", point.name)).toned(cell.tone);
            }
        }
    }
    table
}

/// The page of a sweep.
pub(super) fn page(
    record: &SweepRecord,
    command: &str,
    pictures: Pictures,
    judgements: &[Judgement],
) -> Page {
    let kind = Kind::of(&record.points);
    let finished = record.points.iter().filter(|p| p.compared.is_some()).count();
    let together = match record.agreement.is_empty() {
        true => Section::new(TOGETHER).text("No point is judged: see the table."),
        false => Section::new(TOGETHER).table(agreement_table(record)),
    };
    let figures = [
        ("potential_energy", "Potential energy: measured − equation of state", "ΔU / ε"),
        ("pressure", "Pressure: measured − equation of state", "ΔP / (ε/σ³)"),
    ];
    let drawn = figures
        .into_iter()
        .filter_map(|(quantity, title, unit)| differences(record, quantity, title, unit));
    let points = Section::new("Points")
        .figures(pictures.together.into_iter().chain(drawn).collect())
        .table(narrow(linked(point_table(record), record), record));
    let mut sections = match kind {
        Kind::Fluids => vec![together, points],
        Kind::Slabs | Kind::Crystals => vec![points],
    };
    if !judgements.is_empty() {
        let table = equations::table(judgements, quantity_words);
        sections.push(Section::new("Equations beside the points").table(table));
    }
    if !pictures.properties.is_empty() {
        sections.push(Section::new("Each property").figures(pictures.properties));
    }
    let remarks = remarks(record);
    if !remarks.is_empty() {
        sections.push(Section::new("Remarks").list(remarks));
    }
    Page {
        title: format!("Sweep {}", record.name),
        lead: format!(
            "{finished} of {} points are finished. {}",
            record.points.len(),
            kind.in_words()
        ),
        command: None,
        sections,
        provenance: vec![
            ("command".into(), format!("`{command}`")),
            ("version".into(), record.version.into()),
            ("processor".into(), record.cpu.clone()),
            ("threads for all points together".into(), record.threads.to_string()),
        ],
    }
}

const TOGETHER: &str = "All points together";

/// Without columns that say nothing here, so that the verdicts are in view.
fn narrow(mut table: Table, record: &SweepRecord) -> Table {
    if let Some(column) = second_temperature(&record.points) {
        table = table.without(&[column]);
    }
    let is_there = table.columns.iter().any(|column| column.name == "State");
    let shown = record.points.iter().filter(|_| is_there);
    let mut states = shown.map(|p| state(p).words.as_str());
    if let Some(first) = states.next().filter(|first| states.all(|s| s == *first)) {
        table.caption += &format!(" State of all points: {first}.");
        table = table.without(&["State"]);
    }
    table
}

fn differences(record: &SweepRecord, quantity: &str, title: &str, unit: &str) -> Option<Picture> {
    let marks = |judged: bool| -> Vec<Point> {
        record
            .points
            .iter()
            .filter_map(|point| {
                let r = point.row(quantity)?;
                let state = &point.compared.as_ref()?.state;
                let is_judged = state.is_single_stable_phase();
                (is_judged == judged).then_some(Point {
                    x: state.density,
                    y: r.difference?,
                    error: r.combined_error,
                    note: Some(format!(
                        "{}: T = {:.4}, {}",
                        point.name, state.temperature, state.words
                    )),
                    link: point.page.clone(),
                    ..Point::default()
                })
            })
            .collect()
    };
    let (judged, others) = (marks(true), marks(false));
    if judged.is_empty() && others.is_empty() {
        return None;
    }
    let mut figure =
        Figure::new(quantity, title, Axis::linear("density ρ / σ⁻³"), Axis::linear(unit))
            .level(0.0, "");
    for (name, points, symbol, color) in
        [("single phase", judged, Symbol::Disc, 0), ("not judged", others, Symbol::Ring, 1)]
    {
        if !points.is_empty() {
            figure = figure.with(Series::new(name, Look::Points(symbol), color, points));
        }
    }
    let caption = "Bars are one standard error of the difference. Points that are no single stable phase are shown as open marks and \
                   are not judged.";
    Some(Picture::new(figure, caption, "table.csv"))
}

/// The differences of all points together, quantity by quantity.
#[must_use]
pub fn agreement_table(record: &SweepRecord) -> Table {
    let caption = "Differences of all points that are single stable phases. p is the probability of a χ² at least so large: first were the \
                   equation exact, then were it off at random by its own uncertainty.";
    Table::rows_of("agreement", &record.agreement)
        .caption(caption)
        .column("Quantity", |a| quantity_words(&a.quantity))
        .column("Points judged", |a| a.points)
        .column("Agree", |a| {
            let all = a.agree == a.points;
            Cell::from(a.agree).toned(if all { Tone::Good } else { Tone::Careful })
        })
        .column("Too coarse to tell", |a| a.too_coarse)
        .column("Mean difference", |a| Cell::rounded(a.mean_difference, 3))
        .column("Largest", |a| Cell::rounded(a.largest_difference, 3))
        .column("Largest standard error", |a| Cell::rounded(a.largest_standard_error, 2))
        .column(CHI_SQUARED[0], |a| Cell::rounded(a.chi_squared, 4))
        .column("p", |a| Cell::figures(probability_words(a.p_value)))
        .column(CHI_SQUARED[1], |a| Cell::rounded(a.chi_squared_with_reference, 4))
        .column("p with the equation's own uncertainty", |a| {
            Cell::figures(probability_words(a.p_value_with_reference))
        })
        .table()
}

/// The columns of [`agreement_table`] that p already says.
pub const CHI_SQUARED: [&str; 2] = ["χ²", "χ² with the equation's own uncertainty"];

/// Remarks of all points, each once, with how many points they belong to.
fn remarks(record: &SweepRecord) -> Vec<String> {
    let mut counted: Vec<(String, usize)> = Vec::new();
    for remark in record.points.iter().filter_map(|p| p.compared.as_ref()).flat_map(|c| &c.remarks)
    {
        match counted.iter_mut().find(|(text, _)| text == remark) {
            Some((_, n)) => *n += 1,
            None => counted.push((remark.clone(), 1)),
        }
    }
    counted
        .into_iter()
        .map(|(text, n)| if n > 1 { format!("{text} ({n} points)") } else { text })
        .chain(
            record
                .points
                .iter()
                .filter_map(|p| Some(format!("{}: {}", p.name, p.failure.as_ref()?.reason))),
        )
        .collect()
}
