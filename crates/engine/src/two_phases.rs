//! What means nothing where two phases stand side by side, and is left out of a run.

use lennard_core::{Average, Doubt, Findings, Remark};
use lennard_observables::quantities::{Mark, has_mark, is_of_one_phase};
use lennard_observables::{LIQUID_DENSITY, response_functions};
use lennard_scene::Scene;

use crate::Simulation;
use crate::separated::separated;

/// Why a mean over the whole box belongs to no phase; `None` where the box holds one phase, as far as the run knows.
fn two_phases(scene: &Scene, findings: &[Findings]) -> Option<String> {
    if let Some(surfaces) = scene.surfaces() {
        return Some(format!("the start has surfaces ({surfaces})"));
    }
    if scene.half_crystal().is_some() {
        return Some("a crystal stands beside its liquid".to_owned());
    }
    let mut averages = findings.iter().flat_map(|f| &f.averages);
    let found = averages.any(|average| average.name == LIQUID_DENSITY);
    found.then(|| "the density has two levels".to_owned())
}

impl Simulation {
    /// Leaves out of the findings what two phases side by side, or a tail among the forces, make meaningless, and says so.
    pub(crate) fn leave_out_meaningless(&self, findings: &mut [Findings]) {
        let known = two_phases(&self.scene, findings);
        let found = if known.is_none() { separated(self) } else { None };
        if let Some(why) = &found {
            doubt_of_pressure(findings);
            if let Some(first) = findings.first_mut() {
                first.remark(Remark::Separated { why: why.clone() });
            }
        }
        let found = found.map(|_| "the fluid has separated".to_owned());
        if let Some(why) = known.or(found) {
            let left_out = without(findings, is_of_one_phase);
            forget_responses(findings);
            tell(
                findings,
                left_out,
                &format!("{why}, and a mean over both phases belongs to neither"),
            );
        }
        if self.scene.planar_tail {
            let left_out = without(findings, is_response);
            forget_responses(findings);
            tell(
                findings,
                left_out,
                "the planar tail is among the forces, and response functions do not count it",
            );
            let left_out = without(findings, |name| has_mark(name, Mark::Plain));
            for table in findings.iter_mut().flat_map(|f| &mut f.tables) {
                table.columns.retain(|c| !has_mark(&c.name, Mark::Plain));
            }
            tell(
                findings,
                left_out,
                "the planar tail is among the forces, and moves the particles",
            );
        }
    }
}

fn is_response(name: &str) -> bool {
    response_functions().any(|function| function == name)
}

/// Takes out the remarks that tell how response functions were found.
pub(crate) fn forget_responses(findings: &mut [Findings]) {
    for remarks in findings.iter_mut().map(|f| &mut f.remarks) {
        remarks.retain(|r| {
            !matches!(r, Remark::HeatCapacity { .. } | Remark::ResponseFunctions { .. })
        });
    }
}

/// Takes means out, and gives their names.
pub(crate) fn without(
    findings: &mut [Findings],
    is_left_out: impl Fn(&str) -> bool,
) -> Vec<String> {
    let mut names = Vec::new();
    for averages in findings.iter_mut().map(|f| &mut f.averages) {
        averages.retain(|Average { name, .. }| {
            let stays = !is_left_out(name);
            if !stays {
                names.push(name.clone());
            }
            stays
        });
    }
    names
}

/// Says of the pressure that it belongs to no phase.
fn doubt_of_pressure(findings: &mut [Findings]) {
    for average in findings.iter_mut().flat_map(|f| &mut f.averages) {
        if has_mark(&average.name, Mark::AcrossSurfaces) {
            average.doubt.get_or_insert_with(|| {
                Doubt::Incomplete(
                    "the fluid has separated: the mean counts both phases and the tension of the surfaces between them".into(),
                )
            });
            average.estimate.standard_error = f64::NAN;
        }
    }
}

pub(crate) fn tell(findings: &mut [Findings], left_out: Vec<String>, why: &str) {
    if let Some(first) = findings.first_mut().filter(|_| !left_out.is_empty()) {
        first.remark(Remark::LeftOut { quantities: left_out, why: why.to_owned() });
    }
}

#[cfg(test)]
mod tests {
    use lennard_core::Estimate;

    use super::*;

    const ESTIMATE: Estimate = Estimate {
        mean: 1.0,
        standard_error: 0.1,
        n_effective: 100.0,
        least_effective: 100.0,
        freedom: 100.0,
        equilibration_cut: 0,
    };

    #[test]
    fn a_planar_tail_alone_is_no_sign_of_two_phases_and_a_liquid_density_is() {
        let text = r#"
            [system]
            temperature = 0.8

            [start]
            kind = "file"
            file = "slab.xyz"
            [truncation]
            kind = "cut"
            r_cut = 2.5
            tail_correction = "planar"
            [integrator]
            dt = 0.004
            [[stage]]
            name = "production"
            steps = 100
        "#;
        let scene = Scene::parse(text, "test.toml", &[]).unwrap();
        assert!(scene.planar_tail);
        assert_eq!(two_phases(&scene, &[]), None);
        let findings = Findings {
            averages: vec![Average::new(LIQUID_DENSITY, "σ⁻³", ESTIMATE)],
            ..Findings::default()
        };
        let why = two_phases(&scene, &[findings]).unwrap();
        assert_eq!(why, "the density has two levels");
    }

    #[test]
    fn what_is_left_out_is_told_by_name() {
        let mut findings = [Findings {
            averages: ["pressure", "speed_of_sound"]
                .map(|name| Average::new(name, "", ESTIMATE))
                .into(),
            ..Findings::default()
        }];
        let left_out = without(&mut findings, is_of_one_phase);
        assert_eq!(left_out, ["speed_of_sound"]);
        tell(&mut findings, left_out, "there are two phases");
        assert_eq!(findings[0].averages.len(), 1);
        let words = "left out: speed_of_sound. Here there are two phases";
        assert_eq!(findings[0].remarks_in_words(), words);
    }
}
