//! The page of a chart.

use lennard_observables::{Cell, Estimate, Table, Tone};

use super::advice::{basis, unresolved};
use super::figures;
use super::types::{Advice, Axis, Chart, ChartedPoint, Mark, Panel};
use crate::lab::Measured;
use crate::lists::grouped;
use crate::report::{Block, Page, Section, counted, significant};

/// The whole page.
pub(super) fn page(chart: &Chart) -> Page {
    let plan = &chart.plan;
    let of_runs = format!(
        "runs of {} τ, the tightest of {} τ, in an order that is shuffled",
        significant(plan.time, 3),
        significant(plan.tight_time, 3)
    );
    let mut sections = vec![summary(chart)];
    for (title, panels) in grouped(chart.panels.iter().map(|panel| (&panel.section, panel))) {
        let blocks = panels.into_iter().flat_map(|panel| of_panel(chart, panel)).collect();
        sections.push(Section { blocks, ..Section::new(title).folded() });
    }
    sections.push(all_points(chart));
    sections.push(left_out(chart));
    sections.retain(|section| !section.blocks.is_empty());
    Page {
        title: format!("Speed against accuracy: {}", chart.scene),
        lead: lead(chart),
        command: Some(chart.command.clone()),
        sections,
        provenance: vec![
            ("Command".into(), format!("`{}`", chart.command)),
            ("Version".into(), plan.version.clone()),
            ("Processor".into(), plan.cpu.clone()),
            (
                "Costs".into(),
                format!(
                    "the engine's main loop, without observables and output, {}; median and range of {} timings, \
                     each round in another order",
                    counted(plan.threads, "thread"),
                    plan.repeats
                ),
            ),
            ("Errors".into(), of_runs),
        ],
    }
}

fn lead(chart: &Chart) -> String {
    format!(
        "{} settings on {} particles at density {}, all from one equilibrated start. Each error stands in a diagram of its own. \
         Numbers mark the Pareto front: nothing that costs less errs less. Crosses at the upper edge are runs that failed. In the \
         tinted strip differences say nothing. **Point at a mark, or tap it, to see what it is.**",
        chart.points.len(),
        chart.atoms,
        significant(chart.density, 4),
    )
}

/// What a reader sees first: the main errors against cost, the scene's own settings, and what would do as well for less.
#[must_use]
pub fn summary(chart: &Chart) -> Section {
    let mut section = Section::new("");
    if !chart.finished {
        section = section.with(Block::Remark(format!(
            "stopped before the end: {}. What is advised may change; the same command goes on.",
            chart.progress()
        )));
    }
    section = section.figures(figures::overview(chart).into_iter().collect());
    section = section.list(introduction(chart));
    let advised: Vec<&Panel> = chart.panels.iter().filter(|p| p.advice.is_some()).collect();
    match unresolved(chart) {
        Some(sentence) => section.text(sentence),
        None if advised.is_empty() => section,
        None => section.table(own_settings(chart, &advised)).text(basis(chart)),
    }
}

