//! The outcome as text and as JSON.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::groups::{Row, Standing, Sums, by_quantity, by_state, repeats};
use super::judge::Judged;

/// Cells shown in the text; the JSON has all.
const SHOWN: usize = 60;

/// A cell is beyond chance where even one among all cells would be this improbable.
const BEYOND_CHANCE: f64 = 1e-3;

/// Probability that a cell with right errors is listed.
/// Three tails count 0.05 % each: two of the share within one error, one of the share within two.
/// The two tails of χ² count 0.1 % each.
const LISTED_BY_CHANCE: f64 = 3.5e-3;

/// What the judged cells add up to.
pub struct Summary {
    lengths: Vec<u64>,
    judged: Vec<Judged>,
    quantities: Vec<Row>,
    states: Vec<Row>,
}

impl Summary {
    /// Adds up.
    #[must_use]
    pub fn new(judged: Vec<Judged>, lengths: &[u64]) -> Self {
        Self {
            quantities: by_quantity(&judged, lengths),
            states: by_state(&judged, lengths),
            lengths: lengths.to_vec(),
            judged,
        }
    }

    /// Cells outside the range that chance leaves, the least probable first.
    fn listed(&self) -> Vec<(&Judged, f64)> {
        let mut listed: Vec<_> =
            (self.judged.iter()).filter_map(|one| Some((one, one.worst()?))).collect();
        listed.sort_by(|a, b| a.1.total_cmp(&b.1).then(b.0.given.cmp(&a.0.given)));
        listed
    }

    /// Whether a fault of this probability stays improbable among all cells.
    fn beyond_chance(&self, probability: f64) -> bool {
        probability * (self.judged.len() as f64) < BEYOND_CHANCE
    }

    /// Groups outside their bars, the farthest first: name, length and sums.
    fn failed_groups(&self) -> Vec<(&str, u64, &Sums)> {
        let mut failed = Vec::new();
        for row in self.quantities.iter().chain(&self.states) {
            for (sums, &length) in row.sums.iter().zip(&self.lengths) {
                if let Standing::Outside(far) = sums.standing() {
                    failed.push((far, row.name.as_str(), length, sums));
                }
            }
        }
        failed.sort_by(|a, b| b.0.total_cmp(&a.0));
        failed.into_iter().map(|(_, n, l, s)| (n, l, s)).collect()
    }

    /// Groups and cells that fail: groups outside their bars and cells beyond chance.
    #[must_use]
    pub fn failures(&self) -> (usize, usize) {
        let cells = self.listed().iter().filter(|(_, p)| self.beyond_chance(*p)).count();
        (self.failed_groups().len(), cells)
    }

    /// The text: both tables, and what fails.
    #[must_use]
    pub fn text(&self, origin: &str) -> String {
        let mut text = format!(
            "{origin}\n\nEach entry: share of the seeds within one / two printed errors of the long-run mean (68 / 95 % where errors\n\
             are right), scatter of the seeds in printed errors (1 where they are right; median over the cells), number of\n\
             printed errors, and runs without one. ✗: within one error less than 60 or more than 76 %, or within two less\n\
             than 92 %; ~: the same, but chance may do it with so few numbers.\n\n"
        );
        self.table(&mut text, "quantity, all states and ensembles", &self.quantities);
        self.table(&mut text, "state and ensemble, all quantities", &self.states);
        self.list_groups(&mut text);
        self.list_cells(&mut text);
        text
    }

    fn list_groups(&self, text: &mut String) {
        let failed = self.failed_groups();
        let _ = writeln!(text, "{} groups outside their bars, the farthest first:\n", failed.len());
        for (name, length, sums) in &failed {
            let original = repeats(name);
            if !failed.iter().any(|f| Some(f.0) == original && f.1 == *length) {
                let _ = writeln!(text, "- {name}, {length} steps: {}", entry(sums));
            }
        }
    }

