//! The table of a sweep for programs, `table.csv`.

use lennard_core::{Cell, Table};
use lennard_observables::quantities::{QUANTITIES, Quantity, quantity_of};
use lennard_scene::study::SHORT_KEYS;

use super::{SettingValue, SweptPoint};
use crate::compare::{ComparedRun, Row};

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
    for Quantity { key: quantity, short, .. } in QUANTITIES.iter().filter(|q| !q.short.is_empty()) {
        let of = |p: &SweptPoint, number: fn(&Row) -> Option<f64>| p.row(quantity).and_then(number);
        table = table
            .column(short, |p| mean(p, quantity))
            .column(&format!("{short}_se"), |p| of(p, |r| Some(r.standard_error)))
            .column(&format!("{short}_reference"), |p| of(p, |r| r.reference))
            .column(&format!("{short}_difference"), |p| of(p, |r| r.difference))
            .column(&format!("{short}_difference_se"), |p| of(p, |r| r.combined_error))
            .column(&format!("{short}_verdict"), |p| p.row(quantity).map(|r| r.verdict.words()));
    }
    for quantity in others(points) {
        table = table
            .column(&quantity, |p| mean(p, &quantity))
            .column(&format!("{quantity}_se"), |p| p.row(&quantity).map(|r| r.standard_error));
        let reference = |p: &SweptPoint| p.row(&quantity).and_then(|r| r.reference);
        if points.iter().any(|p| reference(p).is_some()) {
            table = table
                .column(&format!("{quantity}_reference"), reference)
                .column(&format!("{quantity}_verdict"), |p| {
                    p.row(&quantity).map(|r| r.verdict.words())
                });
        }
    }
    table.table()
}

/// The keys that a study of its own changes: with a key that has no short name, every key is a column.
fn keys(points: &[SweptPoint]) -> Vec<String> {
    let mut keys: Vec<String> = Vec::new();
    for setting in points.iter().flat_map(|p| &p.settings) {
        if !keys.contains(&setting.key) {
            keys.push(setting.key.clone());
        }
    }
    let is_short = |key: &String| SHORT_KEYS.iter().any(|short| short.name == key);
    if keys.iter().all(is_short) {
        return Vec::new();
    }
    keys.retain(|key| !["density", "temperature"].contains(&key.as_str()));
    keys
}

/// Every other quantity that any point has measured.
fn others(points: &[SweptPoint]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let rows = points.iter().filter_map(|p| p.compared.as_ref());
    for row in rows.flat_map(|c| &c.rows) {
        let has_columns = quantity_of(&row.quantity).is_some_and(|q| !q.short.is_empty())
            || row.quantity == "density"
            || row.quantity.starts_with("temperature");
        if !has_columns && !names.contains(&row.quantity) {
            names.push(row.quantity.clone());
        }
    }
    names
}
