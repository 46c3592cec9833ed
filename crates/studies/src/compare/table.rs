//! The quantities of a run beside their references, for a reader.

use crate::report::{in_units, significant};
use lennard_observables::{Cell, Table};

use super::{ComparedRun, Row, quantity_words};

/// The rows of a run as a table; `verdict` gives the words of the last column.
#[must_use]
pub fn table(rows: &[&Row], verdict: impl Fn(&Row) -> String) -> Table {
    let caption = "Digits in brackets are one standard error (s.e.) in the last digits; a number without them has none, and the verdict or a line below says why. Energy and pressure agree within 4 standard errors plus the \
                   uncertainty of the equation of state (for atoms 0.003 ε and 0.005 ε/σ³). c_v agrees within 2 standard errors and 2 %, and transport coefficients within 2 \
                   combined standard errors and 3 %. A tolerance above 5 % of the scale of a quantity is too coarse to tell. The scale is the size of the reference, for U k_B T and for P ρ k_B T.";
    Table::rows_of("comparison", rows)
        .caption(caption)
        .column("Quantity", |r| {
            let words = quantity_words(&r.quantity);
            if r.unit.is_empty() { words } else { format!("{words}, {}", r.unit) }
        })
        .measured("Measured", |r| Some((r.measured, r.standard_error)))
        .column("Reference", |r| with_or_without_error(r.reference, r.reference_error))
        .column("Difference", |r| {
            if r.is_in_range() {
                return Cell::figures("in range");
            }
            with_or_without_error(r.difference, r.combined_error)
        })
        .column("Difference / s.e.", |r| {
            let figures = r.in_standard_errors.map(|z| format!("{z:+.1}"));
            figures.map(Cell::figures)
        })
        .column("Tolerance", |r| {
            let figures = r.tolerance.map(|t| format!("± {}", significant(t, 2)));
            figures.map(Cell::figures)
        })
        .column("Verdict", |r| Cell::words(verdict(r)).toned(r.verdict.tone()))
        .table()
}

/// The primary quantities of a run in units of its substance.
#[must_use]
pub fn physical(run: &ComparedRun) -> Option<Table> {
    let units = run.units?;
    let primary = run.rows.iter().filter(|row| row.primary && units.one(&row.unit).is_some());
    let rows: Vec<&Row> = primary.collect();
    let table = Table::rows_of("physical", &rows)
        .column("Quantity", |r| quantity_words(&r.quantity))
        .measured("Measured", |r| Some((r.measured, r.standard_error)))
        .column("Unit", |r| r.unit.as_str());
    Some(in_units(table.table(), &units))
}

fn with_or_without_error(value: Option<f64>, error: Option<f64>) -> Cell {
    match (value, error) {
        (Some(value), Some(error)) => Cell::measured(value, error),
        (value, _) => Cell::rounded(value, 5),
    }
}
