//! The page of a chart.

use crate::report::{Block, Page, Section, significant};
use lennard_core::{Cell, Table, Tone};

use super::panels::{Mark, Panel};
use super::point::Outcome;
use super::standings::{Advice, NOT_RESOLVED, Standing, basis, done, standings};
use super::{Chart, ChartedPoint, Errors, figures, tables};
use crate::lab::{Measured, Value};

/// Sections with the panels that belong to them.
const SECTIONS: [(&str, &[&str]); 4] = [
    ("Forces", &["forces-same-model", "forces-untruncated"]),
    ("Energy and temperature", &["energy-fluctuation", "energy-drift", "temperatures"]),
    ("U and P", &["energy-equation", "pressure-equation", "energy-tightest", "pressure-tightest"]),
    ("Motion", &["trajectory", "reversibility"]),
];

/// The whole page.
pub(super) fn page(chart: &Chart, command: &str) -> Page {
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
        command: Some(command.to_owned()),
        sections: vec![summary(chart)],
        provenance: plan.provenance(command),
    };
    page.provenance.extend([
        (
            "Costs".into(),
            format!(
                "the engine's main loop without observables and output, {}; median and range of {} timings, each round in \
                 another order",
                crate::report::counted(plan.threads, "thread"),
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
    ]);
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
            section.blocks.extend(of_panel(chart, panel));
        }
        page.sections.push(section);
    }
    page.sections.push(all_points(chart));
    page.sections.push(left_out(chart));
    page
}

fn of_panel(chart: &Chart, panel: &Panel) -> Vec<Block> {
    let shown = figures::of(chart, panel);
    let mut blocks = vec![Block::Heading(panel.title.into())];
    if shown.is_empty() {
        let text = format!("{} There is nothing to draw.", panel.about);
        blocks.push(Block::Remark(text));
    } else {
        blocks.push(Block::Figures(shown));
        blocks.push(Block::Table(front(chart, panel)));
    }
    blocks
}

fn error_cell(mark: &Mark) -> Cell {
    match (mark.error, mark.standard_error) {
        (Some(e), Some(se)) => Cell::measured(e, se),
        (Some(e), None) => Cell::rounded(e, 3),
        (None, _) => failed(),
    }
}

fn failed() -> Cell {
    Cell::words("failed").toned(Tone::Bad)
}

fn front(chart: &Chart, panel: &Panel) -> Table {
    let mut marks: Vec<&Mark> = panel.marks.iter().filter(|m| m.on_wall_front).collect();
    marks.sort_by(|a, b| a.wall.total_cmp(&b.wall));
    let caption = "The front by wall time, the cheapest first.";
    Table::rows_of("front", &marks)
        .caption(caption)
        .column("", |m| m.number)
        .column("Settings", |m| tables::label(chart, m.number))
        .column("µs per atom and τ", |m| Cell::rounded(1e6 * m.wall, 3))
        .column("Pair forces per atom and τ", |m| Cell::rounded(m.pair_forces, 3))
        .column("Error", |m| error_cell(m))
        .table()
}

fn summary(chart: &Chart) -> Section {
    let mut section = Section::new("The scene's own settings");
    let Some(own) = chart.points.first() else {
        return section;
    };
    section = section
        .text(format!("Number 1, \"scene\" in the diagrams, is the scene itself: {}.", own.label));
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
    let standings = standings(chart);
    if standings.is_empty() {
        return section;
    }
    section.table(own_settings(chart, &standings))
}

