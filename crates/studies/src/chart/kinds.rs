//! The kinds of error, one a diagram: what each is about, and how it is read from a point.

use crate::report::significant;

use super::Chart;
use super::point::{ChartedPoint, Errors, Outcome};
use crate::StudyError;
use crate::lab::{AgainstEquation, Measured, Value, Workbench};
use crate::settings::Settings;

/// Rounding of a number in double precision, 2⁻⁵³.
const ROUNDING: f64 = 1.1e-16;

/// An error of a point, as a panel takes it.
pub(super) enum Reading {
    Found(f64, Option<f64>),
    Failed(String),
    /// There is none for such settings.
    None,
}

/// Reads the error of a kind from a point.
pub(super) type Read = Box<dyn Fn(&ChartedPoint, &Errors) -> Reading>;

/// What a panel is about, and how it reads a point.
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) label: &'static str,
    pub(super) about: String,
    pub(super) floor: Floor,
    pub(super) read: Read,
}

/// Below what errors say nothing.
pub(super) enum Floor {
    None,
    At(f64, &'static str),
    /// The middle one of the standard errors.
    Statistical,
}

fn of_run(read: impl Fn(&Measured) -> Option<(f64, Option<f64>)> + 'static) -> Read {
    Box::new(move |_, errors| match &errors.measured {
        Outcome::Failed(failed) => Reading::Failed(failed.reason.clone()),
        Outcome::Found(found) => match read(found) {
            Some((value, error)) if value.is_finite() => Reading::Found(value, error),
            _ => Reading::None,
        },
    })
}

fn value(v: Value) -> Option<(f64, Option<f64>)> {
    Some((v.mean, Some(v.standard_error)))
}

/// Every kind of error that a chart shows.
pub(super) fn kinds(bench: &Workbench, chart: &Chart) -> Result<Vec<Kind>, StudyError> {
    let mut kinds = of_forces(chart);
    kinds.extend(of_conservation());
    kinds.extend(of_thermodynamics(bench, chart)?);
    kinds.extend(of_motion(chart));
    Ok(kinds)
}

fn of_forces(chart: &Chart) -> Vec<Kind> {
    let mut kinds = vec![Kind {
        name: "forces-same-model",
        title: "Forces against the reference kernel",
        label: "relative RMS error of the forces",
        about: "Forces at the common start against the loop over all pairs in double precision, with the same truncation. It shows what \
                precision and order of summation do."
            .into(),
        floor: Floor::At(ROUNDING, "rounding of one number"),
        read: Box::new(|_, errors| Reading::Found(errors.forces.same_model, None)),
    }];
    if let (Some(reach), Some(left_out)) = (chart.reach, chart.left_out_of_forces) {
        kinds.push(Kind {
            name: "forces-untruncated",
            title: "Forces against the untruncated fluid",
            label: "relative RMS error of the forces",
            about: format!(
                "The same forces against forces of the potential without a cutoff, summed over periodic images up to {} σ. Plain and \
                 shifted cutoffs have the same forces; a tail correction moves no particle.",
                significant(reach, 3)
            ),
            floor: Floor::At(left_out, "what that sum leaves out"),
            read: Box::new(|_, errors| match errors.forces.untruncated {
                Some(error) => Reading::Found(error, None),
                None => Reading::None,
            }),
        });
    }
    kinds
}

fn of_conservation() -> Vec<Kind> {
    vec![
        Kind {
            name: "energy-fluctuation",
            title: "Fluctuation of the conserved energy",
            label: "RMS about the drift / ε per particle",
            about: "The energy that the forces conserve, about a straight line through the whole run. What a heat bath has put in is \
                    taken off. For the plain cutoff it is the shifted energy."
                .into(),
            floor: Floor::None,
            read: of_run(|m| Some((m.energy_rms, None))),
        },
        Kind {
            name: "energy-drift",
            title: "Drift of the conserved energy",
            label: "|drift| / (ε/τ per particle)",
            about: "The slope of a straight line through the conserved energy, with the standard error from the slopes of ten blocks.".into(),
            floor: Floor::Statistical,
            read: of_run(|m| Some((m.drift.slope, Some(m.drift.standard_error)))),
        },
        Kind {
            name: "temperatures",
            title: "Kinetic against configurational temperature",
            label: "|T − T_conf| / (ε/k_B)",
            about: "They are equal in equilibrium; a large step heats one of them. Where the force jumps at the cutoff, the pairs at the cutoff \
                    give the jump."
                .into(),
            floor: Floor::Statistical,
            read: of_run(|m| value(m.temperature_difference)),
        },
    ]
}

fn of_thermodynamics(bench: &Workbench, chart: &Chart) -> Result<Vec<Kind>, StudyError> {
    let tight = chart.points[chart.tightest].clone();
    let own = Settings::of(bench.scene());
    let remarks = chart.points[0].measured().map(|m| m.remarks.join("; "));
    let equation = match bench.equation(&own)? {
        Ok(name) => format!(
            "Each model is compared with its own equation of state, at the density and the temperature of its run: {name} \
             for the model of the scene. Models without an equation are not in this diagram, but in the next."
        ),
        Err(why) => format!(
            "Each model is compared with its own equation of state. For the model of the scene there is {why}: it is judged by \
             the tightest run alone."
        ),
    };
    let said = remarks.filter(|r| !r.is_empty());
    let equation = match said {
        Some(remark) if !equation.contains(&remark) => {
            format!("{equation} Of the scene's own: {remark}.")
        }
        _ => equation,
    };
    let against = format!(
        "Against number {}, the tightest run ({}, {} τ long), as the model named by each point has it. Both are carried to T = {} by the \
         slopes of {}.",
        tight.number,
        tight.label,
        significant(chart.plan.tight_time, 3),
        significant(chart.slopes.temperature, 4),
        chart.slopes.source,
    );
    // A run that failed has no place where its model has no equation.
    let mut judged: Vec<usize> = Vec::new();
    for point in &chart.points {
        if bench.equation(&point.settings)?.is_ok() {
            judged.push(point.number);
        }
    }
    let against_equation =
        |pick: fn(&AgainstEquation) -> Value| -> Read {
            let (judged, read) =
                (judged.clone(), of_run(move |m| value(pick(m.against_equation.as_ref()?))));
            Box::new(move |point, errors| {
                if judged.contains(&point.number) { read(point, errors) } else { Reading::None }
            })
        };
    let tightest = tight.measured().cloned();
    let number = tight.number;
    type Pick = fn(&Measured) -> Value;
    let against_tightest = |pick: Pick| -> Read {
        let tightest = tightest.clone();
        let read = of_run(move |m| {
            let other = tightest.as_ref()?;
            value(pick(m).minus(&pick(other)))
        });
        Box::new(move |point, errors| {
            // A run is no judge of itself.
            if point.number == number {
                return Reading::None;
            }
            read(point, errors)
        })
    };
    Ok(vec![
        Kind {
            name: "energy-equation",
            title: "U against the equation of state",
            label: "|U − U_EOS| / ε per particle",
            about: equation.clone(),
            floor: Floor::Statistical,
            read: against_equation(|e| e.potential_energy),
        },
        Kind {
            name: "pressure-equation",
            title: "P against the equation of state",
            label: "|P − P_EOS| / (ε/σ³)",
            about: equation,
            floor: Floor::Statistical,
            read: against_equation(|e| e.pressure),
        },
        Kind {
            name: "energy-tightest",
            title: "U against the tightest run",
            label: "|U − U_tightest| / ε per particle",
            about: against.clone(),
            floor: Floor::Statistical,
            read: against_tightest(|m| m.potential_energy_at_reference),
        },
        Kind {
            name: "pressure-tightest",
            title: "P against the tightest run",
            label: "|P − P_tightest| / (ε/σ³)",
            about: against,
            floor: Floor::Statistical,
            read: against_tightest(|m| m.pressure_at_reference),
        },
    ])
}

fn of_motion(chart: &Chart) -> Vec<Kind> {
    let time = significant(chart.plan.short_time, 3);
    let floors: Vec<f64> = chart
        .points
        .iter()
        .filter_map(|p| Some(p.errors.as_ref()?.trajectory.found()?.floor))
        .collect();
    vec![
        Kind {
            name: "trajectory",
            title: "Short trajectory against a tight one",
            label: "RMS distance / σ",
            about: format!(
                "Positions after {time} τ at constant energy against positions by the method of Blanes and Moan with dt = 0.001 τ in double \
                 precision, with the same truncation. They show what step, method and precision do. A force that jumps at the cutoff limits how well \
                 this can be known."
            ),
            floor: median(floors)
                .map_or(Floor::None, |f| Floor::At(f, "the tight trajectory itself")),
            read: Box::new(|_, errors| match &errors.trajectory {
                Outcome::Found(t) => Reading::Found(t.distance, None),
                Outcome::Failed(failed) => Reading::Failed(failed.reason.clone()),
            }),
        },
        Kind {
            name: "reversibility",
            title: "There and back",
            label: "RMS distance from the start / σ",
            about: format!(
                "{time} τ forward at constant energy, then the same with reversed velocities. An arrow at the lower edge: back at the start \
                 to the last bit."
            ),
            floor: Floor::None,
            read: Box::new(|_, errors| match &errors.reversibility {
                Outcome::Found(distance) => Reading::Found(*distance, None),
                Outcome::Failed(failed) => Reading::Failed(failed.reason.clone()),
            }),
        },
    ]
}

/// The middle one of the values that are finite.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
