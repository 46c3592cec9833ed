//! The diagrams as data: one kind of error each, never mixed.

use lennard_report::significant;
use serde::Serialize;

use super::Chart;
use super::point::{ChartedPoint, Errors, Outcome};
use crate::StudyError;
use crate::settings::{Measured, Settings, Value, Workbench};

/// Rounding of a number in double precision, 2⁻⁵³.
const ROUNDING: f64 = 1.1e-16;

/// The two ways to count cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Wall time for each particle and τ, s.
    Wall,
    /// Pair forces for each particle and τ.
    Forces,
}

/// One error of one point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mark {
    /// Number of the point.
    pub number: usize,
    /// Wall time for each particle and τ, s: the median, or an estimate where it could not be timed.
    pub wall: f64,
    /// Smallest and largest of the timings, s.
    pub wall_range: Option<(f64, f64)>,
    /// Pair forces for each particle and τ.
    pub pair_forces: f64,
    /// The error with its sign; absent where the run failed.
    pub error: Option<f64>,
    /// Its standard error, where it is statistical.
    pub standard_error: Option<f64>,
    /// Why there is no error.
    pub failure: Option<String>,
    /// Whether nothing that costs less wall time errs less.
    pub on_wall_front: bool,
    /// Whether nothing that takes fewer pair forces errs less.
    pub on_forces_front: bool,
}

impl Mark {
    /// Its cost by one of the two measures.
    #[must_use]
    pub fn cost(&self, axis: Axis) -> f64 {
        match axis {
            Axis::Wall => self.wall,
            Axis::Forces => self.pair_forces,
        }
    }

    /// Whether it is on the front by one of the two measures.
    #[must_use]
    pub fn on_front(&self, axis: Axis) -> bool {
        match axis {
            Axis::Wall => self.on_wall_front,
            Axis::Forces => self.on_forces_front,
        }
    }
}

/// A diagram.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// File stem.
    pub name: &'static str,
    /// What the error is of.
    pub title: &'static str,
    /// Label of the axis of the error.
    pub label: &'static str,
    /// What is shown, in sentences.
    pub about: String,
    /// Errors below this say nothing.
    pub floor: Option<f64>,
    /// What makes that floor, in a few words.
    pub floor_words: &'static str,
    /// The points. Those for which there is no such error are not among them.
    pub marks: Vec<Mark>,
}

/// An error of a point, as a panel takes it.
enum Reading {
    Found(f64, Option<f64>),
    Failed(String),
    /// There is none for such settings.
    None,
}

/// What a panel is about, and how it reads a point.
struct Kind {
    name: &'static str,
    title: &'static str,
    label: &'static str,
    about: String,
    floor: Floor,
    read: Box<dyn Fn(&ChartedPoint, &Errors) -> Reading>,
}