/// The error of the scene's own settings in each diagram, and what would do as well for less.
pub fn own_settings(chart: &Chart, standings: &[Standing<'_>]) -> Table {
    let caption = format!(
        "Its error in each diagram, and the cheapest settings whose error there is no larger. The last column is their wall time over the \
         wall time of the scene. Each row looks at one error alone. {}",
        basis(chart)
    );
    Table::rows_of("own-settings", standings)
        .caption(caption)
        .column("Error of", |s| s.panel.title)
        .column("Own", |s| match (s.own.error, s.own.standard_error) {
            (Some(error), None) => Cell::rounded(error, 2),
            _ => error_cell(s.own),
        })
        .column("Floor", |s| Cell::rounded(s.panel.floor, 2))
        .column("No.", |s| match s.advice {
            Advice::Cheaper(mark) => Some(mark.number),
            Advice::NotResolved => None,
            Advice::Itself => Some(s.own.number),
        })
        .column("Cheapest that is no worse", |s| match s.advice {
            Advice::Cheaper(mark) => tables::label(chart, mark.number),
            Advice::NotResolved => NOT_RESOLVED.into(),
            Advice::Itself => "itself".into(),
        })
        .column("Cost", |s| match s.advice {
            Advice::Cheaper(mark) => {
                Cell::figures(format!("{} ×", significant(mark.wall / s.own.wall, 2)))
            }
            Advice::NotResolved => Cell::default(),
            Advice::Itself => Cell::figures("1 ×"),
        })
        .table()
}

fn all_points(chart: &Chart) -> Section {
    let caption = "U and P belong to the model in the same row, with its tail where it has one. Digits in brackets are one standard error in \
                   the last digits; `points.csv` has everything with n_eff.";
    let errors = |p: &'_ ChartedPoint, pick: fn(&Errors) -> Option<f64>| {
        Cell::rounded(p.errors.as_ref().and_then(pick), 3)
    };
    let value = |p: &ChartedPoint, pick: fn(&Measured) -> Value| {
        let value = p.measured().map(pick).filter(|v| v.mean.is_finite());
        value.map(|v| (v.mean, v.standard_error))
    };
    let mut section = Section::new("All points").table(
        Table::rows_of("all-points", &chart.points)
            .caption(caption)
            .column("", |p| p.number)
            .column("Settings", |p| tables::label(chart, p.number))
            .column("µs per atom and τ", |p| {
                Cell::rounded(p.cost().map(|c| 1e6 * c.wall.median), 3)
            })
            .column("Force, same model", |p| errors(p, |e| Some(e.forces.same_model)))
            .column("Force, untruncated", |p| errors(p, |e| e.forces.untruncated))
            .column("Energy RMS [ε]", |p| match p.errors.as_ref().map(|e| &e.measured) {
                Some(Outcome::Failed(_)) => failed(),
                Some(Outcome::Found(m)) => Cell::rounded(m.energy_rms, 3),
                None => Cell::default(),
            })
            .measured("Drift [(ε/τ)]", |p| {
                let drift = p.measured().map(|m| m.drift);
                drift.map(|d| (d.slope, d.standard_error))
            })
            .measured("T", |p| value(p, |m| m.temperature))
            .measured("T − T_conf", |p| value(p, |m| m.temperature_difference))
            .measured("U [ε]", |p| value(p, |m| m.potential_energy))
            .measured("P [(ε/σ³)]", |p| value(p, |m| m.pressure))
            .column("Trajectory [σ]", |p| errors(p, |e| Some(e.trajectory.found()?.distance)))
            .column("There and back [σ]", |p| errors(p, |e| e.reversibility.found().copied()))
            .table(),
    );
    let failures: Vec<String> = chart
        .points
        .iter()
        .filter_map(|p| match &p.errors.as_ref()?.measured {
            Outcome::Failed(f) => Some(format!("**{}**, {}: {}", p.number, p.label, f.reason)),
            Outcome::Found(_) => None,
        })
        .collect();
    if !failures.is_empty() {
        section =
            section.with(Block::Heading("Runs that failed".into())).with(Block::List(failures));
    }
    section
}

fn left_out(chart: &Chart) -> Section {
    let mut items: Vec<String> =
        chart.left_out.iter().map(|l| format!("{}: {}", l.what, l.why)).collect();
    items.extend(chart.remarks.iter().cloned());
    if items.is_empty() {
        items.push("nothing".into());
    }
    Section::new("Left out").with(Block::List(items))
}
