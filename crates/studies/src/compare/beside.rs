//! Finished runs beside each other: the difference of each from the first, with its error and a verdict.
//!
//! A mean of the first run is the reference of the other runs, so that [`Row`] and its judge serve here too.

use std::collections::{BTreeMap, BTreeSet};

use lennard_observables::Verdict;
use lennard_observables::statistics::Line;
use serde::Serialize;
use serde_json::Value;

use super::own_literature::{OwnValue, same};
use super::verdict::Tolerance;
use super::{ComparedRun, Row, RunFolder};
use crate::report::significant;

/// Two runs agree where their difference is within so many of its standard errors, as energies beside an equation do.
pub(super) const ERRORS: f64 = 4.0;
const ALLOWED: Tolerance = Tolerance::new(ERRORS, 0.0, 0.0);
/// Up to so many runs have a column each, and letters for names.
pub(super) const MOST_COLUMNS: usize = 3;
/// Values of a key are said where they take no more room than so many letters.
const LONGEST: usize = 60;

/// Runs beside each other, and beside a user's own literature.
#[derive(Debug, Clone, Serialize)]
pub struct Beside {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// A short name of each run: a letter, or the folder.
    pub names: Vec<String>,
    /// Each run beside the literature.
    pub runs: Vec<ComparedRun>,
    /// Every quantity that any run measured; empty for one run.
    pub quantities: Vec<Measured>,
    /// Values of a user's own literature, each with a run at its state.
    pub own: Vec<OwnRow>,
    /// Values at whose state no run is.
    pub without_a_run: Vec<OwnValue>,
    /// What the differences say together.
    pub headline: String,
    /// What else is different, and what the errors of differences assume.
    pub remarks: Vec<String>,
    /// The folders of the runs, whose curves are drawn together.
    #[serde(skip)]
    pub(super) folders: Vec<RunFolder>,
}

/// A quantity of each run.
#[derive(Debug, Clone, Serialize)]
pub struct Measured {
    /// Its key.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Whether people look for it first.
    pub primary: bool,
    /// The first run, and every other one beside the first; absent where a run has not measured it.
    pub rows: Vec<Option<Row>>,
}

/// A run beside a value of a user's own literature.
#[derive(Debug, Clone, Serialize)]
pub struct OwnRow {
    /// The place of the run among all.
    pub run: usize,
    /// The value.
    pub given: OwnValue,
    /// The run beside the value.
    #[serde(flatten)]
    pub row: Row,
}

/// Sets finished runs beside each other, and beside values of a user's own.
#[must_use]
pub fn beside(runs: &[RunFolder], own: Vec<OwnValue>) -> Beside {
    let compared: Vec<ComparedRun> = runs.iter().map(super::compare).collect();
    let names: Vec<String> = match runs.len() <= MOST_COLUMNS {
        true => ["A", "B", "C"].into_iter().take(runs.len()).map(str::to_owned).collect(),
        false => compared.iter().map(|run| run.run.clone()).collect(),
    };
    let mut quantities: Vec<Measured> = Vec::new();
    for row in compared.iter().filter(|_| runs.len() > 1).flat_map(|run| &run.rows) {
        match quantities.iter_mut().find(|known| known.quantity == row.quantity) {
            Some(known) => known.primary |= row.primary,
            None => quantities.push(Measured {
                quantity: row.quantity.clone(),
                unit: row.unit.clone(),
                primary: row.primary,
                rows: beside_first(&row.quantity, runs, &compared, &names[0]),
            }),
        }
    }
    quantities.sort_by_key(|quantity| !quantity.primary);
    let (mut rows, mut without_a_run) = (Vec::new(), Vec::new());
    for value in own {
        let before = rows.len();
        let at_state = |run: &usize| {
            let of = &compared[*run].state;
            let is_measured = value.is_at([of.density, of.temperature]);
            is_measured || value.is_at(state(&runs[*run], &compared[*run]))
        };
        let beside = |run| beside_own(&value, run, &runs[run], &compared[run]);
        rows.extend((0..runs.len()).filter(at_state).filter_map(beside));
        if rows.len() == before {
            without_a_run.push(value);
        }
    }
    let mut remarks = what_differs(runs, &compared, &names);
    remarks.extend(runs.split_first().into_iter().flat_map(|(first, others)| {
        others.iter().zip(&names[1..]).filter_map(|(run, name)| dependence(first, run, name))
    }));
    Beside {
        schema: lennard_io::schema!("compare", 1),
        own: rows,
        without_a_run,
        headline: headline(&quantities),
        folders: runs.to_vec(),
        names,
        runs: compared,
        quantities,
        remarks,
    }
}

/// Density and temperature of a run: the temperature of its bath where it has one, which a short run does not measure well.
fn state(run: &RunFolder, compared: &ComparedRun) -> [f64; 2] {
    [compared.state.density, run.bath_temperature().unwrap_or(compared.state.temperature)]
}

/// Whether two runs are shown to be at different states: a measured temperature is so by its error, and without one by nothing.
fn is_elsewhere(one: (&RunFolder, &ComparedRun), other: (&RunFolder, &ComparedRun)) -> bool {
    let ([density, temperature], [of_other, hotter]) =
        (state(one.0, one.1), state(other.0, other.1));
    let error = |run: &RunFolder| match run.bath_temperature() {
        Some(_) => 0.0,
        None => run.temperature().map_or(f64::NAN, |average| average.estimate.standard_error),
    };
    let allowed = ERRORS * error(one.0).hypot(error(other.0));
    let is_hotter_or_colder = (hotter - temperature).abs() > allowed;
    !same(density, of_other) || is_hotter_or_colder && !same(temperature, hotter)
}