enum Floor {
    None,
    At(f64, &'static str),
    /// The middle one of the standard errors.
    Statistical,
}

/// All diagrams of a chart.
///
/// # Errors
/// [`StudyError`] where the settings of the scene do not fit it, which they do.
pub fn panels(bench: &Workbench, chart: &Chart) -> Result<Vec<Panel>, StudyError> {
    let kinds = kinds(bench, chart)?;
    Ok(kinds.iter().map(|kind| panel(bench, chart, kind)).collect())
}

fn of_run(
    read: impl Fn(&Measured) -> Option<(f64, Option<f64>)> + 'static,
) -> Box<dyn Fn(&ChartedPoint, &Errors) -> Reading> {
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

fn kinds(bench: &Workbench, chart: &Chart) -> Result<Vec<Kind>, StudyError> {
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
        about: "Forces at the common start against the double loop over all pairs in double precision, with the same truncation: what \
                precision and order of summation do."
            .into(),
        floor: Floor::At(ROUNDING, "rounding of double precision"),
        read: Box::new(|_, errors| Reading::Found(errors.forces.same_model, None)),
    }];
    if let (Some(reach), Some(left_out)) = (chart.reach, chart.left_out_of_forces) {
        kinds.push(Kind {
            name: "forces-untruncated",
            title: "Forces against the untruncated fluid",
            label: "relative RMS error of the forces",
            about: format!(
                "The same forces against those of the potential without a cutoff, summed over periodic images up to {} σ. Plain and \
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
            about: "Of the energy that the forces conserve (for the plain cutoff that is the shifted one), less what a heat bath has put in, \
                    about a straight line through the whole run."
                .into(),
            floor: Floor::None,
            read: of_run(|m| Some((m.energy_rms, None))),
        },
        Kind {
            name: "energy-drift",
            title: "Drift of the conserved energy",
            label: "|drift| / (ε/τ per particle)",
            about: "The slope of that line, with the standard error from the slopes of ten blocks.".into(),
            floor: Floor::Statistical,
            read: of_run(|m| Some((m.drift.slope, Some(m.drift.standard_error)))),
        },
        Kind {
            name: "temperatures",
            title: "Kinetic against configurational temperature",
            label: "|T − T_conf| / (ε/k_B)",
            about: "They are one in equilibrium; a large step heats one of them. Where the force jumps at the cutoff, the jump is counted \
                    with g(r_cut) = 1, which is an error of its own that only continuous forces are free of."
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
            "Each model is compared with the equation of state of that very model, at the density and the temperature of its run: {name} \
             for that of the scene. Models without an equation are not in this diagram, but in the next."
        ),
        Err(why) => format!(
            "Each model is compared with the equation of state of that very model. For that of the scene there is {why}: it is judged by \
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
    let tightest = tight.measured().cloned();
    let number = tight.number;
    type Pick = fn(&Measured) -> Value;
    let against_tightest = |pick: Pick| -> Box<dyn Fn(&ChartedPoint, &Errors) -> Reading> {
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
            read: of_run(|m| value(m.against_equation.as_ref()?.potential_energy)),
        },
        Kind {
            name: "pressure-equation",
            title: "P against the equation of state",
            label: "|P − P_EOS| / (ε/σ³)",
            about: equation,
            floor: Floor::Statistical,
            read: of_run(|m| value(m.against_equation.as_ref()?.pressure)),
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
                "Positions after {time} τ at constant energy against those of the method of Blanes and Moan with dt = 0.001 τ in double \
                 precision, with the same truncation: what step, method and precision do. A force that jumps at the cutoff limits how well \
                 that can be known."
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

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

fn panel(bench: &Workbench, chart: &Chart, kind: &Kind) -> Panel {
    let mut marks: Vec<Mark> = chart
        .points
        .iter()
        .filter_map(|point| {
            let reading = (kind.read)(point, point.errors.as_ref()?);
            let (error, standard_error, failure) = match reading {
                Reading::None => return None,
                Reading::Found(error, se) => (Some(error), se, None),
                Reading::Failed(why) => (None, None, Some(why)),
            };
            let (wall, pair_forces) = cost(bench, chart, point)?;
            let spread = point.cost().map(|c| (c.wall.low, c.wall.high));
            Some(Mark {
                number: point.number,
                wall,
                wall_range: spread,
                pair_forces,
                error,
                standard_error: standard_error.filter(|e| e.is_finite()),
                failure,
                on_wall_front: false,
                on_forces_front: false,
            })
        })
        .collect();
    let (floor, floor_words) = match kind.floor {
        Floor::None => (None, ""),
        Floor::At(value, words) => (Some(value), words),
        Floor::Statistical => (
            median(marks.iter().filter_map(|m| m.standard_error).collect()),
            "one standard error",
        ),
    };
    for axis in [Axis::Wall, Axis::Forces] {
        for i in front(&marks, axis, floor.unwrap_or(0.0)) {
            match axis {
                Axis::Wall => marks[i].on_wall_front = true,
                Axis::Forces => marks[i].on_forces_front = true,
            }
        }
    }
    Panel {
        name: kind.name,
        title: kind.title,
        label: kind.label,
        about: kind.about.clone(),
        floor,
        floor_words,
        marks,
    }
}

/// Wall time and pair forces for each particle and τ. What blew up before it could be timed stands where a run with
/// another step says that it would, and else where a model of the costs does.
fn cost(bench: &Workbench, chart: &Chart, point: &ChartedPoint) -> Option<(f64, f64)> {
    if let Some(cost) = point.cost() {
        return Some((cost.wall.median, cost.pair_forces_per_atom_tau));
    }
    point.not_timed.as_ref()?;
    let alike = |other: &&ChartedPoint| {
        let same_step = Settings {
            dt: point.settings.dt,
            ..other.settings.clone()
        };
        same_step == point.settings
    };
    let by_step = chart
        .points
        .iter()
        .filter(alike)
        .filter_map(|other| {
            let cost = other.cost()?;
            let ratio = other.settings.dt / point.settings.dt;
            Some((
                cost.wall.median * ratio,
                cost.pair_forces_per_atom_tau * ratio,
            ))
        })
        .next_back();
    by_step.or_else(|| {
        let seconds = crate::settings::modelled_work(bench.scene(), bench.start(), &point.settings);
        let evaluations = f64::from(point.settings.integrator.spec().force_evaluations.max(1));
        let pairs = bench.pair_forces(&point.settings, evaluations / point.settings.dt);
        Some((seconds / bench.start().len() as f64, pairs.ok()?))
    })
}

/// Those that nothing cheaper, or equally cheap, equals in error. Errors below the floor count as the floor: chance has
/// no place on the front.
fn front(marks: &[Mark], axis: Axis, floor: f64) -> Vec<usize> {
    let size = |m: &Mark| m.error.map(|e| e.abs().max(floor));
    let mut order: Vec<usize> = (0..marks.len())
        .filter(|i| marks[*i].error.is_some_and(f64::is_finite))
        .collect();
    order.sort_by(|a, b| {
        let (a, b) = (&marks[*a], &marks[*b]);
        a.cost(axis).total_cmp(&b.cost(axis)).then(
            size(a)
                .unwrap_or(f64::NAN)
                .total_cmp(&size(b).unwrap_or(f64::NAN)),
        )
    });
    let mut least = f64::INFINITY;
    let mut on_front = Vec::new();
    for i in order {
        let Some(error) = size(&marks[i]) else {
            continue;
        };
        if error < least {
            least = error;
            on_front.push(i);
        }
    }
    on_front
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(number: usize, wall: f64, error: Option<f64>) -> Mark {
        Mark {
            number,
            wall,
            wall_range: None,
            pair_forces: 1.0 / wall,
            error,
            standard_error: None,
            failure: error.is_none().then(|| "blew up".into()),
            on_wall_front: false,
            on_forces_front: false,
        }
    }

    #[test]
    fn the_front_holds_what_nothing_cheaper_beats() {
        let marks = [
            mark(1, 1.0, Some(-0.3)),
            mark(2, 2.0, Some(0.4)),
            mark(3, 3.0, Some(0.01)),
            mark(4, 4.0, Some(0.001)),
            mark(5, 0.5, None),
            mark(6, 1.0, Some(0.2)),
        ];
        let numbers = |axis, floor| -> Vec<usize> {
            front(&marks, axis, floor)
                .iter()
                .map(|i| marks[*i].number)
                .collect()
        };
        assert_eq!(numbers(Axis::Wall, 0.0), [6, 3, 4]);
        // Below the floor 4 is no better than 3.
        assert_eq!(numbers(Axis::Wall, 0.02), [6, 3]);
        // Counted the other way round, the dearest is the cheapest.
        assert_eq!(numbers(Axis::Forces, 0.0), [4]);
    }
}
