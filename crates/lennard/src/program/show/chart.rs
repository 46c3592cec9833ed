//! A chart of speed against accuracy as a table.

use std::path::Path;

use lennard_studies::chart::ensembles::{self, EnsembleChart};
use lennard_studies::chart::{Chart, basis, done, own_settings, standings};
use lennard_studies::report::significant;

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
                lennard_studies::report::counted(chart.plan.threads, "thread")
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
        let own = own_settings(chart, &standings).without(&["No."]);
        println!("{}", table(&own));
        println!("  {}", basis(chart));
    }
    let failed =
        chart.points.iter().filter(|p| p.errors.is_some() && p.measured().is_none()).count();
    if failed > 0 {
        println!("  {failed} settings failed; the page says how");
    }
    for remark in &chart.remarks {
        println!("  {remark}");
    }
    println!("  page: {}", folder.join("report.html").display());
}

/// Choices of barostat and thermostat, with what they sample and cost.
pub fn ensembles(chart: &EnsembleChart, folder: &Path) {
    println!(
        "{}: {} choices, {} particles, P = {}, T = {}, runs of {} τ",
        chart.scene,
        chart.points.len(),
        chart.atoms,
        significant(chart.pressure, 4),
        significant(chart.temperature, 4),
        significant(chart.plan.time, 3)
    );
    if let Some(reference) = &chart.reference {
        println!(
            "  reference: density {}, variance of V {} σ⁶ ({})",
            significant(reference.density, 5),
            significant(reference.variance, 4),
            reference.source
        );
    }
    println!("{}", table(&ensembles::summary(chart)));
    if !chart.finished {
        println!("  stopped before the end: what is there may change");
    }
    for left in &chart.left_out {
        println!("  left out: {}: {}", left.what, left.why);
    }
    println!("  page: {}", folder.join("report.html").display());
}
