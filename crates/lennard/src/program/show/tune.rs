//! Settings for an accuracy, as a person reads them.

use lennard_core::number::UNKNOWN;
use lennard_core::{Cell, Table};
use lennard_studies::lab::Cost;
use lennard_studies::tune::Tuning;

use super::{duration, table};
use crate::program::out;

/// What was chosen, what it errs and what it costs.
pub fn tuning(tuning: &Tuning) {
    out::heading(&tuning.scene);
    println!(
        "  ρ = {:.4}, T = {:.4}; wanted: U and P of {}",
        tuning.density, tuning.temperature, tuning.about
    );
    println!(
        "  chosen: {}, {}",
        tuning.label,
        lennard_studies::report::counted(tuning.threads, "thread")
    );
    println!("  measured against: {}", tuning.safest);
    let errors = Table::rows_of("errors", &tuning.rows)
        .column("error of", |r| r.judged.quantity.replace('_', " "))
        .column("target", |r| Cell::figures(format!("{:.1e}", r.judged.target)))
        .column("predicted", |r| {
            let j = &r.judged;
            Cell::figures(with_error(j.predicted, j.predicted_error))
        })
        .column("measured", |r| {
            let j = &r.judged;
            Cell::figures(with_error(j.measured, j.measured_error))
        })
        .column("planned run", |r| {
            let figures = r.planned_error.map(|e| format!("± {e:.1e}"));
            figures.map(Cell::figures)
        })
        .column("unit", |r| &r.judged.unit);
    println!("\n{}", table(&errors.table()));
    for row in &tuning.rows {
        if let Some(causes) = &row.causes {
            println!(
                "  {}: truncation {}, time step {}, precision {}",
                row.judged.quantity.replace('_', " "),
                with_error(causes.truncation.mean, causes.truncation.standard_error),
                with_error(causes.step.mean, causes.step.standard_error),
                with_error(causes.precision.mean, causes.precision.standard_error),
            );
        }
    }
    let chosen = tuning.cost.wall.median;
    let usual = tuning.usual_cost.iter();
    let costs: Vec<(&str, &Cost)> = std::iter::once(("chosen", &tuning.cost))
        .chain(usual.map(|usual| ("r_cut 2.5, dt 0.004, double", usual)))
        .chain([("safest", &tuning.safest_cost)])
        .collect();
    let costs = Table::rows_of("costs", &costs)
        .column("settings", |(name, _)| *name)
        .column("per atom and τ", |(_, c)| Cell::figures(duration(c.wall.median)))
        .column("range", |(_, c)| {
            let (low, high) = (duration(c.wall.lowest), duration(c.wall.highest));
            Cell::figures(format!("{low} to {high}"))
        })
        .column("relative", |(_, c)| Cell::figures(format!("{:.2}", c.wall.median / chosen)));
    println!("\n{}", table(&costs.table()));
    for remark in &tuning.speed.remarks {
        println!("  {remark}");
    }
    if let Some([u, p]) = &tuning.usual_errors {
        println!(
            "  errors of r_cut 2.5, dt 0.004 in double, predicted: U {}, P {}",
            with_error(u.mean, u.standard_error),
            with_error(p.mean, p.standard_error)
        );
    }
    for note in &tuning.notes {
        super::note(&format!("note: {note}"));
    }
    println!("  took {}", duration(tuning.seconds));
}

/// `+1.2e-4 ± 3.0e-5`, in powers of ten: errors are small.
fn with_error(mean: f64, error: f64) -> String {
    match (mean.is_finite(), error.is_finite() && error != 0.0) {
        (false, _) => UNKNOWN.into(),
        (true, false) => format!("{mean:+.1e}"),
        (true, true) => format!("{mean:+.1e} ± {error:.0e}"),
    }
}