/// The scene's own settings in sentences, with their cost and with what runs can tell.
fn introduction(chart: &Chart) -> Vec<String> {
    let Some(own) = chart.points.first() else {
        return Vec::new();
    };
    let mut said =
        vec![format!("Number 1, \"scene\" in the diagrams, is the scene itself: {}.", own.label)];
    let mut others = chart.points[1..].iter();
    let is_usual = |p: &&ChartedPoint| p.engine.is_none() && p.settings.are_usual();
    if let Some(usual) = others.find(is_usual) {
        said.push(format!(
            "Number {}, \"usual\", is what most people would take: {}.",
            usual.number, usual.label
        ));
    }
    if let Some(cost) = own.cost() {
        said.push(format!(
            "The scene's own settings cost {} µs per atom and τ ({} to {}, {} timings, {}).",
            significant(1e6 * cost.wall.median, 3),
            significant(1e6 * cost.wall.lowest, 3),
            significant(1e6 * cost.wall.highest, 3),
            cost.wall.repeats,
            counted(chart.plan.threads, "thread")
        ));
    }
    if let Some(m) = own.measured() {
        said.push(format!(
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
    said
}

/// The error of the scene's own settings in each diagram, and what would do as well for less.
fn own_settings(chart: &Chart, panels: &[&Panel]) -> Table {
    let by = chart.cost_by;
    let cost = match by {
        Axis::Wall => "wall time over the wall time of the scene",
        Axis::Forces => "pair forces over the pair forces of the scene",
    };
    let caption = format!(
        "Its error in each diagram, and the cheapest settings whose error there is no larger. The last column is their {cost}. Each row \
         looks at one error alone."
    );
    let own = |panel: &Panel| panel.mark(1).cloned();
    Table::rows_of("own-settings", panels)
        .caption(caption)
        .column("Error of", |p| &p.title)
        .column("Own", |p| match own(p) {
            Some(Mark { error: Some(error), standard_error: None, .. }) => Cell::rounded(error, 2),
            Some(mark) => error_cell(&mark),
            None => Cell::default(),
        })
        .column("Floor", |p| Cell::rounded(p.floor, 2))
        .column("No.", |p| match p.advice {
            Some(Advice::Cheaper(number)) => Some(number),
            Some(Advice::Itself) => Some(1),
            _ => None,
        })
        .column("Cheapest that is no worse", |p| match p.advice {
            Some(Advice::Cheaper(number)) => chart.label(number),
            Some(Advice::Itself) => "itself".into(),
            _ => "not resolved by this chart".into(),
        })
        .column("Cost", |p| match (p.advice, own(p)) {
            (Some(Advice::Cheaper(number)), Some(own)) => p.mark(number).map(|mark| {
                Cell::figures(format!("{} ×", significant(mark.cost(by) / own.cost(by), 2)))
            }),
            (Some(Advice::Itself), _) => Some(Cell::figures("1 ×")),
            _ => None,
        })
        .table()
}

fn of_panel(chart: &Chart, panel: &Panel) -> Vec<Block> {
    let shown = figures::of(chart, panel);
    let mut blocks = vec![Block::Heading(panel.title.clone())];
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
        .column("Settings", |m| chart.label(m.number))
        .column("µs per atom and τ", |m| Cell::rounded(1e6 * m.wall, 3))
        .column("Pair forces per atom and τ", |m| Cell::rounded(m.pair_forces, 3))
        .column("Error", |m| error_cell(m))
        .table()
}

/// Every point with its cost, its means, and its error in each diagram.
fn all_points(chart: &Chart) -> Section {
    let caption = "U and P belong to the model in the same row, with its tail where it has one. \
                   Digits in brackets are one standard error in the last digits; `points.csv` has everything with n_eff.";
    let value = |p: &ChartedPoint, pick: fn(&Measured) -> Estimate| {
        p.measured().map(pick).filter(|v| v.mean.is_finite())
    };
    let table = Table::rows_of("all-points", &chart.points)
        .caption(caption)
        .column("", |p| p.number)
        .column("Settings", |p| chart.label(p.number))
        .column("µs per atom and τ", |p| Cell::rounded(p.cost().map(|c| 1e6 * c.wall.median), 3))
        .measured("T", |p| value(p, |m| m.temperature))
        .measured("U [ε]", |p| value(p, |m| m.potential_energy))
        .measured("P [(ε/σ³)]", |p| value(p, |m| m.pressure));
    let mut errors = Table::rows_of("errors", &chart.points)
        .caption("The error of each point in each diagram.")
        .column("", |p| p.number);
    for panel in &chart.panels {
        errors = errors.column(&panel.title, |p| panel.mark(p.number).map(error_cell));
    }
    let section = Section::new("All points").folded().table(table.table()).table(errors.table());
    let failures: Vec<String> = chart
        .points
        .iter()
        .filter_map(|p| Some(format!("**{}**, {}: {}", p.number, p.label, p.failure()?.reason)))
        .collect();
    match failures.is_empty() {
        true => section,
        false => section.heading("Runs that failed").list(failures),
    }
}

fn left_out(chart: &Chart) -> Section {
    let mut items: Vec<String> =
        chart.left_out.iter().map(|l| format!("{}: {}", l.what, l.why)).collect();
    items.extend(chart.remarks.iter().cloned());
    Section::new("Left out").folded().list(items)
}
