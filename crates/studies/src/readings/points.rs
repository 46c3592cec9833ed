//! Every point with its results: a table by what the points are, and each property against what the study changes.

use lennard_core::{Cell, Table, Tone};

use super::blocks::{Blocks, POINTS, PROPERTIES, StudyPoints};
use super::properties;
use crate::compare::Verdict;
use crate::report::Section;
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
    let lead = Kind::of(points).in_words().to_owned();
    Blocks {
        lead,
        sections,
        terminal: vec![for_terminal(points)],
        sentences: vec!["Digits in brackets are one standard error in the last digits.".into()],
        ..Blocks::default()
    }
}

/// What the points of a sweep are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Homogeneous fluids, or anything else that one equation of state may describe.
    Fluids,
    /// Slabs of liquid beside their vapor.
    Slabs,
    /// Crystals beside their liquid.
    Crystals,
}

/// A quantity of the table, its heading, and the heading of its difference where it has a reference.
pub(super) type Shown = (&'static str, &'static str, Option<&'static str>);

impl Kind {
    /// What the points are, by what any of them has measured.
    pub(super) fn of(points: &[SweptPoint]) -> Self {
        let measured = |quantity: &str| points.iter().any(|p| p.row(quantity).is_some());
        if measured("liquid_density") {
            Self::Slabs
        } else if measured("front_velocity") {
            Self::Crystals
        } else {
            Self::Fluids
        }
    }

    /// The quantities of the table.
    fn columns(self) -> &'static [Shown] {
        match self {
            Self::Fluids => &[
                ("potential_energy", "U [ε]", Some("U − equation")),
                ("pressure", "P [(ε/σ³)]", Some("P − equation")),
                ("heat_capacity", "c_v [k_B]", Some("c_v − equation")),
            ],
            Self::Slabs => &[
                ("liquid_density", "ρ of liquid [σ⁻³]", Some("ρ_l − literature")),
                ("vapor_density", "ρ of vapor [σ⁻³]", Some("ρ_v − literature")),
                ("vapor_pressure", "p_s [(ε/σ³)]", Some("p_s − literature")),
                ("surface_tension", "γ [(ε/σ²)]", Some("γ − literature")),
            ],
            Self::Crystals => &[
                ("front_velocity", "Velocity of a front [(σ/τ)]", None),
                ("solid_share", "Solid share", None),
                ("pressure", "P [(ε/σ³)]", None),
            ],
        }
    }

    /// The heading of the verdicts; `None` where nothing is judged.
    fn verdicts(self) -> Option<&'static str> {
        match self {
            Self::Fluids => Some("Verdicts of U, P, c_v"),
            Self::Slabs => Some("Verdicts of ρ, p_s, γ"),
            Self::Crystals => None,
        }
    }

    /// What the points are, and what they stand beside.
    fn in_words(self) -> &'static str {
        match self {
            Self::Fluids => {
                "Each is compared with the equation of state that describes its model, at the measured temperature that belongs to its \
                 positions (of half steps where the method has them) and for as many particles in a closed box; the error of a \
                 difference counts that U, P and T fluctuate together."
            }
            Self::Slabs => {
                "Each is a slab of liquid beside its vapor. It is compared with two coexisting phases of its model at the measured \
                 temperature."
            }
            Self::Crystals => {
                "Each is a crystal beside its liquid. The velocity of a front is positive where the crystal grows."
            }
        }
    }
}

/// The column of T at whole steps, where every finished point has T at half steps.
fn second_temperature(points: &[SweptPoint]) -> Option<&'static str> {
    let mut finished = points.iter().filter(|p| p.compared.is_some());
    finished.all(|p| p.row("temperature_half_steps").is_some()).then_some("T, whole steps")
}

/// The points in columns that fit a terminal: one temperature, and differences where there is room for them.
fn for_terminal(points: &[SweptPoint]) -> Table {
    let mut left_out = vec!["State", "c_v", "c_v − equation"];
    left_out.extend(second_temperature(points));
    if Kind::of(points) == Kind::Slabs {
        left_out.extend(Kind::Slabs.columns().iter().filter_map(|(.., beside)| *beside));
    }
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
    let caption = match kind {
        Kind::Crystals => "Digits in brackets are one standard error in the last digits.",
        Kind::Fluids | Kind::Slabs => {
            "Digits in brackets are one standard error in the last digits. Differences in green agree, in red they do not; in brown they are as large as the predicted bias of a short \
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
    for (quantity, heading, beside) in kind.columns() {
        table =
            table.measured(heading, |p| p.row(quantity).map(|r| (r.measured, r.standard_error)));
        let Some(beside) = beside else { continue };
        table = table.column(beside, |p| {
            let row = p.row(quantity)?;
            let cell = Cell::measured(row.difference?, row.combined_error?);
            Some(cell.toned(row.verdict.tone()))
        });
    }
    // Where all are the same, there is nothing to tell.
    if kind != Kind::Crystals || points.iter().any(|p| p.compared.is_none()) {
        table = table.column("State", |p| {
            if p.compared.is_none() && kind.verdicts().is_none() {
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
    if let Some(heading) = kind.verdicts() {
        table = table.column(heading, |p| verdicts(p, kind.columns()));
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
pub(super) fn verdicts(point: &SweptPoint, columns: &[Shown]) -> Cell {
    let Some(compared) = &point.compared else {
        return why_unfinished(point);
    };
    let rows = || columns.iter().filter_map(|(quantity, ..)| point.row(quantity));
    if !compared.state.is_single_stable_phase() && !rows().any(|r| r.verdict.is_judged()) {
        return Cell::words("not judged").toned(Tone::Careful);
    }
    let mut shared: Vec<(String, Vec<&str>)> = Vec::new();
    for (quantity, heading, _) in columns {
        let Some(row) = point.row(quantity) else {
            continue;
        };
        let words = match row.verdict {
            Verdict::PredictedBias => row.verdict_words(),
            other => other.words().to_owned(),
        };
        let name = heading.split(" [").next().unwrap_or(heading);
        match shared.iter_mut().find(|(known, _)| *known == words) {
            Some((_, names)) => names.push(name),
            None => shared.push((words, vec![name])),
        }
    }
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
