//! What frames cannot give, said by name.

use std::iter;

use lennard_core::Want;
use lennard_observables::{
    Findings, Remark, is_response, leave_out, response_functions, tell, without,
};

use crate::Simulation;
use crate::from_frames::{CONSERVED, OF_VELOCITIES, Rounding};

impl Simulation {
    /// Takes out what frames cannot give, and says each by its name.
    pub(crate) fn leave_out_of_frames(&self, findings: &mut [Findings]) {
        let Some(frames) = &self.frames else {
            return;
        };
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
        let why = "the frames have no velocities; P has the temperature of the scene";
        leave_out(findings, why, |name| frames.hides(name));
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
                "potential_energy" => rounding.bias[0],
                "pressure" => rounding.bias[1],
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
