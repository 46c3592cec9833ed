//! Settings for an accuracy, as a person reads them.

use lennard_core::number::UNKNOWN;
use lennard_observables::{Cell, Table};
use lennard_studies::lab::Cost;
use lennard_studies::report::{Section, counted};
use lennard_studies::tune::{Row, Tuning};

use super::text::duration;

/// What was chosen, what it errs and what it costs.
pub fn tuning(tuning: &Tuning) -> Section {
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
    let causes = |row: &Row| {
        let causes = row.causes.as_ref()?;
        Some(format!(
            "{}: truncation {}, time step {}, precision {}",
            row.judged.quantity.replace('_', " "),
            with_error(causes.truncation.mean, causes.truncation.standard_error),
            with_error(causes.step.mean, causes.step.standard_error),
            with_error(causes.precision.mean, causes.precision.standard_error),
        ))
    };
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
    let usual = tuning.usual_errors.as_ref().map(|[u, p]| {
        format!(
            "errors of r_cut 2.5, dt 0.004 in double, predicted: U {}, P {}",
            with_error(u.mean, u.standard_error),
            with_error(p.mean, p.standard_error)
        )
    });
    Section::new(&tuning.scene)
        .text(format!(
            "ρ = {:.4}, T = {:.4}; wanted: U and P of {}",
            tuning.density, tuning.temperature, tuning.about
        ))
        .text(format!("chosen: {}, {}", tuning.label, counted(tuning.threads, "thread")))
        .text(format!("measured against: {}", tuning.safest))
        .text("")
        .table(errors.table())
        .texts(tuning.rows.iter().filter_map(causes))
        .text("")
        .table(costs.table())
        .texts(tuning.speed.remarks.iter().cloned().chain(usual))
        .texts(tuning.notes.iter().map(|note| format!("note: {note}")))
        .text(format!("took {}", duration(tuning.seconds)))
}

/// `+1.2e-4 ± 3.0e-5`, in powers of ten: errors are small.
fn with_error(mean: f64, error: f64) -> String {
    match (mean.is_finite(), error.is_finite() && error != 0.0) {
        (false, _) => UNKNOWN.into(),
        (true, false) => format!("{mean:+.1e}"),
        (true, true) => format!("{mean:+.1e} ± {error:.0e}"),
    }
}