    fn list_cells(&self, text: &mut String) {
        let listed = self.listed();
        let (all, (_, beyond)) = (self.judged.len(), self.failures());
        let _ = writeln!(
            text,
            "\n{} of {all} cells are outside the range of right errors; chance lists about {:.0}. {beyond} are beyond chance (!).\n\
             The least probable first, with the scatter and the mean distance from the long-run mean in printed errors:\n",
            listed.len(),
            all as f64 * LISTED_BY_CHANCE,
        );
        let news: Vec<&(&Judged, f64)> = (listed.iter())
            .filter(|(one, _)| {
                let original = repeats(&one.quantity);
                let same = |o: &Judged| o.cell == one.cell && Some(o.quantity.as_str()) == original;
                !listed.iter().any(|(other, _)| same(other))
            })
            .collect();
        for (one, probability) in news.iter().take(SHOWN) {
            let mark = if self.beyond_chance(*probability) { "!" } else { "" };
            let what: Vec<&str> = one.faults.iter().map(|fault| fault.what.as_str()).collect();
            let _ = writeln!(
                text,
                "- {mark}{}, {}: {}; {} numbers{}, distance {:+.2}, {}",
                one.cell.folder(),
                one.quantity,
                what.join(", "),
                one.given,
                one.scatter().map_or(String::new(), |r| format!(", scatter {r:.2}")),
                one.offset,
                chance(*probability),
            );
        }
        if news.len() > SHOWN {
            let _ = writeln!(text, "- and {} more, in coverage.json", news.len() - SHOWN);
        }
    }

    fn table(&self, text: &mut String, heading: &str, rows: &[Row]) {
        let _ = write!(text, "| {heading} |");
        for length in &self.lengths {
            let _ = write!(text, " {length} steps |");
        }
        let _ = writeln!(text, "\n|---|{}", "---|".repeat(self.lengths.len()));
        for row in rows {
            let entries: Vec<String> = row.sums.iter().map(entry).collect();
            let _ = writeln!(text, "| {} | {} |", row.name, entries.join(" | "));
        }
        text.push('\n');
    }

    /// All cells and both tables.
    #[must_use]
    pub fn json(&self, origin: &str) -> Value {
        let rows = |rows: &[Row]| -> Vec<Value> {
            let sums = |(sums, length): (&Sums, &u64)| {
                json!({
                    "steps": length, "given": sums.given, "without": sums.without, "within": sums.within,
                    "scatter": sums.scatter(), "fails": matches!(sums.standing(), Standing::Outside(_)),
                })
            };
            (rows.iter())
                .map(|row| {
                    let by_length: Vec<Value> =
                        row.sums.iter().zip(&self.lengths).map(sums).collect();
                    json!({"name": row.name, "lengths": by_length})
                })
                .collect()
        };
        let cells: Vec<Value> = (self.judged.iter())
            .map(|one| {
                let faults: Vec<Value> = (one.faults.iter())
                    .map(|fault| json!({"what": fault.what, "probability": fault.probability}))
                    .collect();
                json!({
                    "state": one.cell.state.name, "ensemble": one.cell.ensemble.name(), "steps": one.cell.length,
                    "quantity": one.quantity, "given": one.given, "without": one.without, "within": one.within,
                    "distance": one.offset, "scatter": one.scatter(), "chi_squared": one.chi_squared,
                    "degrees_of_freedom": one.degrees, "faults": faults,
                    "beyond_chance": one.worst().is_some_and(|p| self.beyond_chance(p)),
                })
            })
            .collect();
        json!({
            "origin": origin, "quantities": rows(&self.quantities), "states": rows(&self.states), "cells": cells,
        })
    }
}

/// A probability, where it is large enough to mean anything.
fn chance(probability: f64) -> String {
    const LEAST: f64 = 1e-20;
    if probability < LEAST {
        format!("probability below {LEAST:.0e}")
    } else {
        format!("probability {probability:.0e}")
    }
}

fn entry(sums: &Sums) -> String {
    if sums.given + sums.without == 0 {
        return "–".to_owned();
    }
    let mut text = String::new();
    if sums.given > 0 {
        let mark = match sums.standing() {
            Standing::Inside => "",
            Standing::Chance => "~ ",
            Standing::Outside(_) => "✗ ",
        };
        let _ = write!(text, "{mark}{:.0} / {:.0} %", 100.0 * sums.share(0), 100.0 * sums.share(1));
        if let Some(ratio) = sums.scatter() {
            let _ = write!(text, ", {ratio:.2}");
        }
        let _ = write!(text, ", {}", sums.given);
    }
    if sums.without > 0 {
        let _ = write!(text, " ({} none)", sums.without);
    }
    text
}
