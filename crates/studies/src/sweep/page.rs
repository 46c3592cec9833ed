//! The table and the page of a sweep.

use lennard_report::{
    Axis, Block, Cell, Figure, Guide, Look, Page, PageFigure, PageTable, Point, ReportError,
    Section, Series, Symbol, Tone, significant, with_error,
};

use super::{Agreement, SweepRecord, probability_words};
use crate::compare::{Row, Verdict, quantity_words};

/// The points with U, P and c_v beside the equation of state, as CSV.
pub(super) fn csv(record: &SweepRecord) -> String {
    let mut text = String::from(
        "name,density,temperature,temperature_whole_steps,temperature_half_steps,phase,steps,atoms",
    );
    const QUANTITIES: [(&str, &str); 3] = [
        ("potential_energy", "u"),
        ("pressure", "p"),
        ("heat_capacity", "cv"),
    ];
    for (_, short) in QUANTITIES {
        text += &format!(
            ",{short},{short}_se,{short}_reference,{short}_difference,{short}_difference_se,{short}_verdict"
        );
    }
    text.push('\n');
    for point in &record.points {
        let state = point.compared.as_ref().map_or(&point.planned, |c| &c.state);
        let (steps, atoms) = point
            .compared
            .as_ref()
            .map_or((0, 0), |c| (c.measured_steps, c.atoms));
        let phase = state.phase.map_or("unknown", |p| p.describe());
        let mean = |quantity: &str| {
            point
                .row(quantity)
                .map_or(String::new(), |r| r.measured.to_string())
        };
        text += &format!(
            "{},{},{},{},{},\"{phase}\",{steps},{atoms}",
            point.name,
            state.density,
            state.temperature,
            mean("temperature"),
            mean("temperature_half_steps"),
        );
        for (quantity, _) in QUANTITIES {
            match point.row(quantity) {
                None => text += ",,,,,,",
                Some(r) => {
                    let optional = |x: Option<f64>| x.map(|x| x.to_string()).unwrap_or_default();
                    text += &format!(
                        ",{},{},{},{},{},{}",
                        r.measured,
                        r.standard_error,
                        optional(r.reference),
                        optional(r.difference),
                        optional(r.combined_error),
                        r.verdict.words()
                    );
                }
            }
        }
        text.push('\n');
    }
    text
}

/// The page of a sweep.
pub(super) fn page(record: &SweepRecord, command: &str) -> Result<Page, ReportError> {
    let finished = record
        .points
        .iter()
        .filter(|p| p.compared.is_some())
        .count();
    let mut page = Page {
        title: format!("Sweep {}", record.name),
        lead: format!(
            "{finished} of {} points are finished. Each is compared with the equation of state that describes its model, at the measured \
             temperature that belongs to its positions (of half steps where the method has them) and for as many particles in a closed box; the error of a difference counts that U, P and T fluctuate together.",
            record.points.len()
        ),
        sections: Vec::new(),
        provenance: vec![
            ("command".into(), format!("`{command}`")),
            ("version".into(), record.version.into()),
            ("processor".into(), record.cpu.clone()),
            (
                "threads for all points together".into(),
                record.threads.to_string(),
            ),
        ],
    };
    page.sections.push(together(record));
    let mut figures = Vec::new();
    for (quantity, title, unit) in [
        (
            "potential_energy",
            "Potential energy: measured − equation of state",
            "ΔU / ε",
        ),
        (
            "pressure",
            "Pressure: measured − equation of state",
            "ΔP / (ε/σ³)",
        ),
    ] {
        if let Some(figure) = differences(record, quantity, title, unit) {
            figures.push(PageFigure {
                svg: figure.to_svg()?,
                caption: "Bars are one standard error of the difference. Points that are no single stable phase are shown as open marks and \
                          are not judged."
                    .into(),
                command: None,
                data: Some("table.csv".into()),
            });
        }
    }
    let mut points = Section::new("Points");
    if !figures.is_empty() {
        points = points.with(Block::Figures(figures));
    }
    page.sections.push(points.with(Block::Table(table(record))));
    let remarks = remarks(record);
    if !remarks.is_empty() {
        page.sections
            .push(Section::new("Remarks").with(Block::List(remarks)));
    }
    Ok(page)
}

fn differences(record: &SweepRecord, quantity: &str, title: &str, unit: &str) -> Option<Figure> {
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
                    ..Point::default()
                })
            })
            .collect()
    };
    let (judged, others) = (marks(true), marks(false));
    if judged.is_empty() && others.is_empty() {
        return None;
    }
    let mut figure = Figure::new(
        quantity,
        title,
        Axis::linear("density ρ / σ⁻³"),
        Axis::linear(unit),
    )
    .guided(Guide::Horizontal(0.0, String::new()));
    for (name, points, symbol, color) in [
        ("single phase", judged, Symbol::Disc, 0),
        ("not judged", others, Symbol::Ring, 1),
    ] {
        if !points.is_empty() {
            figure = figure.with(Series::from_points(
                name,
                Look::Points(symbol),
                color,
                points,
            ));
        }
    }
    Some(figure)
}

