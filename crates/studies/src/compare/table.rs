//! The quantities of a run beside their references, for a reader.

use crate::report::{in_units, signed, significant};
use lennard_observables::{Cell, Table};

use super::{ComparedRun, Row, quantity_words};

/// The columns of a reference.
const BESIDE: [&str; 4] = ["Reference", "Difference", "Difference / s.e.", "Allowed"];

/// The rows of a run as a table; `verdict` gives the words of the last column. A brief table fits a terminal: the difference
/// stands beside the one that is allowed.
#[must_use]
pub fn table(rows: &[&Row], is_brief: bool, verdict: impl Fn(&Row) -> String) -> Table {
    let caption = "Digits in brackets are one standard error (s.e.) in the last digits; a number without them has none, and the verdict or a line below says why. Energy and pressure agree within 4 standard errors plus the \
                   uncertainty of the equation of state (for atoms 0.003 ε and 0.005 ε/σ³). c_v agrees within 2 standard errors and 2 %, and transport coefficients within 2 \
                   combined standard errors and 3 %. A tolerance above 5 % of the scale of a quantity is too coarse to tell. The scale is the size of the reference, for U k_B T and for P ρ k_B T.";
    let (name, caption) = if is_brief { ("results", "") } else { ("comparison", caption) };
    let table = Table::rows_of(name, rows)
        .caption(caption)
        .column("Quantity", |r| {
            let mut words = quantity_words(&r.quantity);
            let mut unit = &*r.unit;
            if is_brief {
                words = words.replace("configurational temperature", "T, configurational");
                unit = unit.split(" per ").next().unwrap_or_default();
            }
            if unit.is_empty() { words } else { format!("{words}, {unit}") }
        })
        .measured("Measured", |r| Some(r.mean()))
        .column("Reference", |r| {
            with_or_without_error(r.reference, r.reference_error.filter(|_| !is_brief))
        })
        .column("Difference", |r| match r.difference {
            _ if r.is_in_range() => Cell::figures("in range"),
            Some(difference) if is_brief => Cell::figures(signed(difference, 2)),
            difference => with_or_without_error(difference, r.combined_error),
        })
        .column("Difference / s.e.", |r| {
            let figures = r.in_standard_errors.map(|z| format!("{z:+.1}"));
            figures.map(Cell::figures)
        })
        .column("Allowed", |r| {
            let figures = r.tolerance.map(|t| format!("± {}", significant(t, 2)));
            figures.map(Cell::figures)
        })
        .column("Verdict", |r| Cell::words(verdict(r)).toned(r.verdict.tone()))
        .table();
    match rows.iter().any(|row| row.reference.is_some()) {
        true if is_brief => table.without(&BESIDE[2..3]),
        true => table,
        false => table.without(&BESIDE),
    }
}

/// The primary quantities of a run in units of its substance.
#[must_use]
pub fn physical(run: &ComparedRun) -> Option<Table> {
    let units = run.units?;
    let primary = run.rows.iter().filter(|row| row.primary && units.one(&row.unit).is_some());
    let rows: Vec<&Row> = primary.collect();
    let table = Table::rows_of("physical", &rows)
        .column("Quantity", |r| quantity_words(&r.quantity))
        .measured("Measured", |r| Some(r.mean()))
        .column("Unit", |r| r.unit.as_str());
    Some(in_units(table.table(), &units))
}

fn with_or_without_error(value: Option<f64>, error: Option<f64>) -> Cell {
    match (value, error) {
        (Some(value), Some(error)) => Cell::measured(value, error),
        (value, _) => Cell::rounded(value, 5),
    }
}
