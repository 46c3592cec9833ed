//! The tables of the fluid part, as CSV and on the page.

use lennard_observables::{Cell, RowsOf, Table, Tone};

use super::limit::{self, FluidLimit};
use super::run::{FluidRun, Outcome};
use super::start::{self, STATES, TRUNCATIONS};
use super::study::{FluidStudy, SHOWN_TRUNCATION, limit_at};
use crate::report::{Drawn, Given, significant};
use crate::stability::groups::{Group, groups};

/// The state points in names of files.
const PLACES: [&str; 3] = ["triple-point", "t-1.5", "t-5"];

fn in_words(outcome: &Outcome) -> String {
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

/// Adds what the text of the page names on the fluid.
pub(crate) fn give(study: &FluidStudy, given: &mut Given) {
    let groups = groups();
    let tables = csv(study).into_iter().map(|table| extended(study, &groups, table));
    given.tables.extend(tables);
    given.tables.extend([limits_on_page(study), cost_on_page(study), past_on_page(study)]);
    given.words.extend([
        ("atoms", start::ATOMS.to_string()),
        ("density", start::DENSITY.to_string()),
        ("r_cut", start::R_CUT.to_string()),
        ("allowed change", (100.0 * limit::ALLOWED_CHANGE).to_string()),
        ("least time", limit::LEAST_TIME.to_string()),
        ("least steps", limit::LEAST_STEPS.to_string()),
    ]);
    let left_out = study.left_out.iter();
    let left_out = left_out.map(|(name, reason)| format!("Left out: `{name}`: {reason}."));
    given.lists.push(("left out", left_out.collect()));
}

/// A table with the columns that are drawn alone.
fn extended(study: &FluidStudy, groups: &[Group], table: Table) -> Table {
    let place = |state: &str| STATES.iter().position(|s| s.name == state).unwrap_or_default();
    let group = |method: &str| {
        let has = |group: &Group| group.members.iter().any(|e| e.spec.name == method);
        groups.iter().position(has).unwrap_or_default()
    };
    let of_methods = |table: Table, methods: Vec<&'static str>| {
        let of_rows: Vec<usize> = methods.iter().map(|method| group(method)).collect();
        let stands = |(m, g): (&&str, &usize)| groups[*g].representative().spec.name == *m;
        let drawn = methods.iter().zip(&of_rows).map(stands);
        let table = table.and("drawn", drawn.map(|drawn| if drawn { "yes" } else { "no" }));
        let names = of_rows.iter().map(|g| groups[*g].name.as_str());
        table.and("group", names).and("index", of_rows.iter().copied())
    };
    let of_runs = |table: Table, runs: &[&FluidRun]| {
        let table = table
            .and("failed", runs.iter().map(|r| Some(r.dt).filter(|_| !r.completed())))
            .and("|drift|", runs.iter().map(|r| r.drift.map(f64::abs)))
            .and("note", runs.iter().map(|r| format!("{}, dt = {}", r.method, r.dt)))
            .and("place", runs.iter().map(|r| PLACES[place(r.state)]));
        of_methods(table, runs.iter().map(|r| r.method).collect())
    };
    match table.name.as_str() {
        "fluid" => of_runs(table, &study.runs.iter().collect::<Vec<_>>()),
        "fluid-precision" => {
            let runs: Vec<&FluidRun> = study.double.iter().chain(&study.mixed).collect();
            let last = study.double.last().and_then(|r| Some((r.dt, r.fluctuation?)));
            let law = |r: &&FluidRun| last.map(|(dt, y)| y * (r.dt / dt).powi(2));
            of_runs(table.and("dt² law", runs.iter().map(law)), &runs)
        }
        "fluid-limits" => {
            let all = || study.limits.iter();
            let table = table
                .and("T", all().map(|l| STATES[place(l.state)].temperature))
                .and("middle", all().map(FluidLimit::middle));
            of_methods(table, all().map(|l| l.method).collect())
        }
        _ => table,
    }
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
fn limits_on_page(study: &FluidStudy) -> Table {
    let mut methods: Vec<&'static str> = Vec::new();
    for l in &study.limits {
        if !methods.contains(&l.method) {
            methods.push(l.method);
        }
    }
    let caption = "Largest stable dt in τ, ρ* = 0.8442, 256 atoms, cutoff 2.5 σ (`fluid-limits.csv` has both \
                   ends of each bracket and how the run beyond it failed). The steps of methods with several \
                   force evaluations per step are not comparable without that number.";
    let mut table = Table::rows_of("limits-on-the-fluid", &methods)
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
fn cost_on_page(study: &FluidStudy) -> Table {
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
fn past_on_page(study: &FluidStudy) -> Table {
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
