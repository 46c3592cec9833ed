//! Finished runs beside the literature: every quantity with its difference in standard errors and a verdict.

mod phase;
mod read;
mod rows;
mod verdict;

pub use phase::{StateOfMatter, state_of};
pub use read::{ReadError, RunFolder};
pub use verdict::{Row, Verdict};

use lennard_literature::{equation_of_state_for, remark_for};
use serde::Serialize;

/// A quantity of the run record in words for a table.
///
/// The two kinetic temperatures are told apart plainly: a finite step makes them differ.
#[must_use]
pub fn quantity_words(name: &str) -> String {
    match name {
        "temperature" => "T, whole steps".into(),
        read::HALF_STEPS => "T, half steps".into(),
        other => other.replace('_', " "),
    }
}

/// A run beside the literature.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedRun {
    /// The folder of the run.
    pub run: String,
    /// The model in words.
    pub model: String,
    /// Particles.
    pub atoms: u64,
    /// Steps of the measured stages.
    pub measured_steps: u64,
    /// Where the run lies.
    pub state: StateOfMatter,
    /// The equation of state that it is judged by; absent where none describes its model, and `remarks` say so.
    pub equation: Option<String>,
    /// Quantity by quantity.
    pub rows: Vec<Row>,
    /// What belongs beside the numbers.
    pub remarks: Vec<String>,
}

/// Compares a finished run.
#[must_use]
pub fn compare(run: &RunFolder) -> ComparedRun {
    let model = lennard_engine::model_kind(&run.scene);
    let equation = equation_of_state_for(model);
    let state = state_of(run, equation.as_ref().ok().copied());
    let mut remarks = Vec::new();
    match &equation {
        Err(none) => remarks.push(format!("not compared with any equation of state: {none}")),
        Ok(equation) => {
            if !state.is_single_stable_phase() {
                remarks.push(format!(
                    "by {} the state ρ = {:.4}, {} = {:.4} is {}: nothing is judged",
                    equation.spec().name,
                    state.density,
                    state.temperature_words(),
                    state.temperature,
                    state.words
                ));
            }
        }
    }
    remarks.extend(remark_for(model));
    let measured = run
        .scene
        .stages
        .iter()
        .filter(|s| s.measure)
        .map(|s| s.steps)
        .sum();
    ComparedRun {
        run: run.folder.display().to_string(),
        model: run.record.model.clone(),
        atoms: run.record.atoms,
        measured_steps: measured,
        equation: equation
            .as_ref()
            .ok()
            .map(|e| format!("{}, doi:{}", e.spec().name, e.spec().doi)),
        rows: rows::all(run, &state, model),
        state,
        remarks,
    }
}
