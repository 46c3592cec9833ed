//! The numbers of a chart as tables.

use serde::Serialize;

use super::point::Outcome;
use super::{Chart, Panel};
use crate::files::{TextTable, exact, exact_or_empty};
use crate::lab::Value;

/// Every point with everything that is known of it.
pub(super) fn points(chart: &Chart) -> TextTable {
    let header = [
        "number",
        "engine",
        "settings",
        "integrator",
        "dt [tau]",
        "truncation",
        "r_cut [sigma]",
        "tail",
        "precision",
        "list",
        "skin [sigma]",
        "wall median [s per atom and tau]",
        "wall lowest [s per atom and tau]",
        "wall highest [s per atom and tau]",
        "timings",
        "force evaluations per tau",
        "pair forces per atom and tau",
        "relative force error, same model",
        "relative force error, untruncated",
        "measured time [tau]",
        "T [epsilon/k_B]",
        "T standard error",
        "T n_eff",
        "T_conf [epsilon/k_B]",
        "T_conf standard error",
        "T_conf n_eff",
        "U [epsilon per atom]",
        "U standard error",
        "U n_eff",
        "P [epsilon/sigma^3]",
        "P standard error",
        "P n_eff",
        "energy RMS [epsilon per atom]",
        "energy drift [epsilon/tau per atom]",
        "energy drift standard error",
        "trajectory error [sigma]",
        "distance there and back [sigma]",
        "failure",
    ];
    let mut table = TextTable::new("points", &header);
    for point in &chart.points {
        let s = &point.settings;
        let cost = point.cost();
        let errors = point.errors.as_ref();
        let measured = point.measured();
        let wall = |pick: fn(&lennard_core::stopwatch::Spread) -> f64| {
            exact_or_empty(cost.as_ref().map(|c| pick(&c.wall)))
        };
        let mut row = vec![
            point.number.to_string(),
            point.engine.clone().unwrap_or_else(|| "lennard".into()),
            point.label.clone(),
            s.integrator.name().to_owned(),
            exact(s.dt),
            word(&s.truncation.kind),
            exact(s.truncation.r_cut),
            s.truncation.tail_correction.to_string(),
            s.precision.name().to_owned(),
            word(&s.list),
            exact_or_empty(s.skin),
            wall(|w| w.median),
            wall(|w| w.lowest),
            wall(|w| w.highest),
            point.timings.len().to_string(),
            exact_or_empty(cost.map(|c| c.evaluations_per_tau)),
            exact_or_empty(cost.map(|c| c.pair_forces_per_atom_tau)),
            exact_or_empty(errors.map(|e| e.forces.same_model)),
            exact_or_empty(errors.and_then(|e| e.forces.untruncated)),
            exact_or_empty(measured.map(|m| m.time)),
        ];
        let values = [
            measured.map(|m| m.temperature),
            measured.map(|m| m.configurational_temperature),
            measured.map(|m| m.potential_energy),
            measured.map(|m| m.pressure),
        ];
        for v in values {
            row.extend(of_value(v));
        }
        row.extend([
            exact_or_empty(measured.map(|m| m.energy_rms)),
            exact_or_empty(measured.map(|m| m.drift.slope)),
            exact_or_empty(measured.map(|m| m.drift.standard_error)),
            exact_or_empty(errors.and_then(|e| Some(e.trajectory.found()?.distance))),
            exact_or_empty(errors.and_then(|e| e.reversibility.found().copied())),
            match errors.map(|e| &e.measured) {
                Some(Outcome::Failed(failed)) => failed.reason.clone(),
                _ => String::new(),
            },
        ]);
        table.push(row);
    }
    table
}

fn of_value(value: Option<Value>) -> [String; 3] {
    [
        exact_or_empty(value.map(|v| v.mean)),
        exact_or_empty(value.map(|v| v.standard_error)),
        exact_or_empty(value.map(|v| v.n_effective)),
    ]
}

/// The name of a choice as the scene file has it.
fn word(choice: &impl Serialize) -> String {
    match serde_json::to_value(choice) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

/// The marks of a panel.
pub(super) fn panel(chart: &Chart, panel: &Panel) -> TextTable {
    let header = [
        "number",
        "settings",
        "wall median [s per atom and tau]",
        "wall lowest [s per atom and tau]",
        "wall highest [s per atom and tau]",
        "pair forces per atom and tau",
        panel.label,
        "standard error",
        "on the front by wall time",
        "on the front by pair forces",
        "failure",
    ];
    let mut table = TextTable::new(panel.name, &header);
    for mark in &panel.marks {
        table.push([
            mark.number.to_string(),
            label(chart, mark.number),
            exact(mark.wall),
            exact_or_empty(mark.wall_range.map(|r| r.0)),
            exact_or_empty(mark.wall_range.map(|r| r.1)),
            exact(mark.pair_forces),
            exact_or_empty(mark.error),
            exact_or_empty(mark.standard_error),
            mark.on_wall_front.to_string(),
            mark.on_forces_front.to_string(),
            mark.failure.clone().unwrap_or_default(),
        ]);
    }
    table
}

/// The settings of a point in a line, with the engine where it is another.
pub(super) fn label(chart: &Chart, number: usize) -> String {
    let Some(point) = chart.points.iter().find(|p| p.number == number) else {
        return String::new();
    };
    match &point.engine {
        Some(engine) => format!("{engine}: {}", point.label),
        None => point.label.clone(),
    }
}

/// A panel with the settings of its points, for JSON.
#[derive(Serialize)]
pub(super) struct PanelJson<'a> {
    schema: &'static str,
    scene: &'a str,
    #[serde(flatten)]
    panel: &'a Panel,
    settings: Vec<(usize, String)>,
}

/// A panel as a document of its own.
pub(super) fn panel_json<'a>(chart: &'a Chart, panel: &'a Panel) -> PanelJson<'a> {
    PanelJson {
        schema: "lennard-chart-panel/1",
        scene: &chart.scene,
        panel,
        settings: panel
            .marks
            .iter()
            .map(|m| (m.number, label(chart, m.number)))
            .collect(),
    }
}
