//! The diagrams as data: one kind of error each, never mixed. `panels.toml` says what each is about.

use lennard_observables::Estimate;
use serde::Deserialize;

use super::advice::advice;
use super::types::{Axis, Chart, ChartedPoint, Mark, Panel, median};
use crate::StudyError;
use crate::lab::{Failed, Measured, Workbench};
use crate::report::{ReportError, filled, significant};
use crate::settings::Settings;

/// An error counts as smaller than another from this share of it on: less is chance.
const SMALLER: f64 = 0.95;
/// Rounding of a number in double precision, 2⁻⁵³.
const ROUNDING: f64 = 1.1e-16;

#[derive(Deserialize)]
struct PanelTexts {
    panel: Vec<Panel>,
}

/// All diagrams of a chart.
///
/// # Errors
/// [`StudyError`] where the settings of the scene do not fit it, which they do.
pub(super) fn panels(bench: &Workbench, chart: &Chart) -> Result<Vec<Panel>, StudyError> {
    let texts: PanelTexts = toml::from_str(include_str!("panels.toml"))
        .map_err(|e| ReportError::Text(e.to_string()))?;
    let words = words(bench, chart)?;
    // A run that failed has no place where its model has no equation.
    let mut judged: Vec<usize> = Vec::new();
    for point in &chart.points {
        if bench.equation(&point.settings)?.is_ok() {
            judged.push(point.number);
        }
    }
    // The forces against the untruncated fluid tell more than precision does, where there is a cutoff at all.
    let has_cutoff = chart.against.reach.is_some();
    let mut panels = Vec::new();
    for mut panel in texts.panel {
        match panel.name.as_str() {
            "forces-untruncated" if !has_cutoff => continue,
            "forces-same-model" if has_cutoff => panel.in_overview = None,
            _ => {}
        }
        panel.about = filled(&panel.about, &words);
        panels.push(marked(bench, chart, &judged, panel));
    }
    Ok(panels)
}

