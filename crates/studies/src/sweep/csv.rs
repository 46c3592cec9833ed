//! The table of a sweep for programs, `table.csv`.

use lennard_observables::{Cell, Table};
use lennard_scene::study::SHORT_KEYS;

use super::{SettingValue, SweptPoint};
use crate::compare::ComparedRun;
use crate::lists::unique;

/// Every point with all that it has measured, beside its references.
pub(super) fn table(points: &[SweptPoint]) -> Table {
    let compared =
        |p: &SweptPoint, number: fn(&ComparedRun) -> u64| p.compared.as_ref().map_or(0, number);
    let mean = |p: &SweptPoint, quantity: &str| p.row(quantity).map(|r| r.measured);
    let mut table = Table::rows_of("table", points)
        .column("name", |p| &p.name)
        .column("density", |p| p.state().density)
        .column("temperature", |p| p.state().temperature)
        .column("temperature_whole_steps", |p| mean(p, "temperature"))
        .column("temperature_half_steps", |p| mean(p, "temperature_half_steps"))
        .column("phase", |p| p.state().phase.map_or("unknown", |p| p.describe()))
        .column("steps", |p| compared(p, |c| c.measured_steps))
        .column("atoms", |p| compared(p, |c| c.atoms));
    for key in keys(points) {
        let setting = |p: &SweptPoint| p.settings.iter().find(|s| s.key == key).cloned();
        // The first column has the names of the points.
        let heading = if key == "name" { "row" } else { &key };
        table = table.column(heading, |p| {
            setting(p).map(|setting| match setting.value {
                SettingValue::Number(number) => Cell::from(number),
                SettingValue::Words(words) => Cell::words(words),
            })
        });
    }
    for name in measured(points) {
        table = table.measured(&name, |p| p.row(&name).map(|r| (r.measured, r.standard_error)));
        if points.iter().filter_map(|p| p.row(&name)).any(|r| r.reference.is_some()) {
            table = table
                .column(&format!("{name}_reference"), |p| p.row(&name)?.reference)
                .measured(&format!("{name}_difference"), |p| {
                    let row = p.row(&name)?;
                    row.difference.zip(row.combined_error)
                })
                .column(&format!("{name}_verdict"), |p| p.row(&name).map(|r| r.verdict.words()));
        }
    }
    table.table()
}

/// The keys that a study of its own changes: with a key that has no short name, every key is a column.
fn keys(points: &[SweptPoint]) -> Vec<String> {
    let mut keys = unique(points.iter().flat_map(|p| &p.settings).map(|s| s.key.clone()));
    let is_short = |key: &String| SHORT_KEYS.iter().any(|short| short.name == key);
    if keys.iter().all(is_short) {
        return Vec::new();
    }
    keys.retain(|key| !["density", "temperature"].contains(&key.as_str()));
    keys
}

/// Every quantity that any point has measured, besides its density and temperatures.
fn measured(points: &[SweptPoint]) -> Vec<String> {
    let rows = points.iter().filter_map(|p| p.compared.as_ref()).flat_map(|c| &c.rows);
    let names = rows.map(|row| row.quantity.clone());
    unique(names.filter(|name| name != "density" && !name.starts_with("temperature")))
}
