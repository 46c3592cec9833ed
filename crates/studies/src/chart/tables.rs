//! The numbers of a chart as tables.

use lennard_engine::stopwatch::Spread;
use lennard_observables::{Estimate, Table};
use serde::Serialize;

use super::types::{Chart, ChartedPoint, Panel};
use crate::lab::Measured;

fn wall(point: &ChartedPoint, pick: fn(&Spread) -> f64) -> Option<f64> {
    point.cost().map(|c| pick(&c.wall))
}

/// Every point with everything that is known of it.
pub(super) fn points(chart: &Chart) -> Table {
    let mut table = Table::rows_of("points", &chart.points)
        .column("number", |p| p.number)
        .column("engine", |p| p.engine.as_deref().unwrap_or("lennard"))
        .column("settings", |p| &p.label)
        .column("integrator", |p| p.settings.integrator.name())
        .column("dt [tau]", |p| p.settings.dt)
        .column("truncation", |p| word(&p.settings.truncation.kind))
        .column("r_cut [sigma]", |p| p.settings.truncation.r_cut)
        .column("tail", |p| p.settings.truncation.tail_correction)
        .column("precision", |p| p.settings.precision.name())
        .column("list", |p| word(&p.settings.list))
        .column("skin [sigma]", |p| p.settings.skin)
        .column("wall median [s per atom and tau]", |p| wall(p, |w| w.median))
        .column("wall lowest [s per atom and tau]", |p| wall(p, |w| w.lowest))
        .column("wall highest [s per atom and tau]", |p| wall(p, |w| w.highest))
        .column("timings", |p| p.timings.len())
        .column("force evaluations per tau", |p| p.cost().map(|c| c.evaluations_per_tau))
        .column("pair forces per atom and tau", |p| p.cost().map(|c| c.pair_forces_per_atom_tau))
        .column("relative force error, same model", |p| {
            p.errors.as_ref().map(|e| e.forces.same_model)
        })
        .column("relative force error, untruncated", |p| {
            p.errors.as_ref().and_then(|e| e.forces.untruncated)
        })
        .column("measured time [tau]", |p| p.measured().map(|m| m.time));
    for (name, unit, pick) in VALUES {
        let value = |p: &ChartedPoint| p.measured().map(pick);
        table = table
            .measured(&format!("{name} [{unit}]"), value)
            .column(&format!("{name} n_eff"), |p| value(p).map(|v| v.n_effective));
    }
    table
        .column("energy RMS [epsilon per atom]", |p| p.measured().map(|m| m.energy_rms))
        .measured("energy drift [epsilon/tau per atom]", |p| p.measured().map(|m| m.drift))
        .column("trajectory error [sigma]", |p| {
            let errors = p.errors.as_ref();
            errors.and_then(|e| Some(e.trajectory.as_ref().ok()?.distance))
        })
        .column("distance there and back [sigma]", |p| {
            let errors = p.errors.as_ref();
            errors.and_then(|e| e.reversibility.as_ref().ok().copied())
        })
        .column("failure", |p| p.failure().map_or("", |failed| failed.reason.as_str()))
        .table()
}

type Pick = fn(&Measured) -> Estimate;

/// The measured values: name, unit and where they stand.
const VALUES: [(&str, &str, Pick); 4] = [
    ("T", "epsilon/k_B", |m| m.temperature),
    ("T_conf", "epsilon/k_B", |m| m.configurational_temperature),
    ("U", "epsilon per atom", |m| m.potential_energy),
    ("P", "epsilon/sigma^3", |m| m.pressure),
];

/// The name of a choice as the scene file has it.
fn word(choice: &impl Serialize) -> String {
    match serde_json::to_value(choice) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

/// The marks of a panel.
pub(super) fn panel(chart: &Chart, panel: &Panel) -> Table {
    Table::rows_of(&*panel.name, &panel.marks)
        .column("number", |m| m.number)
        .column("settings", |m| chart.label(m.number))
        .column("wall median [s per atom and tau]", |m| m.wall)
        .column("wall lowest [s per atom and tau]", |m| m.wall_range.map(|r| r.0))
        .column("wall highest [s per atom and tau]", |m| m.wall_range.map(|r| r.1))
        .column("pair forces per atom and tau", |m| m.pair_forces)
        .column(&panel.label, |m| m.error)
        .column("standard error", |m| m.standard_error.filter(|e| e.is_finite()))
        .column("on the front by wall time", |m| m.on_wall_front)
        .column("on the front by pair forces", |m| m.on_forces_front)
        .column("failure", |m| m.failure.as_deref().unwrap_or_default())
        .table()
}
