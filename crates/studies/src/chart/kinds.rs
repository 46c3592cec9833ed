//! The kinds of error, one a diagram: what each is about, and how it is read from a point.

use crate::report::significant;
use lennard_observables::Estimate;

use super::types::{Chart, ChartedPoint, Errors, Outcome, Panel, Tightest, median};
use crate::StudyError;
use crate::lab::{AgainstEquation, Measured, Workbench};
use crate::settings::Settings;

/// Rounding of a number in double precision, 2⁻⁵³.
const ROUNDING: f64 = 1.1e-16;

/// Reads the error of a kind from a point that is measured, or why its run failed; nothing where such settings have none.
pub(super) type Read = Box<dyn Fn(&ChartedPoint) -> Option<Result<Error, String>>>;

/// A panel without marks, and how it reads them from points.
pub(super) struct Kind {
    pub(super) panel: Panel,
    pub(super) floor: Floor,
    pub(super) read: Read,
}

/// A kind of error of which each has a statistical error of its own.
fn kind(
    name: &'static str,
    title: &'static str,
    label: &'static str,
    about: impl Into<String>,
    read: Read,
) -> Kind {
    let panel = Panel { name, title, label, about: about.into(), ..Panel::default() };
    Kind { panel, floor: Floor::Statistical, read }
}

impl Kind {
    fn with_floor(self, floor: Floor) -> Self {
        Self { floor, ..self }
    }

    /// In the first picture under this name with its unit.
    fn first(mut self, name: &'static str) -> Self {
        self.panel.in_overview = Some(name);
        self
    }
}

/// Below what errors say nothing.
pub(super) enum Floor {
    None,
    At(f64, &'static str),
    /// The middle one of the standard errors.
    Statistical,
}

/// An error and its standard error, where it has one.
pub(super) type Error = (f64, Option<f64>);

/// Reads what came of a part of the runs of a point.
fn outcome<T: 'static>(
    part: impl Fn(&ChartedPoint) -> Option<&Outcome<T>> + 'static,
    read: impl Fn(&T) -> Option<Error> + 'static,
) -> Read {
    Box::new(move |point| match part(point)? {
        Outcome::Failed(failed) => Some(Err(failed.reason.clone())),
        Outcome::Found(found) => read(found).filter(|(value, _)| value.is_finite()).map(Ok),
    })
}

fn of_run(read: impl Fn(&Measured) -> Option<Error> + 'static) -> Read {
    outcome(|point| Some(&point.errors.as_ref()?.measured), read)
}

fn of_forces_at_start(read: impl Fn(&Errors) -> Option<f64> + 'static) -> Read {
    Box::new(move |point| Some(Ok((read(point.errors.as_ref()?)?, None))))
}

fn value(v: Estimate) -> Option<Error> {
    Some((v.mean, Some(v.standard_error)))
}

/// Every kind of error that a chart shows.
pub(super) fn kinds(bench: &Workbench, chart: &Chart) -> Result<Vec<Kind>, StudyError> {
    let tight = &chart.against;
    let mut kinds = of_forces(tight);
    kinds.extend(of_conservation());
    kinds.extend(of_thermodynamics(bench, chart, tight)?);
    kinds.extend(of_motion(chart));
    Ok(kinds)
}

fn of_forces(tight: &Tightest) -> Vec<Kind> {
    const FIRST: &str = "forces (relative)";
    let same_model = kind(
        "forces-same-model",
        "Forces against the reference kernel",
        "relative RMS error of the forces",
        "Forces at the common start against the loop over all pairs in double precision, with the same truncation. It shows what precision \
         and order of summation do.",
        of_forces_at_start(|errors| Some(errors.forces.same_model)),
    )
    .with_floor(Floor::At(ROUNDING, "rounding of one number"));
    // The forces against the untruncated fluid tell more than precision does, where there is a cutoff at all.
    let (Some(reach), Some(left_out)) = (tight.reach, tight.left_out_of_forces) else {
        return vec![same_model.first(FIRST)];
    };
    let untruncated = kind(
        "forces-untruncated",
        "Forces against the untruncated fluid",
        "relative RMS error of the forces",
        format!(
                "The same forces against forces of the potential without a cutoff, summed over periodic images up to {} σ. Plain and \
                 shifted cutoffs have the same forces; a tail correction moves no particle.",
                significant(reach, 3)
        ),
        of_forces_at_start(|errors| errors.forces.untruncated),
    )
    .with_floor(Floor::At(left_out, "what that sum leaves out"));
    vec![same_model, untruncated.first(FIRST)]
}

