//! The page of a chart.

use lennard_report::{
    Block, Cell, Page, PageFigure, PageTable, Section, Tone, significant, with_error,
};

use super::panels::{Axis, Mark, Panel};
use super::point::Outcome;
use super::standings::{Advice, NOT_RESOLVED, basis, done, standings};
use super::{Chart, figures, tables};
use crate::StudyError;
use crate::files::Captioned;

/// Sections with the panels that belong to them.
const SECTIONS: [(&str, &[&str]); 4] = [
    ("Forces", &["forces-same-model", "forces-untruncated"]),
    (
        "Energy and temperature",
        &["energy-fluctuation", "energy-drift", "temperatures"],
    ),
    (
        "U and P",
        &[
            "energy-equation",
            "pressure-equation",
            "energy-tightest",
            "pressure-tightest",
        ],
    ),
    ("Motion", &["trajectory", "reversibility"]),
];

/// The whole page.
pub(super) fn page(chart: &Chart, drawn: &[Captioned], command: &str) -> Result<Page, StudyError> {
    let plan = &chart.plan;
    let mut page = Page {
        title: format!("Speed against accuracy: {}", chart.scene),
        lead: format!(
            "{} settings on {} particles at density {}, all from one equilibrated start. Each error stands in a diagram of its own. \
             Numbers mark the Pareto front: nothing that costs less errs less. Crosses at the upper edge are runs that failed. In the \
             tinted strip differences say nothing. **Point at a mark, or tap it, to see what it is.**",
            chart.points.len(),
            chart.atoms,
            significant(chart.density, 4),
        ),
        sections: vec![summary(chart)],
        provenance: vec![
            ("Command".into(), format!("`{command}`")),
            ("Version".into(), plan.version.clone()),
            ("Processor".into(), plan.cpu.clone()),
            (
                "Costs".into(),
                format!(
                    "the engine's main loop without observables and output, {}; median and range of {} timings, each round in \
                     another order",
                    lennard_report::counted(plan.threads, "thread"),
                    plan.repeats
                ),
            ),
            (
                "Errors".into(),
                format!(
                    "runs of {} τ, the tightest of {} τ, in an order that is shuffled",
                    significant(plan.time, 3),
                    significant(plan.tight_time, 3)
                ),
            ),
        ],
    };
    if !chart.finished {
        page.sections[0].blocks.insert(
            0,
            Block::Remark(format!(
                "The chart was stopped before its end: {}. The same command goes on.",
                done(chart).in_words()
            )),
        );
    }
    for (title, names) in SECTIONS {
        let mut section = Section::new(title);
        for name in names {
            let Some(panel) = chart.panels.iter().find(|p| p.name == *name) else {
                continue;
            };
            section
                .blocks
                .extend(of_panel(chart, panel, drawn, command)?);
        }
        page.sections.push(section);
    }
    page.sections.push(all_points(chart));
    page.sections.push(left_out(chart));
    Ok(page)
}

fn of_panel(
    chart: &Chart,
    panel: &Panel,
    drawn: &[Captioned],
    command: &str,
) -> Result<Vec<Block>, StudyError> {
    let mut blocks = vec![Block::Heading(panel.title.into())];
    let mut shown: Vec<PageFigure> = Vec::new();
    for axis in [Axis::Wall, Axis::Forces] {
        let name = figures::name(panel, axis);
        if let Some(figure) = drawn.iter().find(|f| f.figure.name() == name) {
            shown.push(figure.on_page(command)?);
        }
    }
    if shown.is_empty() {
        blocks.push(Block::Remark(format!(
            "{} There is nothing to draw.",
            panel.about
        )));
        return Ok(blocks);
    }
    blocks.push(Block::Figures(shown));
    blocks.push(Block::Table(front(chart, panel)));
    Ok(blocks)
}

fn error_cell(mark: &Mark) -> Cell {
    match (mark.error, mark.standard_error) {
        (Some(e), Some(se)) => Cell::number(with_error(e, se)),
        (Some(e), None) => Cell::number(significant(e, 3)),
        (None, _) => Cell::toned("failed", Tone::Bad),
    }
}

