//! The tables of the fluid part, as CSV and on the page.

use lennard_report::{Cell, PageTable, Tone, significant};

use super::fluid::{STATES, TRUNCATIONS};
use super::limit::FluidLimit;
use super::run::{FluidRun, Outcome};
use super::{FluidStudy, SHOWN_TRUNCATION};
use crate::files::{TextTable, exact, exact_or_empty};

pub(crate) fn in_words(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Completed => "completed".to_owned(),
        Outcome::Stopped { step, time, reason } => {
            format!(
                "stopped at step {step} (t = {}): {reason}",
                significant(*time, 3)
            )
        }
        Outcome::RanAway { step, time, change } => format!(
            "ran away: {} ε an atom by step {step} (t = {})",
            significant(*change, 2),
            significant(*time, 3)
        ),
    }
}

fn runs(name: &'static str, runs: &[FluidRun]) -> TextTable {
    let header = [
        "method",
        "state",
        "truncation",
        "dt [tau]",
        "steps",
        "outcome",
        "drift [epsilon/tau/atom]",
        "drift error",
        "energy rms [epsilon/atom]",
        "energy change [epsilon/atom]",
        "temperature error / T",
        "its error",
        "momentum per atom",
        "force evaluations a step",
    ];
    let mut table = TextTable::new(name, &header);
    for r in runs {
        table.push([
            r.method.to_owned(),
            r.state.to_owned(),
            r.truncation.to_owned(),
            exact(r.dt),
            r.steps.to_string(),
            in_words(&r.outcome),
            exact_or_empty(r.drift),
            exact_or_empty(r.drift_error),
            exact_or_empty(r.fluctuation),
            exact_or_empty(r.change),
            exact_or_empty(r.temperature_error),
            exact_or_empty(r.temperature_error_error),
            exact_or_empty(r.momentum),
            exact(r.evaluations_per_step),
        ]);
    }
    table
}

/// All CSV tables of the fluid part.
pub(crate) fn csv(study: &FluidStudy) -> Vec<TextTable> {
    let header = [
        "method",
        "state",
        "truncation",
        "stable dt [tau]",
        "unstable dt [tau]",
        "at the unstable dt",
    ];
    let mut limits = TextTable::new("fluid-limits", &header);
    for l in &study.limits {
        limits.push([
            l.method.to_owned(),
            l.state.to_owned(),
            l.truncation.to_owned(),
            exact_or_empty(l.stable),
            exact_or_empty(l.unstable),
            failure_in_words(l),
        ]);
    }
    let precision: Vec<FluidRun> = study.double.iter().chain(&study.mixed).cloned().collect();
    let mut both = runs("fluid-precision", &precision);
    both.header.insert(0, "precision".to_owned());
    for (i, row) in both.rows.iter_mut().enumerate() {
        let precision = if i < study.double.len() {
            "double"
        } else {
            "mixed"
        };
        row.insert(0, precision.to_owned());
    }
    let past: Vec<FluidRun> = study.past_limit.iter().map(|p| p.1.clone()).collect();
    let mut edge = runs("fluid-past-the-limit", &past);
    edge.header.insert(0, "dt / limit".to_owned());
    for (row, (factor, _)) in edge.rows.iter_mut().zip(&study.past_limit) {
        row.insert(0, exact(*factor));
    }
    vec![runs("fluid", &study.runs), limits, both, edge]
}

fn failure_in_words(limit: &FluidLimit) -> String {
    match (&limit.failure, limit.failure_change) {
        (Some(Outcome::Completed), Some(change)) => {
            format!("energy changed by {} ε an atom", significant(change, 2))
        }
        (Some(outcome), _) => in_words(outcome),
        (None, _) => String::new(),
    }
}