fn of_conservation() -> Vec<Kind> {
    vec![
        kind(
            "energy-fluctuation",
            "Fluctuation of the conserved energy",
            "RMS about the drift / ε per particle",
            "The energy that the forces conserve, about a straight line through the whole run. What a heat bath has put in is \
                    taken off. For the plain cutoff it is the shifted energy.",
            of_run(|m| Some((m.energy_rms, None))),
        )
        .with_floor(Floor::None),
        kind(
            "energy-drift",
            "Drift of the conserved energy",
            "|drift| / (ε/τ per particle)",
            "The slope of a straight line through the conserved energy, with the standard error from the slopes of ten blocks.",
            of_run(|m| value(m.drift)),
        ),
        kind(
            "temperatures",
            "Kinetic against configurational temperature",
            "|T − T_conf| / (ε/k_B)",
            "They are equal in equilibrium; a large step heats one of them. Where the force jumps at the cutoff, the pairs at the cutoff \
                    give the jump.",
            of_run(|m| value(m.temperature_difference)),
        ),
    ]
}

fn of_thermodynamics(
    bench: &Workbench,
    chart: &Chart,
    tightest: &Tightest,
) -> Result<Vec<Kind>, StudyError> {
    let tight = chart.points[tightest.tightest].clone();
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
        significant(tightest.slopes.temperature, 4),
        tightest.slopes.source,
    );
    // A run that failed has no place where its model has no equation.
    let mut judged: Vec<usize> = Vec::new();
    for point in &chart.points {
        if bench.equation(&point.settings)?.is_ok() {
            judged.push(point.number);
        }
    }
    let against_equation = |pick: fn(&AgainstEquation) -> Estimate| -> Read {
        let (judged, read) =
            (judged.clone(), of_run(move |m| value(pick(m.against_equation.as_ref()?))));
        Box::new(move |point| judged.contains(&point.number).then(|| read(point))?)
    };
    let of_tightest = tight.measured().cloned();
    let number = tight.number;
    type Pick = fn(&Measured) -> Estimate;
    let against_tightest = |pick: Pick| -> Read {
        let of_tightest = of_tightest.clone();
        let read = of_run(move |m| {
            let other = of_tightest.as_ref()?;
            value(pick(m).minus(&pick(other)))
        });
        // A run is no judge of itself.
        Box::new(move |point| (point.number != number).then(|| read(point))?)
    };
    Ok(vec![
        kind(
            "energy-equation",
            "U against the equation of state",
            "|U − U_EOS| / ε per particle",
            equation.clone(),
            against_equation(|e| e.potential_energy),
        ),
        kind(
            "pressure-equation",
            "P against the equation of state",
            "|P − P_EOS| / (ε/σ³)",
            equation,
            against_equation(|e| e.pressure),
        ),
        kind(
            "energy-tightest",
            "U against the tightest run",
            "|U − U_tightest| / ε per particle",
            against.clone(),
            against_tightest(|m| m.potential_energy_at_reference),
        )
        .first("U / ε"),
        kind(
            "pressure-tightest",
            "P against the tightest run",
            "|P − P_tightest| / (ε/σ³)",
            against,
            against_tightest(|m| m.pressure_at_reference),
        )
        .first("P / (ε/σ³)"),
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
        kind(
            "trajectory",
            "Short trajectory against a tight one",
            "RMS distance / σ",
            format!(
                "Positions after {time} τ at constant energy against positions by the method of Blanes and Moan with dt = 0.001 τ in double \
                 precision, with the same truncation. They show what step, method and precision do. A force that jumps at the cutoff limits how well \
                 this can be known."
            ),
            outcome(
                |point| Some(&point.errors.as_ref()?.trajectory),
                |t| Some((t.distance, None)),
            ),
        )
        .with_floor(median(floors)
                .map_or(Floor::None, |f| Floor::At(f, "the tight trajectory itself"))),
        kind(
            "reversibility",
            "There and back",
            "RMS distance from the start / σ",
            format!(
                "{time} τ forward at constant energy, then the same with reversed velocities. An arrow at the lower edge: back at the start \
                 to the last bit."
            ),
            outcome(
                |point| Some(&point.errors.as_ref()?.reversibility),
                |distance| Some((*distance, None)),
            ),
        )
        .with_floor(Floor::None),
    ]
}
