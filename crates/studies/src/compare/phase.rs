//! Where a run lies in the phase diagram of its model.

use lennard_literature::{EquationOfState, Phase};
use serde::Serialize;

use super::RunFolder;

/// The thermodynamic state of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateOfMatter {
    /// Density in σ⁻³.
    pub density: f64,
    /// Temperature in ε/k_B: the measured mean.
    pub temperature: f64,
    /// The phase by the equation of state; absent where there is none for the model.
    pub phase: Option<Phase>,
    /// The same in words.
    pub words: String,
}

impl StateOfMatter {
    /// A state by density (σ⁻³) and temperature (ε/k_B).
    #[must_use]
    pub fn new(density: f64, temperature: f64, equation: Option<&dyn EquationOfState>) -> Self {
        let phase = equation.map(|e| e.phase(density, temperature));
        let words = match phase {
            None => "unknown: there is no equation of state for this model".into(),
            Some(Phase::OutsideRange) => equation
                .and_then(|e| e.check(density, temperature).err())
                .map_or_else(
                    || Phase::OutsideRange.describe().to_owned(),
                    |e| e.to_string(),
                ),
            Some(phase) => phase.describe().to_owned(),
        };
        Self {
            density,
            temperature,
            phase,
            words,
        }
    }

    /// Whether a run there may be judged by the equation of state.
    #[must_use]
    pub fn is_single_stable_phase(&self) -> bool {
        self.phase.is_some_and(Phase::is_stable)
    }
}

/// The state of a run at its measured temperature.
#[must_use]
pub fn state_of(run: &RunFolder, equation: Option<&dyn EquationOfState>) -> StateOfMatter {
    let temperature = run.average("temperature").map_or(f64::NAN, |a| a.mean);
    StateOfMatter::new(run.density, temperature, equation)
}
