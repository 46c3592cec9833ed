//! Every point with its results: a table by what the points are, and each property against what the study changes.

use lennard_observables::quantities::{Quantity, quantity_of};
use lennard_observables::{Cell, Table, Tone, Value};

use super::blocks::{Blocks, POINTS, PROPERTIES};
use super::properties;
use crate::compare::{Row, Verdict, capital};
use crate::lists::grouped;
use crate::report::Section;
use crate::sweep::StudyPoints;
use crate::sweep::SweptPoint;

/// The table of the points, and a figure for each property.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    let points = study.swept;
    let table = narrow(linked(of_points(points), points), points);
    let mut sections = vec![Section::new(POINTS).table(table)];
    let figures = properties::pictures(study);
    if !figures.is_empty() {
        sections.push(Section::new(PROPERTIES).figures(figures));
    }
    let lead = Kind::of(points).in_words.to_owned();
    Blocks {
        lead,
        sections,
        terminal: vec![for_terminal(points)],
        sentences: vec!["Digits in brackets are one standard error in the last digits.".into()],
        ..Blocks::default()
    }
}

/// What the points of a sweep are.
#[derive(Debug)]
pub(super) struct Kind {
    /// The quantity that points of this kind alone measure; `None` for all others.
    sign: Option<&'static str>,
    /// The keys of the quantities of the table.
    keys: &'static [&'static str],
    /// What a difference is taken from; `None` where nothing is judged.
    reference: Option<&'static str>,
    /// What the points are, and what they stand beside.
    in_words: &'static str,
}

/// Slabs of liquid beside their vapor.
const SLABS: Kind = Kind {
    sign: Some("liquid_density"),
    keys: &["liquid_density", "vapor_density", "vapor_pressure", "surface_tension"],
    reference: Some("literature"),
    in_words: "Each is a slab of liquid beside its vapor. It is compared with two coexisting phases of its model at the measured \
               temperature.",
};
/// Crystals beside their liquid.
const CRYSTALS: Kind = Kind {
    sign: Some("front_velocity"),
    keys: &["front_velocity", "solid_share", "pressure"],
    reference: None,
    in_words: "Each is a crystal beside its liquid. The velocity of a front is positive where the crystal grows.",
};
/// Homogeneous fluids, or anything else that one equation of state may describe.
const FLUIDS: Kind = Kind {
    sign: None,
    keys: &["potential_energy", "pressure", "heat_capacity"],
    reference: Some("equation"),
    in_words: "Each is compared with the equation of state that describes its model, at the measured temperature that belongs to its \
               positions (of half steps where the method has them) and for as many particles in a closed box; the error of a \
               difference counts that U, P and T fluctuate together.",
};

impl Kind {
    /// What the points are, by what any of them has measured.
    pub(super) fn of(points: &[SweptPoint]) -> &'static Self {
        let measured = |quantity: &str| points.iter().any(|p| p.row(quantity).is_some());
        let mut with_sign = [&SLABS, &CRYSTALS].into_iter();
        with_sign.find(|kind| kind.sign.is_some_and(measured)).unwrap_or(&FLUIDS)
    }

    /// Whether one equation of state may describe the points.
    pub(super) fn is_homogeneous(&self) -> bool {
        self.sign.is_none()
    }

    /// The quantities of the table.
    fn quantities(&self) -> impl Iterator<Item = &'static Quantity> {
        self.keys.iter().filter_map(|key| quantity_of(key))
    }

    /// The heading of the difference of a quantity from its reference.
    fn difference(&self, quantity: &Quantity) -> Option<String> {
        Some(format!("{} − {}", heading(quantity), self.reference?))
    }
}

/// The heading of a quantity: its letter, or its words.
fn heading(quantity: &Quantity) -> String {
    match quantity.symbol {
        "" => capital(quantity.words),
        symbol => symbol.to_owned(),
    }
}

/// The column of T at whole steps, where every finished point has T at half steps.
fn second_temperature(points: &[SweptPoint]) -> Option<&'static str> {
    let mut finished = points.iter().filter(|p| p.compared.is_some());
    finished.all(|p| p.row("temperature_half_steps").is_some()).then_some("T, whole steps")
}

/// The points in columns that fit a terminal: one temperature, and differences where there is room for them.
fn for_terminal(points: &[SweptPoint]) -> Table {
    let kind = Kind::of(points);
    let mut left_out = vec!["State".to_owned()];
    left_out.extend(second_temperature(points).map(str::to_owned));
    for quantity in kind.quantities() {
        let is_last = quantity.key == "heat_capacity";
        left_out.extend(is_last.then(|| heading(quantity)));
        left_out.extend(kind.difference(quantity).filter(|_| is_last || !kind.is_homogeneous()));
    }
    let left_out: Vec<&str> = left_out.iter().map(String::as_str).collect();
    let mut table = of_points(points).without(&left_out);
    for column in &mut table.columns {
        if column.name.starts_with("T, ") {
            column.name = "T".into();
        }
    }
    table
}