/// A mean of a run without a reference.
fn measured(quantity: &str, run: &RunFolder, compared: &ComparedRun) -> Option<Row> {
    let row = compared.rows.iter().find(|row| row.quantity == quantity)?;
    Some(Row { scale: row.scale, ..Row::measured(quantity, run.average(quantity)?) })
}

/// One quantity of all runs, each beside the first run.
fn beside_first(
    quantity: &str,
    runs: &[RunFolder],
    compared: &[ComparedRun],
    name: &str,
) -> Vec<Option<Row>> {
    let rows = runs.iter().zip(compared).map(|(run, compared)| measured(quantity, run, compared));
    let mut rows: Vec<Option<Row>> = rows.collect();
    if let Some(first) = rows[0].clone() {
        for row in rows[1..].iter_mut().flatten().filter(|row| row.is_sound()) {
            if first.is_sound() {
                let (mean, error) = (first.measured, Some(first.standard_error));
                *row = row.clone().against(mean, error, ALLOWED, name);
            } else {
                (row.verdict, row.reason) = (first.verdict, format!("{name}: {}", first.reason));
            }
        }
    }
    rows
}

/// A run beside a value of a user's own; the remark says at which states they are.
fn beside_own(
    own: &OwnValue,
    run: usize,
    folder: &RunFolder,
    compared: &ComparedRun,
) -> Option<OwnRow> {
    let state = compared.state.in_numbers();
    let exact = own.error.map_or("its error is not known, and it counts as exact", |_| "");
    let row = measured(&own.quantity, folder, compared)?
        .against(own.value, own.error, ALLOWED, &own.source)
        .noted(format!("at T = {}, the run at {state}, which is not corrected", own.temperature))
        .noted(exact);
    Some(OwnRow { run, given: own.clone(), row })
}

/// What the differences from the first run say together.
fn headline(quantities: &[Measured]) -> String {
    let primary = quantities.iter().filter(|quantity| quantity.primary);
    let rows = primary.flat_map(|quantity| quantity.rows.iter().flatten());
    let judged: Vec<Verdict> = rows.map(|row| row.verdict).filter(|v| v.is_judged()).collect();
    if judged.is_empty() {
        return String::new();
    }
    let agree = judged.iter().filter(|verdict| **verdict == Verdict::Agrees).count();
    format!("{agree} of {} differences from the first run agree with zero.", judged.len())
}

/// States, models and tables of the scenes that are not the same.
fn what_differs(runs: &[RunFolder], compared: &[ComparedRun], names: &[String]) -> Vec<String> {
    let mut remarks = Vec::new();
    let first = &compared[0];
    let elsewhere = runs.iter().zip(compared).zip(names);
    let elsewhere = elsewhere.filter(|(run, _)| is_elsewhere((&runs[0], first), *run));
    let elsewhere: Vec<&str> = elsewhere.map(|(_, name)| name.as_str()).collect();
    if !elsewhere.is_empty() {
        let (names, first) = (elsewhere.join(", "), &names[0]);
        remarks.push(format!(
            "Not at the state of {first}: {names}. These differences are not of method alone."
        ));
    }
    if compared.iter().any(|run| run.model != first.model) {
        remarks.push("The models differ, and with them U and P.".into());
    }
    let scenes: Vec<_> = runs.iter().map(|run| keys(&run.record.scene)).collect();
    let all: BTreeSet<&String> = scenes.iter().flat_map(BTreeMap::keys).collect();
    let values = |key: &str| -> Vec<Option<String>> {
        scenes.iter().map(|scene| scene.get(key).map(ToString::to_string)).collect()
    };
    let said = |key: &String| {
        let values = values(key);
        let text: Vec<&str> = values.iter().map(|v| v.as_deref().unwrap_or("none")).collect();
        let text = text.join(", ");
        let is_short = text.len() <= LONGEST;
        let words = if is_short { format!("`{key}` ({text})") } else { format!("`{key}`") };
        values.iter().any(|value| *value != values[0]).then_some(words)
    };
    let keys: Vec<String> = all.into_iter().filter_map(said).collect();
    if !keys.is_empty() {
        remarks.push(format!("The scenes differ in {}.", keys.join(", ")));
    }
    remarks
}

/// The keys in the tables of a scene; lists such as its stages are one key.
fn keys(scene: &Value) -> BTreeMap<String, &Value> {
    let tables = scene.as_object().into_iter().flatten();
    let keys = |(table, inner): (&String, _)| match Value::as_object(inner) {
        Some(keys) => keys.iter().map(|(key, value)| (format!("{table}.{key}"), value)).collect(),
        None => vec![(table.clone(), inner)],
    };
    tables.flat_map(keys).collect()
}

/// Whether a run depends on the first: runs of one seed may go the same way for a while, and then their energies correlate.
fn dependence(first: &RunFolder, run: &RunFolder, name: &str) -> Option<String> {
    let seed = (run.record.seed == first.record.seed).then_some(first.record.seed)?;
    let energies = |run: &RunFolder| run.table("measured")?.numbers("potential_energy");
    let common: Vec<(f64, f64)> = energies(first)?.into_iter().zip(energies(run)?).collect();
    let r = Some(Line::through(&common).correlation()).filter(|r| r.is_finite())?;
    let so = match r > 1.0 - 1e-9 {
        true => "they are one trajectory, and equal numbers confirm nothing",
        false => {
            "errors of differences take them for independent, and are too large where r is above zero"
        }
    };
    let r = significant(r, 2);
    Some(format!(
        "{name} begins with the seed of the first run, {seed}. Their U(t) correlate by r = {r}: {so}."
    ))
}
