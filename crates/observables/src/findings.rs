//! What speaks against findings, and what of them means nothing in a run.

use lennard_core::ThermostatSpec;

use crate::quantities::{Mark, has_mark};
use crate::{Average, Doubt, Findings, Remark, response_functions};

impl Doubt {
    /// What the thermostats of a run do to a quantity, of an observable that follows the motion where it is `dynamic`.
    #[must_use]
    pub fn of_baths(
        quantity: &str,
        dynamic: bool,
        baths: &[&'static ThermostatSpec],
    ) -> Option<Self> {
        if let Some(bath) = baths.iter().find(|b| dynamic && !b.keeps_motion) {
            let name = bath.name;
            return Some(Self::Thermostat {
                why: format!(
                    "`{name}` kicks each particle: this is the motion with its friction, not the fluid's own"
                ),
                sets_it: false,
            });
        }
        let name = baths.iter().find(|b| !b.canonical)?.name;
        let sets_it = has_mark(quantity, Mark::SetByScaling);
        let why = match sets_it {
            true => format!("set by `{name}`, not measured"),
            false => format!("`{name}` samples no known ensemble"),
        };
        Some(Self::Thermostat { why, sets_it })
    }
}

impl Average {
    /// Gives the mean the gravest of these doubts and its own, the first where they are alike. A mean that is no result has
    /// no standard error.
    pub fn weigh(&mut self, first: Option<Doubt>, others: impl IntoIterator<Item = Option<Doubt>>) {
        let all = [self.doubt.take()].into_iter().chain(others);
        self.doubt = all.fold(first, Doubt::graver);
        if self.doubt.as_ref().is_some_and(Doubt::takes_the_error) {
            self.estimate.standard_error = f64::NAN;
        }
    }
}

/// Whether a quantity is a response function.
#[must_use]
pub fn is_response(name: &str) -> bool {
    response_functions().any(|function| function == name)
}

/// Takes means out, and says so by name.
pub fn leave_out(findings: &mut [Findings], why: &str, is_left_out: impl Fn(&str) -> bool) {
    let names = without(findings, is_left_out);
    tell(findings, names, why);
}

/// Takes means out, with the remarks that tell how they were found, and gives their names.
pub fn without(findings: &mut [Findings], is_left_out: impl Fn(&str) -> bool) -> Vec<String> {
    let no_response = response_functions().all(&is_left_out);
    let tells_how =
        |r: &Remark| matches!(r, Remark::HeatCapacity { .. } | Remark::ResponseFunctions { .. });
    let mut names = Vec::new();
    for Findings { averages, remarks, .. } in findings {
        names.extend(averages.extract_if(.., |a| is_left_out(&a.name)).map(|a| a.name));
        remarks.retain(|r| !(no_response && tells_how(r)));
    }
    names
}

/// Says by name what was taken out.
pub fn tell(findings: &mut [Findings], left_out: Vec<String>, why: &str) {
    if let Some(first) = findings.first_mut().filter(|_| !left_out.is_empty()) {
        first.remark(Remark::LeftOut { quantities: left_out, why: why.to_owned() });
    }
}

/// Says of a fluid that has separated, and of its pressure that it belongs to no phase.
pub fn tell_separated(findings: &mut [Findings], why: &str) {
    for average in findings.iter_mut().flat_map(|f| &mut f.averages) {
        if has_mark(&average.name, Mark::AcrossSurfaces) {
            let doubt = Doubt::Incomplete(
                "the fluid has separated: the mean counts both phases and the tension of the surfaces between them".into(),
            );
            average.doubt.get_or_insert(doubt);
            average.estimate.standard_error = f64::NAN;
        }
    }
    if let Some(first) = findings.first_mut() {
        first.remark(Remark::Separated { why: why.to_owned() });
    }
}

/// Compressibilities from g(r) and from S(k) have names that begin so.
const FROM_STRUCTURE: &str = "compressibility_kirkwood_buff";

/// Says what compressibilities from the structure are with a tail of this pressure, ε/σ³.
///
/// A tail correction moves no particle, so that the structure is of the fluid without it. Pressure and response functions have
/// the tail: with P_tail = c·ρ², 1/κ_T = ρ·∂P/∂ρ has 2·P_tail more.
pub fn tell_tail_of_structure(findings: &mut [Findings], pressure: f64) {
    for of_one in findings.iter_mut().filter(|_| pressure != 0.0) {
        let from_structure = of_one.averages.iter().filter(|average| {
            average.name.starts_with(FROM_STRUCTURE) && average.estimate.mean > 0.0
        });
        let words: Vec<String> = from_structure
            .map(|average| {
                let kappa = average.estimate.mean;
                let with_tail = kappa / (1.0 + 2.0 * pressure * kappa);
                format!("{} {with_tail:.4} σ³/ε", average.name)
            })
            .collect();
        if !words.is_empty() {
            of_one.remark(format!(
                "the structure is of the fluid without its tail, which adds 2·P_tail = {:.4} ε/σ³ to 1/κ_T; with the tail: {}",
                2.0 * pressure,
                words.join(", ")
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Estimate;
    use crate::quantities::is_of_one_phase;

    #[test]
    fn what_is_left_out_is_told_by_name() {
        let average = |name| Average::new(name, "", Estimate::new(1.0, 0.1, 100.0));
        let averages = ["pressure", "speed_of_sound"].map(average).into();
        let mut findings = [Findings { averages, ..Findings::default() }];
        leave_out(&mut findings, "there are two phases", is_of_one_phase);
        assert_eq!(findings[0].averages.len(), 1);
        let words = "left out: speed_of_sound. Here there are two phases";
        assert_eq!(findings[0].remarks_in_words(), words);
    }
}