fn together(record: &SweepRecord) -> Section {
    let header = [
        "Quantity",
        "Points judged",
        "Agree",
        "Mean difference",
        "Largest",
        "Largest standard error",
        "χ²",
        "p",
        "χ² with the equation's own uncertainty",
        "p",
    ];
    let line = |a: &Agreement| {
        vec![
            Cell::text(quantity_words(&a.quantity)),
            Cell::number(a.points.to_string()),
            Cell::toned(
                a.agree.to_string(),
                if a.agree == a.points {
                    Tone::Good
                } else {
                    Tone::Careful
                },
            ),
            Cell::number(significant(a.mean_difference, 3)),
            Cell::number(significant(a.largest_difference, 3)),
            Cell::number(significant(a.largest_standard_error, 2)),
            Cell::number(significant(a.chi_squared, 4)),
            Cell::number(probability_words(a.p_value)),
            Cell::number(significant(a.chi_squared_with_reference, 4)),
            Cell::number(probability_words(a.p_value_with_reference)),
        ]
    };
    let section = Section::new("All points together");
    if record.agreement.is_empty() {
        return section.text("No point is judged: see the table.");
    }
    section.with(Block::Table(PageTable {
        caption: "Differences of all points that are single stable phases. p is the probability of a χ² at least so large: first were the \
                  equation exact, then were it off at random by its own uncertainty."
            .into(),
        command: None,
        header: header.map(str::to_owned).to_vec(),
        rows: record.agreement.iter().map(line).collect(),
    }))
}

fn table(record: &SweepRecord) -> PageTable {
    let header = [
        "Point",
        "T, whole steps",
        "T, half steps",
        "U / ε",
        "U − equation",
        "P / (ε/σ³)",
        "P − equation",
        "c_v / k_B",
        "c_v − equation",
        "State",
    ];
    let rows = record
        .points
        .iter()
        .map(|point| {
            let Some(compared) = &point.compared else {
                let why = point
                    .failure
                    .clone()
                    .unwrap_or_else(|| "not finished".into());
                let first = why.lines().next().unwrap_or_default().to_owned();
                let mut cells = vec![
                    Cell::text(point.name.clone()),
                    Cell::number(point.planned.temperature.to_string()),
                    Cell::default(),
                    Cell::toned(first, Tone::Bad),
                ];
                cells.resize(header.len(), Cell::default());
                return cells;
            };
            let state = &compared.state;
            let mut cells = vec![Cell::text(point.name.clone())];
            for quantity in ["temperature", "temperature_half_steps"] {
                let mean = point.row(quantity).map(|r| r.measured);
                cells.push(Cell::number(mean.map_or("–".into(), |t| significant(t, 5))));
            }
            for quantity in ["potential_energy", "pressure", "heat_capacity"] {
                let r = point.row(quantity);
                cells.push(Cell::number(r.map_or("–".into(), |r| {
                    with_error(r.measured, r.standard_error)
                })));
                let difference =
                    r.and_then(|r| Some((with_error(r.difference?, r.combined_error?), tone(r))));
                cells.push(
                    difference
                        .map_or_else(|| Cell::number("–"), |(text, tone)| Cell::toned(text, tone)),
                );
            }
            let careful = if state.is_single_stable_phase() {
                Tone::Plain
            } else {
                Tone::Careful
            };
            cells.push(Cell::toned(state.words.clone(), careful));
            cells
        })
        .collect();
    PageTable {
        caption: "Digits in brackets are one standard error in the last digits. Differences in green agree, in red they do not; in brown they are as large as the predicted bias of a short \
                  cutoff.".into(),
        command: None,
        header: header.map(str::to_owned).to_vec(),
        rows,
    }
}

/// A verdict as a cell of a table.
pub(crate) fn verdict_cell(row: &Row) -> Cell {
    Cell::toned(row.verdict_words(), tone(row))
}

fn tone(row: &Row) -> Tone {
    match row.verdict {
        Verdict::Agrees => Tone::Good,
        Verdict::Differs => Tone::Bad,
        Verdict::PredictedBias
        | Verdict::NotInEquilibrium
        | Verdict::TooShort
        | Verdict::Incomplete
        | Verdict::Thermostat => Tone::Careful,
        Verdict::NoReference => Tone::Plain,
    }
}

/// Remarks of all points, each once, with how many points they belong to.
fn remarks(record: &SweepRecord) -> Vec<String> {
    let mut counted: Vec<(String, usize)> = Vec::new();
    for remark in record
        .points
        .iter()
        .filter_map(|p| p.compared.as_ref())
        .flat_map(|c| &c.remarks)
    {
        match counted.iter_mut().find(|(text, _)| text == remark) {
            Some((_, n)) => *n += 1,
            None => counted.push((remark.clone(), 1)),
        }
    }
    counted
        .into_iter()
        .map(|(text, n)| {
            if n > 1 {
                format!("{text} ({n} points)")
            } else {
                text
            }
        })
        .chain(
            record
                .points
                .iter()
                .filter_map(|p| Some(format!("{}: {}", p.name, p.failure.as_ref()?))),
        )
        .collect()
}
