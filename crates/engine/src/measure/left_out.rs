//! What frames cannot give, said by name.

use std::iter;

use lennard_core::{Findings, Remark, Want};
use lennard_observables::response_functions;

use crate::Simulation;
use crate::two_phases::{forget_responses, tell, without};

/// What is known of the frames that a simulation has its states from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FromFrames {
    /// The trajectory.
    pub(crate) file: String,
    /// Whether frames have velocities; otherwise velocities stand for the temperature of the scene.
    pub(crate) has_velocities: bool,
    /// Observables of the scene that the frames cannot give.
    pub(crate) left_out: Vec<Remark>,
    /// How positions are rounded; `None` where that changes nothing.
    pub(crate) rounding: Option<Rounding>,
}

/// Rounded positions, and by how much rounding raises the means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rounding {
    /// The step between two positions that the file tells apart, σ.
    pub(crate) step: f64,
    /// Of U/N, ε.
    pub(crate) energy: f64,
    /// Of P, ε/σ³.
    pub(crate) pressure: f64,
}

impl Rounding {
    /// A step whose bias has not been found yet.
    pub(crate) fn of_step(step: f64) -> Self {
        Self { step, energy: f64::NAN, pressure: f64::NAN }
    }

    fn in_words(&self) -> String {
        let Self { step, energy, pressure } = self;
        format!(
            "positions are rounded to {step:.1e} σ, which changes U by {energy:+.1e} ε and P by {pressure:+.1e} ε/σ³"
        )
    }
}

/// Quantities of velocities alone.
const OF_VELOCITIES: [&str; 3] = ["temperature", "kinetic_energy", "total_energy"];
/// The quantity that a thermostat's heat belongs to, which frames do not tell.
const CONSERVED: &str = "conserved_energy";

impl FromFrames {
    /// Whether a quantity is not of the frames.
    pub(crate) fn hides(&self, name: &str) -> bool {
        name == CONSERVED
            || !self.has_velocities
                && (OF_VELOCITIES.contains(&name) || name.starts_with("temperature_"))
    }
}

impl Simulation {
    /// Takes out what frames cannot give, and says each by its name.
    pub(crate) fn leave_out_of_frames(&self, findings: &mut [Findings]) {
        let Some(frames) = &self.frames else {
            return;
        };
        let is_response = |name: &str| response_functions().any(|function| function == name);
        forget_responses(findings);
        for found in findings.iter_mut() {
            found.remarks.retain(|r| !matches!(r, Remark::NoResponseFunctions { .. }));
            for table in &mut found.tables {
                table.columns.retain(|column| !frames.hides(&column.name));
            }
        }
        without(findings, |name| name == CONSERVED || is_response(name));
        let unknown =
            iter::once(CONSERVED).chain(response_functions()).map(str::to_owned).collect();
        tell(findings, unknown, "frames say neither their ensemble nor the heat of a thermostat");
        let hidden = without(findings, |name| frames.hides(name));
        tell(findings, hidden, "the frames have no velocities; P has the temperature of the scene");
        if let Some(rounding) = frames.rounding {
            self.judge_rounding(rounding, findings);
        }
        if let Some(first) = findings.first_mut() {
            first.remarks.extend(frames.left_out.iter().cloned());
        }
    }

    /// Leaves out what forces and energies give where rounding changes U or P by more than their standard errors.
    fn judge_rounding(&self, rounding: Rounding, findings: &mut [Findings]) {
        let averages = findings.iter().flat_map(|found| &found.averages);
        let is_lost = averages.into_iter().any(|average| {
            let bias = match average.name.as_str() {
                "potential_energy" => rounding.energy,
                "pressure" => rounding.pressure,
                _ => return false,
            };
            bias.abs() > average.estimate.standard_error
        });
        let words = rounding.in_words();
        if !is_lost {
            if let Some(first) = findings.first_mut() {
                first.remark(words);
            }
            return;
        }
        let mut names = Vec::new();
        for (observer, found) in self.observers.iter().zip(findings.iter_mut()) {
            if observer.observable.want() != Want::NOTHING {
                let is_of_forces = |name: &str| !OF_VELOCITIES[..2].contains(&name);
                names.extend(without(std::slice::from_mut(found), is_of_forces));
            }
        }
        tell(findings, names, &format!("{words}: more than a standard error"));
    }
}
