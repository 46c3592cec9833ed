//! The tables of the fluid part, as CSV and on the page.

use crate::report::significant;
use lennard_core::{Cell, RowsOf, Table, Tone};

use super::limit::FluidLimit;
use super::run::{FluidRun, Outcome};
use super::start::{STATES, TRUNCATIONS};
use super::study::{FluidStudy, SHOWN_TRUNCATION, limit_at};

pub(crate) fn in_words(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Completed => "completed".to_owned(),
        Outcome::Stopped { step, time, reason } => {
            format!("stopped at step {step} (t = {}): {reason}", significant(*time, 3))
        }
        Outcome::RanAway { step, time, change } => format!(
            "ran away: {} ε per atom by step {step} (t = {})",
            significant(*change, 2),
            significant(*time, 3)
        ),
    }
}

/// Adds the columns of a run to a table whose items have one.
fn of_runs<'a, T>(table: RowsOf<'a, T>, run: impl Fn(&'a T) -> &'a FluidRun) -> Table {
    table
        .column("method", |i| run(i).method)
        .column("state", |i| run(i).state)
        .column("truncation", |i| run(i).truncation)
        .column("dt [tau]", |i| run(i).dt)
        .column("steps", |i| run(i).steps)
        .column("outcome", |i| in_words(&run(i).outcome))
        .column("drift [epsilon/tau/atom]", |i| run(i).drift)
        .column("drift error", |i| run(i).drift_error)
        .column("energy rms [epsilon/atom]", |i| run(i).fluctuation)
        .column("energy change [epsilon/atom]", |i| run(i).change)
        .column("temperature error / T", |i| run(i).temperature_error)
        .column("its error", |i| run(i).temperature_error_error)
        .column("momentum per atom", |i| run(i).momentum)
        .column("force evaluations per step", |i| run(i).evaluations_per_step)
        .table()
}

/// All CSV tables of the fluid part.
pub(crate) fn csv(study: &FluidStudy) -> Vec<Table> {
    let limits = Table::rows_of("fluid-limits", &study.limits)
        .column("method", |l| l.method)
        .column("state", |l| l.state)
        .column("truncation", |l| l.truncation)
        .column("stable dt [tau]", |l| l.stable)
        .column("unstable dt [tau]", |l| l.unstable)
        .column("at the unstable dt", failure_in_words)
        .table();
    let double = study.double.iter().map(|r| ("double", r));
    let mixed = study.mixed.iter().map(|r| ("mixed", r));
    let both: Vec<_> = double.chain(mixed).collect();
    let precision = Table::rows_of("fluid-precision", &both).column("precision", |(p, _)| *p);
    let edge = Table::rows_of("fluid-past-the-limit", &study.past_limit)
        .column("dt / limit", |(factor, _)| *factor);
    vec![
        of_runs(Table::rows_of("fluid", &study.runs), |r| r),
        limits,
        of_runs(precision, |(_, r)| r),
        of_runs(edge, |(_, r)| r),
    ]
}

fn failure_in_words(limit: &FluidLimit) -> String {
    match (&limit.failure, limit.failure_change) {
        (Some(Outcome::Completed), Some(change)) => {
            format!("energy changed by {} ε per atom", significant(change, 2))
        }
        (Some(outcome), _) => in_words(outcome),
        (None, _) => String::new(),
    }
}

/// The largest stable steps: one row per method, one column per state point, then the other truncations.
pub(crate) fn limits_on_page(study: &FluidStudy) -> Table {
    let mut methods: Vec<&'static str> = Vec::new();
    for l in &study.limits {
        if !methods.contains(&l.method) {
            methods.push(l.method);
        }
    }
    let caption = "Largest stable dt in τ, ρ* = 0.8442, 256 atoms, cutoff 2.5 σ (`fluid-limits.csv` has both \
                   ends of each bracket and how the run beyond it failed). The steps of methods with several \
                   force evaluations per step are not comparable without that number.";
    let mut table = Table::rows_of("fluid-limits", &methods)
        .caption(caption)
        .column("Method", |method| format!("`{method}`"));
    let others = (0..TRUNCATIONS.len()).filter(|t| *t != SHOWN_TRUNCATION);
    let truncations: Vec<usize> = std::iter::once(SHOWN_TRUNCATION).chain(others).collect();
    for (state, point) in STATES.iter().enumerate() {
        for truncation in &truncations {
            let limit = |method| limit_at(&study.limits, method, state, *truncation);
            if methods.iter().any(|method| limit(method).is_some()) {
                let heading = format!("{}, {}", point.name, TRUNCATIONS[*truncation].1);
                table = table.column(&heading, |method| limit(method).map(limit_cell));
            }
        }
    }
    table.table()
}

fn limit_cell(limit: &FluidLimit) -> Cell {
    match (limit.middle(), limit.stable) {
        (Some(middle), _) => Cell::rounded(middle, 2),
        (None, Some(stable)) => Cell::figures(format!("> {}", significant(stable, 2))),
        (None, None) => Cell::figures("none").toned(Tone::Bad),
    }
}

/// Cost and quality of each method at one step that all can take.
pub(crate) fn cost_on_page(study: &FluidStudy) -> Table {
    let shown = TRUNCATIONS[SHOWN_TRUNCATION].1;
    let here = |r: &&FluidRun| r.truncation == shown && r.dt == 0.004;
    let runs: Vec<&FluidRun> = study.runs.iter().filter(here).collect();
    let caption = "Cost and quality at the same step, force-shifted. Evaluations include the two that a \
                   product with the Hessian takes; implicit Euler solves a nonlinear system in each step.";
    Table::rows_of("cost", &runs)
        .caption(caption)
        .column("Method", |r| format!("`{}`", r.method))
        .column("State", |r| Cell::figures(r.state))
        .column("dt [τ]", |r| Cell::rounded(r.dt, 2))
        .column("Force evaluations per step", |r| Cell::rounded(r.evaluations_per_step, 3))
        .column("Energy RMS [ε]", |r| Cell::rounded(r.fluctuation, 2))
        .column("Drift [ε/τ]", |r| Cell::rounded(r.drift, 2))
        .column("± ", |r| Cell::rounded(r.drift_error, 1))
        .column("|Σmv| per atom", |r| Cell::rounded(r.momentum, 1))
        .table()
}

/// What happens past the limit.
pub(crate) fn past_on_page(study: &FluidStudy) -> Table {
    let caption = format!(
        "What happens past the limit: {} steps near the triple point at multiples of the largest stable \
         step. A run is stopped as soon as its energy has run away, or where method or forces report a number \
         that is not finite. No file gets such a number.",
        super::limit::LEAST_STEPS * 4
    );
    Table::rows_of("past-the-limit", &study.past_limit)
        .caption(caption)
        .column("Method", |(_, r)| format!("`{}`", r.method))
        .column("dt / limit", |(factor, _)| Cell::rounded(*factor, 3))
        .column("dt [τ]", |(_, r)| Cell::rounded(r.dt, 2))
        .column("What happens", |(_, r)| match (&r.outcome, r.change) {
            (Outcome::Completed, Some(change)) => {
                let change = significant(change, 2);
                format!("completed, energy changed by {change} ε per atom")
            }
            (outcome, _) => in_words(outcome),
        })
        .table()
}
