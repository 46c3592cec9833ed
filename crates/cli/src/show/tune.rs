//! Settings for an accuracy, as a person reads them.

use lennard_studies::lab::Cost;
use lennard_studies::tune::Tuning;

use super::{duration, table};

/// What was chosen, what it errs and what it costs.
pub fn tuning(tuning: &Tuning) {
    println!("{}", console::style(&tuning.scene).bold());
    println!(
        "  ρ = {:.4}, T = {:.4}; U and P wanted are those of {}",
        tuning.density, tuning.temperature, tuning.about
    );
    println!(
        "  chosen: {}, {}",
        tuning.label,
        lennard_report::counted(tuning.threads, "thread")
    );
    println!("  measured against: {}", tuning.safest);
    let mut errors = table(
        &[
            "error of",
            "target",
            "predicted",
            "measured",
            "planned run",
            "unit",
        ],
        1..5,
    );
    for row in &tuning.rows {
        let j = &row.judged;
        errors.add_row([
            j.quantity.replace('_', " "),
            format!("{:.1e}", j.target),
            with_error(j.predicted, j.predicted_error),
            with_error(j.measured, j.measured_error),
            row.planned_error
                .map_or_else(|| "–".into(), |e| format!("± {e:.1e}")),
            j.unit.clone(),
        ]);
    }
    println!("\n{errors}");
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
    let mut costs = table(&["settings", "an atom and τ", "range", "relative"], 1..4);
    let chosen = tuning.cost.wall.median;
    let mut add = |name: &str, cost: &Cost| {
        let wall = &cost.wall;
        costs.add_row([
            name.to_owned(),
            duration(wall.median),
            format!("{} to {}", duration(wall.lowest), duration(wall.highest)),
            format!("{:.2}", wall.median / chosen),
        ]);
    };
    add("chosen", &tuning.cost);
    if let Some(usual) = &tuning.usual_cost {
        add("r_cut 2.5, dt 0.004, double", usual);
    }
    add("safest", &tuning.safest_cost);
    println!("\n{costs}");
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
        println!("  note: {note}");
    }
    println!("  took {}", duration(tuning.seconds));
}

/// `+1.2e-4 ± 3.0e-5`, in powers of ten: errors are small.
fn with_error(mean: f64, error: f64) -> String {
    if error == 0.0 {
        return format!("{mean:+.1e}");
    }
    format!("{mean:+.1e} ± {error:.0e}")
}