/// The table of points with a link from each name to its page.
fn linked(mut table: Table, points: &[SweptPoint]) -> Table {
    if let Some(names) = table.columns.first_mut() {
        for (cell, point) in names.cells.iter_mut().zip(points) {
            if let Some(page) = &point.page {
                *cell = Cell::words(format!("[{}]({page})", point.name)).toned(cell.tone);
            }
        }
    }
    table
}

/// Without columns that say nothing here, so that the verdicts are in view.
fn narrow(mut table: Table, points: &[SweptPoint]) -> Table {
    let says_something = |cell: &Cell| cell.value != Value::Missing;
    table.columns.retain(|column| column.cells.iter().any(says_something));
    if let Some(column) = second_temperature(points) {
        table = table.without(&[column]);
    }
    let is_there = table.columns.iter().any(|column| column.name == "State");
    let shown = points.iter().filter(|_| is_there);
    let mut states = shown.map(|p| p.state().words.as_str());
    if let Some(first) = states.next().filter(|first| states.all(|s| s == *first)) {
        table.caption += &format!(" State of all points: {first}.");
        table = table.without(&["State"]);
    }
    table
}

/// The points with what was measured, beside the equation of state or the coexisting phases where there are some.
pub(super) fn of_points(points: &[SweptPoint]) -> Table {
    let kind = Kind::of(points);
    let caption = match kind.reference {
        None => "Digits in brackets are one standard error in the last digits.",
        Some(_) => {
            "Digits in brackets are one standard error in the last digits. Differences in green agree, in red they do not; in brown they are as large as the predicted bias of the \
             cutoff, or the tolerance is too large to tell."
        }
    };
    let mean =
        |p: &SweptPoint, quantity: &str| Cell::rounded(p.row(quantity).map(|r| r.measured), 5);
    let mut table = Table::rows_of("points", points)
        .caption(caption)
        .column("Point", |p| &p.name)
        .column("T, whole steps", |p| mean(p, "temperature"))
        .column("T, half steps", |p| mean(p, "temperature_half_steps"));
    for quantity in kind.quantities() {
        let unit = match quantity.unit {
            "" => String::new(),
            unit if unit.contains('/') => format!(" [({unit})]"),
            unit => format!(" [{unit}]"),
        };
        let of = heading(quantity) + &unit;
        table = table.measured(&of, |p| p.row(quantity.key).map(Row::mean));
        let Some(beside) = kind.difference(quantity) else { continue };
        table = table.column(&beside, |p| {
            let row = p.row(quantity.key)?;
            row.off().map(|(off, error)| Cell::measured(off, error).toned(row.verdict.tone()))
        });
    }
    // Where all are the same, there is nothing to tell.
    if kind.reference.is_some() || points.iter().any(|p| p.compared.is_none()) {
        table = table.column("State", |p| {
            if p.compared.is_none() && kind.reference.is_none() {
                return why_unfinished(p);
            }
            let state = p.state();
            Cell::words(&state.words).toned(if state.is_single_stable_phase() {
                Tone::Plain
            } else {
                Tone::Careful
            })
        });
    }
    // In the last column, which pages keep in sight.
    if kind.reference.is_some() {
        let all: Vec<String> = kind.quantities().map(heading).collect();
        table =
            table.column(&format!("Verdicts of {}", all.join(", ")), |p| verdicts(p, kind.keys));
    }
    table.table()
}

/// Why a point has no results.
fn why_unfinished(point: &SweptPoint) -> Cell {
    let failure = point.failure.as_ref();
    let why = failure.and_then(|why| why.reason.lines().next());
    Cell::words(why.unwrap_or("not finished")).toned(Tone::Bad)
}

/// The verdicts of a point, each with the quantities that have it, or why there are none.
pub(super) fn verdicts(point: &SweptPoint, keys: &[&str]) -> Cell {
    let Some(compared) = &point.compared else {
        return why_unfinished(point);
    };
    let rows = || keys.iter().filter_map(|key| point.row(key));
    if !compared.state.is_single_stable_phase() && !rows().any(|r| r.verdict.is_judged()) {
        return Cell::words("not judged").toned(Tone::Careful);
    }
    let told = keys.iter().filter_map(|key| quantity_of(key)).filter_map(|quantity| {
        let row = point.row(quantity.key)?;
        let words = match row.verdict {
            Verdict::PredictedBias => row.verdict_words(),
            other => other.words().to_owned(),
        };
        Some((words, heading(quantity)))
    });
    let shared = grouped(told);
    let tone = gravest(rows().map(|row| row.verdict.tone()));
    if let [(words, _)] = &shared[..] {
        return Cell::words(words).toned(tone);
    }
    let each = shared.iter().map(|(words, names)| format!("{words}: {}", names.join(", ")));
    Cell::words(each.collect::<Vec<_>>().join("; ")).toned(tone)
}

/// The tone that wants the most attention.
fn gravest(tones: impl Iterator<Item = Tone>) -> Tone {
    let rank = |tone: &Tone| match tone {
        Tone::Faint | Tone::Plain => 0,
        Tone::Good => 1,
        Tone::Careful => 2,
        Tone::Bad => 3,
    };
    tones.max_by_key(rank).unwrap_or_default()
}