/// The largest stable steps: one row a method, one column a state point, then the other truncations.
pub(crate) fn limits_on_page(study: &FluidStudy, command: &str) -> PageTable {
    let mut methods: Vec<&'static str> = Vec::new();
    for l in &study.limits {
        if !methods.contains(&l.method) {
            methods.push(l.method);
        }
    }
    let columns: Vec<(&str, &str)> = STATES
        .iter()
        .flat_map(|s| {
            let shown = TRUNCATIONS[SHOWN_TRUNCATION].1;
            let others = TRUNCATIONS.iter().map(|t| t.1).filter(move |t| *t != shown);
            std::iter::once(shown)
                .chain(others)
                .map(move |t| (s.name, t))
        })
        .filter(|(s, t)| {
            study
                .limits
                .iter()
                .any(|l| l.state == *s && l.truncation == *t)
        })
        .collect();
    let rows = methods
        .iter()
        .map(|method| {
            let mut row = vec![Cell::text(format!("`{method}`"))];
            row.extend(columns.iter().map(|(s, t)| {
                let limit = study
                    .limits
                    .iter()
                    .find(|l| l.method == *method && l.state == *s && l.truncation == *t);
                match limit {
                    None => Cell::number("–"),
                    Some(l) => match (l.middle(), l.stable) {
                        (Some(m), _) => Cell::number(significant(m, 2)),
                        (None, Some(stable)) => {
                            Cell::number(format!("> {}", significant(stable, 2)))
                        }
                        (None, None) => Cell::toned("none", Tone::Bad),
                    },
                }
            }));
            row
        })
        .collect();
    let mut header = vec!["Method".to_owned()];
    header.extend(columns.iter().map(|(s, t)| format!("{s}, {t}")));
    PageTable {
        caption: "Largest stable dt in τ, ρ* = 0.8442, 256 atoms, cutoff 2.5 σ (`fluid-limits.csv` has both \
                  ends of each bracket and how the run beyond it failed). The steps of methods with several \
                  force evaluations a step are not comparable without that number."
            .into(),
        command: Some(command.to_owned()),
        header,
        rows,
    }
}

/// What a step costs, and what it gives, at one step all can take.
pub(crate) fn cost_on_page(study: &FluidStudy, command: &str) -> PageTable {
    let shown = TRUNCATIONS[SHOWN_TRUNCATION].1;
    let at = 0.004;
    let rows = study
        .runs
        .iter()
        .filter(|r| r.truncation == shown && r.dt == at)
        .map(|r| {
            vec![
                Cell::text(format!("`{}`", r.method)),
                Cell::number(r.state),
                Cell::number(significant(r.dt, 2)),
                Cell::number(significant(r.evaluations_per_step, 3)),
                Cell::number(r.fluctuation.map_or("–".into(), |v| significant(v, 2))),
                Cell::number(r.drift.map_or("–".into(), |v| significant(v, 2))),
                Cell::number(r.drift_error.map_or("–".into(), |v| significant(v, 1))),
                Cell::number(r.momentum.map_or("–".into(), |v| significant(v, 1))),
            ]
        })
        .collect();
    PageTable {
        caption: "Cost and quality at the same step, force-shifted. Evaluations include the two that a \
                  product with the Hessian takes; implicit Euler solves a nonlinear system in each step."
            .into(),
        command: Some(command.to_owned()),
        header: [
            "Method", "State", "dt / τ", "Force evaluations a step", "Energy RMS / ε", "Drift / ε/τ", "± ", "|Σmv| an atom",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
    }
}

/// What happens past the limit.
pub(crate) fn past_on_page(study: &FluidStudy, command: &str) -> PageTable {
    let rows = study
        .past_limit
        .iter()
        .map(|(factor, r)| {
            let text = match (&r.outcome, r.change) {
                (Outcome::Completed, Some(change)) => {
                    format!(
                        "completed, energy changed by {} ε an atom",
                        significant(change, 2)
                    )
                }
                (outcome, _) => in_words(outcome),
            };
            vec![
                Cell::text(format!("`{}`", r.method)),
                Cell::number(significant(*factor, 3)),
                Cell::number(significant(r.dt, 2)),
                Cell::text(text),
            ]
        })
        .collect();
    PageTable {
        caption: format!(
            "What happens past the limit: {} steps near the triple point at multiples of the largest stable \
             step. A run is stopped as soon as its energy has run away, or by the message of the method or of the \
             forces where a number would not be finite; no file gets such a number.",
            super::limit::LEAST_STEPS * 4
        ),
        command: Some(command.to_owned()),
        header: ["Method", "dt / limit", "dt / τ", "What happens"]
            .map(str::to_owned)
            .to_vec(),
        rows,
    }
}
