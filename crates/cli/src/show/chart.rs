//! A chart of speed against accuracy as a table.

use std::path::Path;

use comfy_table::Table;
use lennard_report::significant;
use lennard_studies::chart::{Advice, Chart, NOT_RESOLVED, Standing, basis, done, standings};

use super::table;

/// Where the scene's own settings stand, and what would do as well for less.
pub fn chart(chart: &Chart, folder: &Path) {
    println!(
        "{}: {} settings, {} particles, runs of {} τ",
        chart.scene,
        chart.points.len(),
        chart.atoms,
        significant(chart.plan.time, 3)
    );
    if let Some(own) = chart.points.first() {
        println!("  its own settings: {}", own.label);
        if let Some(m) = own.measured() {
            println!(
                "  statistical floor: U ± {} ε (n_eff {:.0}), P ± {} ε/σ³ (n_eff {:.0})",
                significant(m.potential_energy.standard_error, 2),
                m.potential_energy.n_effective,
                significant(m.pressure.standard_error, 2),
                m.pressure.n_effective
            );
        }
        if let Some(cost) = own.cost() {
            println!(
                "  their cost: {} µs per atom and τ ({} to {}, {} timings, {})",
                significant(1e6 * cost.wall.median, 3),
                significant(1e6 * cost.wall.lowest, 3),
                significant(1e6 * cost.wall.highest, 3),
                cost.wall.repeats,
                lennard_report::counted(chart.plan.threads, "thread")
            );
        }
    }
    let standings = standings(chart);
    if !chart.finished {
        println!("  stopped before the end: {}", done(chart).in_words());
        if !standings.is_empty() {
            println!("  what is advised below is of an unfinished chart, and may change");
        }
    }
    if !standings.is_empty() {
        println!("{}", of_own_settings(chart, &standings));
        println!("  {}", basis(chart));
    }
    let failed = chart
        .points
        .iter()
        .filter(|p| p.errors.is_some() && p.measured().is_none())
        .count();
    if failed > 0 {
        println!("  {failed} settings failed; the page says how");
    }
    for remark in &chart.remarks {
        println!("  {remark}");
    }
    println!("  page: {}", folder.join("report.html").display());
}

/// The error of the scene's own settings in each panel, and what would do as well for less.
fn of_own_settings(chart: &Chart, standings: &[Standing<'_>]) -> Table {
    let mut t = table(
        &["error", "own", "floor", "cheapest that is no worse", "cost"],
        1..3,
    );
    for s in standings {
        let own = s.own.error.unwrap_or(f64::NAN);
        let own = match s.own.standard_error {
            Some(error) => format!("{} ± {}", significant(own, 2), significant(error, 2)),
            None => significant(own, 2),
        };
        let (label, cost) = match s.advice {
            Advice::Cheaper(mark) => {
                let point = chart.points.iter().find(|p| p.number == mark.number);
                let cost = format!("{} ×", significant(mark.wall / s.own.wall, 2));
                (point.map_or("", |p| p.label.as_str()), cost)
            }
            Advice::NotResolved => (NOT_RESOLVED, "–".to_owned()),
            Advice::Itself => ("itself", "1 ×".to_owned()),
        };
        t.add_row([
            s.panel.title.to_owned(),
            own,
            s.panel.floor.map_or("–".into(), |f| significant(f, 2)),
            label.to_owned(),
            cost,
        ]);
    }
    t
}
