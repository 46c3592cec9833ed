//! Where a run lies in the phase diagram of its model.

use lennard_literature::{EquationOfState, Phase};
use serde::Serialize;

use super::RunFolder;
use super::read::HALF_STEPS;

/// The thermodynamic state of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateOfMatter {
    /// Density in σ⁻³.
    pub density: f64,
    /// Temperature in ε/k_B: the measured mean of half steps where the method has them, else of whole steps.
    pub temperature: f64,
    /// Whether the temperature is the mean of half steps.
    pub half_steps: bool,
    /// The phase by the equation of state; absent where there is none for the model.
    pub phase: Option<Phase>,
    /// The same in words.
    pub words: String,
}

impl StateOfMatter {
    /// A state by density (σ⁻³) and temperature (ε/k_B).
    #[must_use]
    pub fn new(density: f64, temperature: f64, equation: Option<&dyn EquationOfState>) -> Self {
        let is_known = temperature.is_finite();
        let phase = equation.filter(|_| is_known).map(|e| e.phase(density, temperature));
        let words = match phase {
            None if !is_known => "unknown: no temperature was sampled".into(),
            None => "unknown: there is no equation of state for this model".into(),
            Some(Phase::OutsideRange) => equation
                .and_then(|e| e.check(density, temperature).err())
                .map_or_else(|| Phase::OutsideRange.describe().to_owned(), |e| e.to_string()),
            Some(phase) => phase.describe().to_owned(),
        };
        Self { density, temperature, half_steps: false, phase, words }
    }

    /// The same where the density over the whole box names no phase; `words` say why.
    #[must_use]
    pub(super) fn of_no_phase(self, words: String) -> Self {
        Self { phase: None, words, ..self }
    }

    /// Density and temperature, with which temperature it is: `ρ = 0.8000, T, half steps = 1.0012`.
    #[must_use]
    pub fn in_numbers(&self) -> String {
        let steps = match self.half_steps {
            true => "half steps",
            false => "whole steps",
        };
        let temperature = match self.temperature.is_finite() {
            true => format!("T, {steps} = {:.4}", self.temperature),
            false => "no T".to_owned(),
        };
        format!("ρ = {:.4}, {temperature}", self.density)
    }

    /// Whether a run there may be judged by the equation of state.
    #[must_use]
    pub fn is_single_stable_phase(&self) -> bool {
        self.phase.is_some_and(Phase::is_stable)
    }
}

/// The state of a run at the measured temperature that belongs to its positions.
#[must_use]
pub fn state_of(run: &RunFolder, equation: Option<&dyn EquationOfState>) -> StateOfMatter {
    let temperature = run.temperature().map_or(f64::NAN, |a| a.estimate.mean);
    StateOfMatter {
        half_steps: run.average(HALF_STEPS).is_some(),
        ..StateOfMatter::new(run.density, temperature, equation)
    }
}