fn front(chart: &Chart, panel: &Panel) -> PageTable {
    let mut marks: Vec<&Mark> = panel.marks.iter().filter(|m| m.on_wall_front).collect();
    marks.sort_by(|a, b| a.wall.total_cmp(&b.wall));
    PageTable {
        caption: "The front by wall time, the cheapest first.".into(),
        command: None,
        header: [
            "",
            "Settings",
            "µs per atom and τ",
            "Pair forces per atom and τ",
            "Error",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: marks
            .into_iter()
            .map(|m| {
                vec![
                    Cell::number(m.number.to_string()),
                    Cell::text(tables::label(chart, m.number)),
                    Cell::number(significant(1e6 * m.wall, 3)),
                    Cell::number(significant(m.pair_forces, 3)),
                    error_cell(m),
                ]
            })
            .collect(),
    }
}

fn summary(chart: &Chart) -> Section {
    let mut section = Section::new("The scene's own settings");
    let Some(own) = chart.points.first() else {
        return section;
    };
    section = section.text(format!(
        "Number 1, \"scene\" in the diagrams, is the scene itself: {}.",
        own.label
    ));
    let mut others = chart.points[1..].iter();
    if let Some(usual) = others.find(|p| p.engine.is_none() && p.settings.are_usual()) {
        section = section.text(format!(
            "Number {}, \"usual\", is what most people would take: {}.",
            usual.number, usual.label
        ));
    }
    if let Some(m) = own.measured() {
        section = section.text(format!(
            "{} τ let U be known to ± {} ε ({:.0} independent samples), P to ± {} ε/σ³ ({:.0}), T to ± {} ({:.0}). A bias below that cannot be \
             seen here; four times the time halves it.",
            significant(m.time, 3),
            significant(m.potential_energy.standard_error, 2),
            m.potential_energy.n_effective,
            significant(m.pressure.standard_error, 2),
            m.pressure.n_effective,
            significant(m.temperature.standard_error, 2),
            m.temperature.n_effective,
        ));
    }
    let rows: Vec<Vec<Cell>> = standings(chart)
        .into_iter()
        .map(|s| {
            let (number, label, cost) = match s.advice {
                Advice::Cheaper(mark) => (
                    mark.number.to_string(),
                    tables::label(chart, mark.number),
                    significant(mark.wall / s.own.wall, 2),
                ),
                Advice::NotResolved => ("–".into(), NOT_RESOLVED.to_owned(), "–".into()),
                Advice::Itself => (s.own.number.to_string(), "itself".into(), "1".into()),
            };
            vec![
                Cell::text(s.panel.title),
                error_cell(s.own),
                Cell::number(s.panel.floor.map_or("–".into(), |f| significant(f, 2))),
                Cell::number(number),
                Cell::text(label),
                Cell::number(cost),
            ]
        })
        .collect();
    if rows.is_empty() {
        return section;
    }
    section.with(Block::Table(PageTable {
        caption: format!(
            "Its error in each diagram, and the cheapest settings whose error there is no larger. The last column is their wall time over that \
             of the scene. Each row looks at one error alone. {}",
            basis(chart)
        ),
        command: None,
        header: ["Error of", "Own", "Floor", "No.", "Cheapest no worse", "Cost"]
            .map(str::to_owned)
            .to_vec(),
        rows,
    }))
}

fn all_points(chart: &Chart) -> Section {
    let header = [
        "",
        "Settings",
        "µs per atom and τ",
        "Force, same model",
        "Force, untruncated",
        "Energy RMS / ε",
        "Drift / (ε/τ)",
        "T",
        "T − T_conf",
        "U / ε",
        "P / (ε/σ³)",
        "Trajectory / σ",
        "There and back / σ",
    ];
    let none = || Cell::number("–");
    let number = |v: Option<f64>| v.map_or_else(none, |v| Cell::number(significant(v, 3)));
    let rows = chart
        .points
        .iter()
        .map(|p| {
            let errors = p.errors.as_ref();
            let wall = p
                .cost()
                .map_or_else(none, |c| Cell::number(significant(1e6 * c.wall.median, 3)));
            let mut row = vec![
                Cell::number(p.number.to_string()),
                Cell::text(tables::label(chart, p.number)),
                wall,
                number(errors.map(|e| e.forces.same_model)),
                number(errors.and_then(|e| e.forces.untruncated)),
            ];
            match errors.map(|e| &e.measured) {
                Some(Outcome::Failed(_)) => {
                    row.push(Cell::toned("failed", Tone::Bad));
                    row.extend((0..5).map(|_| none()));
                }
                Some(Outcome::Found(m)) => {
                    let value = |v: crate::lab::Value| {
                        if v.mean.is_finite() {
                            Cell::number(with_error(v.mean, v.standard_error))
                        } else {
                            none()
                        }
                    };
                    row.push(Cell::number(significant(m.energy_rms, 3)));
                    row.push(Cell::number(with_error(
                        m.drift.slope,
                        m.drift.standard_error,
                    )));
                    row.extend(
                        [
                            m.temperature,
                            m.temperature_difference,
                            m.potential_energy,
                            m.pressure,
                        ]
                        .map(value),
                    );
                }
                None => row.extend((0..6).map(|_| none())),
            }
            row.push(number(
                errors.and_then(|e| Some(e.trajectory.found()?.distance)),
            ));
            row.push(number(
                errors.and_then(|e| e.reversibility.found().copied()),
            ));
            row
        })
        .collect();
    let mut section = Section::new("All points").with(Block::Table(PageTable {
        caption: "U and P are those of the model in the same row, with its tail where it has one. Digits in brackets are one standard error in \
                  the last digits; `points.csv` has everything with n_eff."
            .into(),
        command: None,
        header: header.map(str::to_owned).to_vec(),
        rows,
    }));
    let failures: Vec<String> = chart
        .points
        .iter()
        .filter_map(|p| match &p.errors.as_ref()?.measured {
            Outcome::Failed(f) => Some(format!("**{}**, {}: {}", p.number, p.label, f.reason)),
            Outcome::Found(_) => None,
        })
        .collect();
    if !failures.is_empty() {
        section = section
            .with(Block::Heading("Runs that failed".into()))
            .with(Block::List(failures));
    }
    section
}

fn left_out(chart: &Chart) -> Section {
    let mut items: Vec<String> = chart
        .left_out
        .iter()
        .map(|l| format!("{}: {}", l.what, l.why))
        .collect();
    items.extend(chart.remarks.iter().cloned());
    if items.is_empty() {
        items.push("nothing".into());
    }
    Section::new("Left out").with(Block::List(items))
}
