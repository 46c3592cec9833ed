//! The tables of the fluid part, as files and on the page.

use lennard_forcefield::Precision;
use lennard_observables::{Cell, Table, Tone};

use super::limit::{self, FluidLimit};
use super::run::{BELOW, FluidRun, PAST, SHOWN, SMALL};
use crate::claims::Measured;
use crate::lists::unique;
use crate::report::significant;
use crate::stability::groups::{group_of, stands_for_itself};

/// Columns of runs that the page leaves to the files.
const OF_FILES: [&str; 12] = [
    "part",
    "precision",
    "truncation",
    "temperature error / T",
    "its error",
    "failed",
    "|drift|",
    "note",
    "place",
    "drawn",
    "group",
    "index",
];

/// The runs, and the law dt² of the energy at small steps.
fn of_runs<'a>(name: &str, runs: impl Iterator<Item = &'a FluidRun> + Clone) -> Table {
    let small = runs.clone().filter(|r| r.part == SMALL && r.precision == Precision::Double);
    let last = small.last().and_then(|r| Some((r.dt, r.fluctuation?)));
    let is_small = |r: &FluidRun| r.part == SMALL;
    Table::rows_of(name, &runs.collect::<Vec<_>>())
        .column("part", |r| r.part)
        .column("method", |r| r.method)
        .column("precision", |r| r.precision.name())
        .column("state", |r| format!("T* = {}", r.temperature))
        .column("truncation", |r| r.truncation)
        .column("dt / limit", |r| Cell::rounded(r.past, 3))
        .column("dt [τ]", |r| Cell::rounded(r.dt, 2))
        .column("steps", |r| r.steps)
        .column("outcome", |r| r.failure.as_deref().unwrap_or("completed"))
        .column("drift [ε/τ]", |r| Cell::rounded(r.drift.map(|d| d.mean), 2))
        .column("drift error", |r| Cell::rounded(r.drift.map(|d| d.standard_error), 1))
        .column("energy rms [ε]", |r| Cell::rounded(r.fluctuation, 2))
        .column("dt² law", |r| {
            last.filter(|_| is_small(r)).map(|(dt, rms)| rms * (r.dt / dt).powi(2))
        })
        .column("energy change [ε]", |r| Cell::rounded(r.change, 2))
        .column("temperature error / T", |r| r.temperature_error.map(|e| e.mean))
        .column("its error", |r| r.temperature_error.map(|e| e.standard_error))
        .column("momentum per atom", |r| Cell::rounded(r.momentum, 1))
        .column("force evaluations per step", |r| Cell::rounded(r.evaluations_per_step, 3))
        .column("failed", |r| r.failure.as_ref().map(|_| r.dt))
        .column("|drift|", |r| r.drift.map(|d| d.mean.abs()))
        .column("note", |r| format!("{}, dt = {}", r.method, r.dt))
        .column("place", |r| format!("t-{}", r.temperature))
        .column("drawn", |r| if stands_for_itself(r.method) { "yes" } else { "no" })
        .column("group", |r| group_of(r.method).1.name.as_str())
        .column("index", |r| group_of(r.method).0)
        .table()
}

/// Adds all tables.
pub(super) fn add(found: &mut Measured, runs: &[FluidRun], limits: &[FluidLimit]) {
    let of_limits = Table::rows_of("fluid-limits", limits)
        .column("method", |l| l.last.method)
        .column("state", |l| format!("T* = {}", l.last.temperature))
        .column("truncation", |l| l.last.truncation)
        .column("stable dt [τ]", |l| l.stable)
        .column("unstable dt [τ]", |l| l.unstable)
        .column("at the unstable dt", |l| {
            let change = significant(l.last.change.unwrap_or(f64::NAN), 2);
            let changed = || format!("energy changed by {change} ε per atom");
            l.unstable.map(|_| l.last.failure.clone().unwrap_or_else(changed))
        })
        .column("energy change there [ε]", |l| l.unstable.and(l.last.change))
        .column("T", |l| l.last.temperature)
        .column("middle", FluidLimit::middle)
        .column("drawn", |l| if stands_for_itself(l.last.method) { "yes" } else { "no" })
        .column("group", |l| group_of(l.last.method).1.name.as_str())
        .column("index", |l| group_of(l.last.method).0);
    found.tables.extend([of_runs("fluid", runs.iter()), of_limits.table()]);

    let at_one_step =
        |r: &&FluidRun| r.part == BELOW && r.truncation == SHOWN.spec().name && r.dt == 0.004;
    let caption = "Cost and quality at the same step, force-shifted. Evaluations include the two that a product with \
                   the Hessian takes; implicit Euler solves a nonlinear system in each step.";
    let cost = of_runs("cost", runs.iter().filter(at_one_step)).without(&["dt / limit", "dt² law"]);
    let cost = Table { caption: caption.into(), ..cost };
    let caption = format!(
        "What happens past the limit: {} steps at multiples of the largest stable step. A run is \
         stopped as soon as its energy has run away, or where method or forces report a number that is not finite. No \
         file gets such a number.",
        4 * limit::LEAST_STEPS
    );
    let past = of_runs("past-the-limit", runs.iter().filter(|r| r.part == PAST));
    let past = Table { caption, ..past }.without(&[
        "state",
        "drift",
        "drift error",
        "energy rms",
        "dt² law",
        "momentum per atom",
    ]);
    let on_page = [cost, past].map(|table| table.without(&OF_FILES));
    found.given.tables.extend(on_page);
    found.given.tables.push(largest_steps(limits));
    found.word("allowed change", (100.0 * limit::ALLOWED_CHANGE).to_string());
    found.word("least time", limit::LEAST_TIME.to_string());
    found.word("least steps", limit::LEAST_STEPS.to_string());
}

/// The largest stable steps: one row per method, one column per state point, then the other truncations.
fn largest_steps(limits: &[FluidLimit]) -> Table {
    let methods = unique(limits.iter().map(|l| l.last.method));
    let mut places = unique(limits.iter().map(|l| (l.last.temperature, l.last.truncation)));
    let is_other = |truncation: &str| truncation != SHOWN.spec().name;
    places.sort_by(|a, b| a.0.total_cmp(&b.0).then(is_other(a.1).cmp(&is_other(b.1))));
    let caption = "Largest stable dt in τ (`fluid-limits.csv` has both ends of each bracket and how the run beyond it \
                   failed). The steps of methods with several force evaluations per step are not comparable without \
                   that number.";
    let mut table = Table::rows_of("limits-on-the-fluid", &methods)
        .caption(caption)
        .column("Method", |method| format!("`{method}`"));
    for place in places {
        let is_here = |l: &&FluidLimit| (l.last.temperature, l.last.truncation) == place;
        let here: Vec<&FluidLimit> = limits.iter().filter(is_here).collect();
        table = table.column(&format!("T* = {}, {}", place.0, place.1), |method| {
            let limit = here.iter().find(|l| l.last.method == *method)?;
            Some(match (limit.middle(), limit.stable) {
                (Some(middle), _) => Cell::rounded(middle, 2),
                (None, Some(stable)) => Cell::figures(format!("> {}", significant(stable, 2))),
                (None, None) => Cell::figures("none").toned(Tone::Bad),
            })
        });
    }
    table.table()
}