/// What stands in the place of words in braces.
fn words(bench: &Workbench, chart: &Chart) -> Result<[(&'static str, String); 8], StudyError> {
    let against = &chart.against;
    let tightest = &chart.points[against.tightest];
    let equation = match bench.equation(&Settings::of(bench.scene()))? {
        Ok(name) => format!(
            "Each model is compared with its own equation of state, at the density and the temperature of its run: {name} \
             for the model of the scene. Models without an equation are not in this diagram, but in the next."
        ),
        Err(why) => format!(
            "Each model is compared with its own equation of state. For the model of the scene there is {why}: it is judged by \
             the tightest run alone."
        ),
    };
    let said = chart.points[0].measured().map_or(String::new(), |m| m.remarks.join("; "));
    let more = match equation.contains(&said) {
        true => String::new(),
        false => format!(" Of the scene's own: {said}."),
    };
    Ok([
        ("reach", significant(against.reach.unwrap_or(f64::NAN), 3)),
        ("beside the equation", equation + &more),
        ("tightest", tightest.number.to_string()),
        ("its label", tightest.label.clone()),
        ("its time", significant(chart.plan.tight_time, 3)),
        ("temperature", significant(against.slopes.temperature, 4)),
        ("slopes", against.slopes.source.clone()),
        ("short time", significant(chart.plan.short_time, 3)),
    ])
}

/// An error and its standard error, where it has one.
type Error = (f64, Option<f64>);

/// The error of a kind of a point that is measured, or why its run failed; nothing where such settings have none.
fn error_of(
    kind: &str,
    point: &ChartedPoint,
    chart: &Chart,
    judged: &[usize],
) -> Option<Result<Error, String>> {
    let errors = point.errors.as_ref()?;
    let run = |read: &dyn Fn(&Measured) -> Option<Estimate>| {
        let value = |m: &Measured| read(m).map(|v| (v.mean, Some(v.standard_error)));
        what_came_of(&errors.measured, value)
    };
    let tightest = &chart.points[chart.against.tightest];
    // A run is no judge of itself.
    let is_other = point.number != tightest.number;
    let is_judged = judged.contains(&point.number);
    match kind {
        "forces-same-model" => Some(Ok((errors.forces.same_model, None))),
        "forces-untruncated" => Some(Ok((errors.forces.untruncated?, None))),
        "energy-fluctuation" => what_came_of(&errors.measured, |m| Some((m.energy_rms, None))),
        "energy-drift" => run(&|m| Some(m.drift)),
        "temperatures" => run(&|m| Some(m.temperature_difference)),
        "energy-equation" if is_judged => {
            run(&|m| Some(m.against_equation.as_ref()?.potential_energy))
        }
        "pressure-equation" if is_judged => run(&|m| Some(m.against_equation.as_ref()?.pressure)),
        "energy-tightest" if is_other => run(&|m| {
            Some(
                m.potential_energy_at_reference
                    .minus(&tightest.measured()?.potential_energy_at_reference),
            )
        }),
        "pressure-tightest" if is_other => run(&|m| {
            Some(m.pressure_at_reference.minus(&tightest.measured()?.pressure_at_reference))
        }),
        "trajectory" => what_came_of(&errors.trajectory, |t| Some((t.distance, None))),
        "reversibility" => what_came_of(&errors.reversibility, |distance| Some((*distance, None))),
        _ => None,
    }
}

/// The error in what came of a part of the runs of a point.
fn what_came_of<T>(
    part: &Result<T, Failed>,
    read: impl Fn(&T) -> Option<Error>,
) -> Option<Result<Error, String>> {
    match part {
        Err(failed) => Some(Err(failed.reason.clone())),
        Ok(found) => read(found).filter(|(value, _)| value.is_finite()).map(Ok),
    }
}

/// Below what errors of a kind say nothing, and what makes that floor.
fn floor_of(kind: &str, chart: &Chart, marks: &[Mark]) -> (Option<f64>, &'static str) {
    let of_trajectory = |p: &ChartedPoint| Some(p.errors.as_ref()?.trajectory.as_ref().ok()?.floor);
    match kind {
        "forces-same-model" => (Some(ROUNDING), "rounding of one number"),
        "forces-untruncated" => (chart.against.left_out_of_forces, "what that sum leaves out"),
        "energy-fluctuation" | "reversibility" => (None, ""),
        "trajectory" => match median(chart.points.iter().filter_map(of_trajectory).collect()) {
            None => (None, ""),
            floor => (floor, "the tight trajectory itself"),
        },
        _ => {
            (median(marks.iter().filter_map(|m| m.standard_error).collect()), "one standard error")
        }
    }
}

/// The panel with the marks of all points that have such an error.
fn marked(bench: &Workbench, chart: &Chart, judged: &[usize], panel: Panel) -> Panel {
    let mark = |point: &ChartedPoint| {
        let (error, standard_error, failure) = match error_of(&panel.name, point, chart, judged)? {
            Ok((error, se)) => (Some(error), se, None),
            Err(why) => (None, None, Some(why)),
        };
        let (wall, pair_forces) = cost(bench, chart, point)?;
        Some(Mark {
            number: point.number,
            wall,
            wall_range: point.cost().map(|c| (c.wall.lowest, c.wall.highest)),
            pair_forces,
            error,
            standard_error,
            failure,
            ..Mark::default()
        })
    };
    let mut marks: Vec<Mark> = chart.points.iter().filter_map(mark).collect();
    let (floor, floor_words) = floor_of(&panel.name, chart, &marks);
    for axis in [Axis::Wall, Axis::Forces] {
        let all: Vec<&Mark> = marks.iter().collect();
        for i in front(&all, axis, floor.unwrap_or(0.0)) {
            match axis {
                Axis::Wall => marks[i].on_wall_front = true,
                Axis::Forces => marks[i].on_forces_front = true,
            }
        }
    }
    let advice = advice(chart, &marks, floor.unwrap_or(0.0));
    Panel { floor, floor_words, advice, marks, ..panel }
}

/// Wall time and pair forces for each particle and τ. A run may blow up before it is timed. Its cost then comes
/// from a run with another step, or else from a model of the costs.
fn cost(bench: &Workbench, chart: &Chart, point: &ChartedPoint) -> Option<(f64, f64)> {
    if let Some(cost) = point.cost() {
        return Some((cost.wall.median, cost.pair_forces_per_atom_tau));
    }
    point.not_timed.as_ref()?;
    let alike = |other: &&ChartedPoint| {
        let same_step = Settings { dt: point.settings.dt, ..other.settings.clone() };
        same_step == point.settings
    };
    let by_step = chart
        .points
        .iter()
        .filter(alike)
        .filter_map(|other| {
            let cost = other.cost()?;
            let ratio = other.settings.dt / point.settings.dt;
            Some((cost.wall.median * ratio, cost.pair_forces_per_atom_tau * ratio))
        })
        .next_back();
    by_step.or_else(|| {
        let seconds = crate::lab::modelled_work(bench.scene(), bench.start(), &point.settings);
        let evaluations = f64::from(point.settings.integrator.spec().force_evaluations.max(1));
        let pairs = bench.pair_forces(&point.settings, evaluations / point.settings.dt);
        Some((seconds / bench.start().len() as f64, pairs.ok()?))
    })
}

/// Those that nothing cheaper, or equally cheap, equals in error, up to a twentieth. Errors below the floor count as the floor: chance has
/// no place on the front. An error that is not known has none either.
pub(super) fn front(marks: &[&Mark], axis: Axis, floor: f64) -> Vec<usize> {
    let size = |m: &Mark| m.error.map(|e| e.abs().max(floor));
    let is_result = |m: &Mark| {
        m.error.is_some_and(f64::is_finite) && m.standard_error.is_none_or(f64::is_finite)
    };
    let mut order: Vec<usize> = (0..marks.len()).filter(|i| is_result(marks[*i])).collect();
    order.sort_by(|a, b| {
        let (a, b) = (marks[*a], marks[*b]);
        a.cost(axis)
            .total_cmp(&b.cost(axis))
            .then(size(a).unwrap_or(f64::NAN).total_cmp(&size(b).unwrap_or(f64::NAN)))
    });
    let mut least = f64::INFINITY;
    let mut on_front = Vec::new();
    for i in order {
        let Some(error) = size(marks[i]) else {
            continue;
        };
        if error < SMALLER * least {
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
        let failure = error.is_none().then(|| "blew up".into());
        Mark { number, wall, pair_forces: 1.0 / wall, error, failure, ..Mark::default() }
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
            let all: Vec<&Mark> = marks.iter().collect();
            front(&all, axis, floor).iter().map(|i| marks[*i].number).collect()
        };
        assert_eq!(numbers(Axis::Wall, 0.0), [6, 3, 4]);
        // A hair better is no better.
        let marks_alike = [mark(1, 1.0, Some(0.1)), mark(2, 2.0, Some(0.098))];
        assert_eq!(front(&marks_alike.iter().collect::<Vec<_>>(), Axis::Wall, 0.0), [0]);
        // Below the floor 4 is no better than 3.
        assert_eq!(numbers(Axis::Wall, 0.02), [6, 3]);
        // Counted the other way round, the dearest is the cheapest.
        assert_eq!(numbers(Axis::Forces, 0.0), [4]);
    }
}
