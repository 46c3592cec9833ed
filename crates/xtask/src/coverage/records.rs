//! What runs printed: their averages, by state, ensemble and length.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::plan::Cell;
use super::runner::Run;

/// An average as a run prints it.
#[derive(Debug, Clone, PartialEq)]
pub struct Average {
    /// The mean, where one is printed.
    pub mean: Option<f64>,
    /// Its printed error, where there is one.
    pub error: Option<f64>,
    /// What the run says about it; the reason why there is no error, among others.
    pub standing: String,
}

/// What one run printed.
#[derive(Debug, Clone, Default)]
pub struct Printed {
    /// Conserved energy, ε per particle.
    pub energy: f64,
    /// Its averages by name.
    pub averages: BTreeMap<String, Average>,
}

/// All runs of a cell.
#[derive(Debug, Clone)]
pub struct Sample {
    /// The cell.
    pub cell: Cell,
    /// Its finished runs.
    pub runs: Vec<Printed>,
}

/// The energy that a run conserves.
pub const CONSERVED: &str = "conserved_energy";

/// Reads the finished runs below a folder; cells without any are left out. The second value names the machine and the
/// version of the program.
///
/// # Errors
///
/// A record without averages.
pub fn read(runs: &[Run], root: &Path) -> Result<(Vec<Sample>, String), String> {
    let mut samples: Vec<Sample> = Vec::new();
    let mut origin = String::new();
    for run in runs {
        let Some(record) = run.record(root) else {
            continue;
        };
        if origin.is_empty() {
            let text = |value: &Value| value.as_str().unwrap_or("?").to_owned();
            origin = format!(
                "lennard {}, {} ({})",
                text(&record["version"]),
                text(&record["host"]["cpu"]),
                text(&record["host"]["isa"])
            );
        }
        let printed = printed(&record)
            .ok_or_else(|| format!("{}, run {}: no averages", run.cell.folder(), run.number))?;
        match samples.last_mut() {
            Some(last) if last.cell == run.cell => last.runs.push(printed),
            _ => samples.push(Sample { cell: run.cell, runs: vec![printed] }),
        }
    }
    Ok((samples, origin))
}

fn printed(record: &Value) -> Option<Printed> {
    let mut averages = BTreeMap::new();
    for (name, entry) in record["averages"].as_object()? {
        let error = entry["standard_error"].as_f64();
        // Records without `standing` say no more than whether there is an error.
        let otherwise = if error.is_some() { "sound" } else { "no error" };
        let standing = entry["standing"].as_str().unwrap_or(otherwise).to_owned();
        averages.insert(name.clone(), Average { mean: entry["mean"].as_f64(), error, standing });
    }
    let energy = averages.get(CONSERVED)?.mean?;
    Some(Printed { energy, averages })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_average_without_an_error_says_why_where_the_record_does() {
        let record = serde_json::json!({"averages": {
            "conserved_energy": {"mean": -3.0, "standard_error": 0.1},
            "pressure": {"mean": 1.0, "standard_error": null, "standing": "too-short", "reason": "…"},
            "temperature": {"mean": 0.7, "standard_error": null},
            "surface_tension_z": {"mean": null, "standard_error": null},
        }});
        let printed = printed(&record).unwrap();
        assert_eq!(printed.energy, -3.0);
        assert_eq!(printed.averages["pressure"].standing, "too-short");
        assert_eq!(printed.averages["temperature"].standing, "no error");
        assert_eq!(printed.averages[CONSERVED].standing, "sound");
        assert_eq!(printed.averages["surface_tension_z"].mean, None);
        assert!(super::printed(&serde_json::json!({"averages": {}})).is_none());
    }
}
