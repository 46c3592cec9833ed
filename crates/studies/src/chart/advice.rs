//! Where the scene's own settings stand among the others, and what a chart may advise.

use lennard_engine::stopwatch::BUSY;

use super::types::{Advice, Axis, Chart, ChartedPoint, Mark};
use crate::report::significant;

/// Standard errors within which a statistical error counts as known.
const CERTAIN: f64 = 2.0;
/// An error of one run, without a standard error and without a floor, counts as smaller from this share of another on.
const OF_ONE_RUN: f64 = 0.8;
/// Settings seem cheaper from this share of the median time on.
const WORTHWHILE: f64 = 0.95;
/// Errors that differ by less, as a share, are equal: sums in another order round otherwise.
const ROUNDING: f64 = 1e-9;
/// Advised steps are at most this share of the stability limit.
const STABLE_SHARE: f64 = 0.5;
/// Runs of a liquid near its triple point fail from this share of the rough limit on, 0.024 τ for velocity Verlet.
const LOWEST_LIMIT: f64 = 0.6;

/// On what advice rests, in sentences for a reader.
pub(crate) fn basis(chart: &Chart) -> String {
    let limit = chart.points.first().and_then(|own| {
        let dt = stability_limit(chart, own)?;
        let of = format!("{} τ for {}", significant(dt, 2), own.settings.integrator.name());
        Some(format!(" Their step is at most {STABLE_SHARE} of the stability limit ({of})."))
    });
    let cheaper = match chart.cost_by {
        Axis::Wall => "are faster in every timing",
        Axis::Forces => "take fewer pair forces in the same precision, by the same kind of list",
    };
    let scatter = chart.scatter();
    let busy = (scatter > BUSY).then(|| {
        let costs = match chart.cost_by {
            Axis::Wall => "costs are not known well",
            Axis::Forces => "cost is counted in pair forces",
        };
        format!(
            " Timings of the same settings differ by {:.0} %: the machine was busy, and {costs}.",
            100.0 * scatter
        )
    });
    format!(
        "Advised settings err no more, by {CERTAIN} standard errors on either side, and {cheaper}.{}{}",
        limit.unwrap_or_default(),
        busy.unwrap_or_default()
    )
}

/// Why no diagram tells the settings apart, in a sentence; `None` where one does, or where nothing is to be told.
pub(crate) fn unresolved(chart: &Chart) -> Option<String> {
    let advice: Vec<Advice> = chart.panels.iter().filter_map(|p| p.advice).collect();
    let is_told = |a: &Advice| *a != Advice::NotResolved;
    if advice.is_empty() || advice.iter().any(is_told) {
        return None;
    }
    let scatter = chart.scatter();
    let timings = match chart.cost_by {
        Axis::Wall if scatter > BUSY => {
            format!("timings of the same settings differ by {:.0} %, and ", 100.0 * scatter)
        }
        _ => String::new(),
    };
    Some(format!(
        "This chart cannot tell the settings apart: {timings}errors of runs of {} τ lie within their bars.",
        significant(chart.plan.time, 3)
    ))
}

/// What a panel with these marks advises; `None` where the error of the scene's own settings is not known.
///
/// The advice is the settings of least cost
/// - whose error is no larger than the scene's, even with two standard errors added to the first and taken off the
///   second. An error without a standard error must be no larger, or below the floor like the scene's. Where there is
///   no floor either, it must be smaller by a fifth;
/// - whose every timing is shorter than every timing of the scene, or which take fewer pair forces where cost is counted in
///   them;
/// - whose step is at most half of the stability limit, or no longer than the scene's step with the same method.
pub(super) fn advice(chart: &Chart, marks: &[Mark], floor: f64) -> Option<Advice> {
    let own = marks.iter().find(|m| m.number == 1)?;
    let by = chart.cost_by;
    let size = |m: &Mark| m.error.map(|e| e.abs().max(floor));
    let of_own = size(own)?;
    let (own_low, _) = own.cost_range(by).unwrap_or((own.cost(by), own.cost(by)));
    let seeming: Vec<&Mark> = marks
        .iter()
        .filter(|m| m.number != own.number && m.cost(by) < WORTHWHILE * own.cost(by))
        .filter(|m| size(m).is_some_and(|e| e <= (1.0 + ROUNDING) * of_own))
        .filter(|m| chart.is_comparable(m.number) && may_be_advised(chart, m.number))
        .collect();
    let is_known = |m: &&&Mark| {
        m.cost_range(by).is_some_and(|(_, high)| high < own_low) && is_no_worse(m, own, floor)
    };
    let cheapest = seeming.iter().filter(is_known).min_by(|a, b| a.cost(by).total_cmp(&b.cost(by)));
    Some(match cheapest {
        Some(mark) => Advice::Cheaper(mark.number),
        None if seeming.is_empty() => Advice::Itself,
        None => Advice::NotResolved,
    })
}

/// Whether the error of a mark is known to be no larger than the error of another.
fn is_no_worse(mark: &Mark, own: &Mark, floor: f64) -> bool {
    let (Some(error), Some(of_own)) = (mark.error, own.error) else {
        return false;
    };
    match (mark.standard_error, own.standard_error) {
        (None, None) if floor == 0.0 => error.abs() <= OF_ONE_RUN * of_own.abs(),
        (None, None) => error.abs().max(floor) <= (1.0 + ROUNDING) * of_own.abs().max(floor),
        (mine, theirs) => {
            let most = error.abs() + CERTAIN * mine.unwrap_or(0.0);
            most <= of_own.abs() - CERTAIN * theirs.unwrap_or(0.0)
        }
    }
}

/// Whether settings are of this engine, and keep away from the limit of stability.
fn may_be_advised(chart: &Chart, number: usize) -> bool {
    let (Some(point), Some(own)) = (chart.point(number), chart.points.first()) else {
        return false;
    };
    let same_method = point.settings.integrator == own.settings.integrator;
    let is_stable = (same_method && point.settings.dt <= own.settings.dt)
        || stability_limit(chart, point).is_none_or(|dt| point.settings.dt <= STABLE_SHARE * dt);
    point.engine.is_none() && is_stable
}

/// The step, τ, from which on a point's method may be unstable here. A cautious estimate comes from the closest approach of thermal
/// pairs, by their masses, and from springs. A shorter step at which a run of the chart failed tells more. None for a method without
/// a limit whose runs all held.
fn stability_limit(chart: &Chart, point: &ChartedPoint) -> Option<f64> {
    let limit = point.settings.integrator.spec().stability_limit;
    let rough = limit.map(|limit| LOWEST_LIMIT * limit * chart.against.step_of_fastest);
    let failed = chart
        .points
        .iter()
        .filter(|p| p.settings.integrator == point.settings.integrator)
        .filter(|p| p.errors.is_some() && p.measured().is_none())
        .map(|p| p.settings.dt);
    rough.into_iter().chain(failed).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::types::{Errors, Panel, Tightest, cost_by};
    use super::*;
    use crate::lab::{ForceErrors, Timing};
    use crate::settings::Settings;

    fn mark(number: usize, wall: f64, error: f64, standard_error: Option<f64>) -> Mark {
        let wall_range = Some((0.98 * wall, 1.02 * wall));
        let error = Some(error);
        Mark {
            number,
            wall,
            wall_range,
            pair_forces: wall,
            error,
            standard_error,
            ..Mark::default()
        }
    }

    /// A chart of settings with these steps.
    fn chart(steps: &[f64]) -> Chart {
        let text = "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 0.722\n[[stage]]\nname = \"s\"\nsteps = 10";
        let scene = lennard_scene::Scene::parse(text, "s.toml", &[]).unwrap();
        let points = steps.iter().enumerate().map(|(i, dt)| {
            let settings = Settings { dt: *dt, ..Settings::of(&scene) };
            ChartedPoint::new(i + 1, settings)
        });
        let step_of_fastest = lennard_engine::watchdog::rough_stable_dt(0.722, 1.0);
        Chart {
            against: Tightest { step_of_fastest, ..Tightest::default() },
            points: points.collect(),
            ..Chart::default()
        }
    }

    fn advised(chart: &Chart, marks: &[Mark]) -> Option<usize> {
        match advice(chart, marks, 1e-3)? {
            Advice::Cheaper(number) => Some(number),
            Advice::NotResolved => None,
            Advice::Itself => Some(1),
        }
    }

    #[test]
    fn steps_near_the_limit_of_stability_are_never_advised() {
        let steps = [0.004, 0.006, 0.0185];
        let exact = |number, wall| mark(number, wall, 1e-4, None);
        let mut of_forces = chart(&steps);
        let marks = [exact(1, 3.0), exact(2, 2.0), exact(3, 1.0)];
        let limit = stability_limit(&of_forces, &of_forces.points[2]).unwrap();
        assert!((0.022..0.026).contains(&limit), "{limit}");
        assert_eq!(advised(&of_forces, &marks), Some(2));
        // Particles that are four times as fast are told shorter steps.
        of_forces.against.step_of_fastest *= 0.25;
        assert_eq!(advised(&of_forces, &marks), Some(1));
        of_forces.against.step_of_fastest *= 4.0;
        // A run that failed at 0.01 tells more than the rough limit.
        let failed = || crate::lab::Failed { reason: "it blew up".into(), step: None };
        let mut point =
            ChartedPoint::new(4, Settings { dt: 0.01, ..of_forces.points[0].settings.clone() });
        point.errors = Some(Errors {
            forces: ForceErrors { same_model: 0.0, untruncated: None },
            measured: Err(failed()),
            trajectory: Err(failed()),
            reversibility: Err(failed()),
        });
        of_forces.points.push(point);
        assert_eq!(advised(&of_forces, &marks), Some(1));
        // A scene beyond the margin is not told to shorten its step, and not to lengthen it.
        let beyond = [0.0185, 0.0185, 0.02];
        assert_eq!(advised(&chart(&beyond), &marks), Some(2));
    }

    #[test]
    fn advice_that_would_come_from_noise_is_not_given() {
        let steps = [0.004, 0.006, 0.008];
        let noisy = |number, wall, error| mark(number, wall, error, Some(1e-3));
        // Of two errors that are both noise, the smaller is no better.
        let alike = vec![noisy(1, 3.0, 8e-4), noisy(2, 2.0, 2e-4)];
        assert_eq!(advised(&chart(&steps), &alike), None);
        let told = vec![noisy(1, 3.0, 9e-3), noisy(2, 2.0, 2e-3), noisy(3, 1.0, 8e-3)];
        assert_eq!(advised(&chart(&steps), &told), Some(2));
        let worse = vec![noisy(1, 3.0, 2e-3), noisy(2, 2.0, 9e-3)];
        assert_eq!(advised(&chart(&steps), &worse), Some(1));
        // Timings that overlap do not tell what is cheaper.
        let mut overlapping = vec![mark(1, 3.0, 1e-4, None), mark(2, 2.5, 1e-4, None)];
        overlapping[1].wall_range = Some((2.4, 3.1));
        assert_eq!(advised(&chart(&steps), &overlapping), None);
        overlapping[1].wall_range = Some((2.4, 2.6));
        assert_eq!(advised(&chart(&steps), &overlapping), Some(2));
        overlapping[0].wall_range = Some((2.5, 5.0));
        assert_eq!(advised(&chart(&steps), &overlapping), None);
        // What is hardly cheaper is not cheaper.
        let alike = vec![mark(1, 3.0, 1e-4, None), mark(2, 2.9, 1e-4, None)];
        assert_eq!(advised(&chart(&steps), &alike), Some(1));
    }

    #[test]
    fn disturbed_clocks_count_pair_forces_within_one_precision_and_one_sentence_says_what_is_not_told()
     {
        let mut busy = chart(&[0.004, 0.006, 0.006]);
        busy.points[2].settings.precision = lennard_forcefield::Precision::Mixed;
        for point in &mut busy.points {
            let timing = |s| Timing { seconds_per_atom_tau: s, evaluations_per_tau: 1.0, steps: 1 };
            point.timings = vec![timing(1e-6), timing(2e-6)];
            point.pair_forces_per_atom_tau = Some(1.0);
        }
        busy.cost_by = cost_by(&busy.points);
        assert_eq!(busy.cost_by, Axis::Forces);
        let mut marks =
            vec![mark(1, 3.0, 1e-4, None), mark(2, 2.5, 1e-4, None), mark(3, 1.0, 1e-4, None)];
        marks[1].wall_range = Some((2.0, 3.5));
        assert_eq!(advised(&busy, &marks), Some(2));
        assert!(basis(&busy).contains("differ by 67 %") && basis(&busy).contains("pair forces"));
        let mut quiet = busy.clone();
        quiet.points.iter_mut().for_each(|p| p.timings.truncate(1));
        assert_eq!(cost_by(&quiet.points), Axis::Wall);
        assert_eq!(unresolved(&quiet), None);
        quiet.panels = vec![Panel { advice: Some(Advice::NotResolved), marks, ..Panel::default() }];
        assert!(unresolved(&quiet).unwrap().contains("cannot tell the settings apart"));
        quiet.panels[0].advice = Some(Advice::Itself);
        assert_eq!(unresolved(&quiet), None);
    }

    #[test]
    fn what_is_known_to_err_no_more_is_told_from_what_only_seems_to() {
        let own = mark(1, 2.0, 0.1, Some(0.01));
        // 0.05 + 2·0.01 is below 0.1 − 2·0.01.
        assert!(is_no_worse(&mark(2, 1.0, -0.05, Some(0.01)), &own, 0.01));
        assert!(!is_no_worse(&mark(2, 1.0, 0.05, Some(0.02)), &own, 0.01));
        // Both below the floor: noise beside noise.
        let small = mark(1, 2.0, 0.005, Some(0.01));
        assert!(!is_no_worse(&mark(2, 1.0, 0.001, Some(0.01)), &small, 0.01));
        // Without a standard error the floor is the rounding.
        let exact = mark(1, 2.0, 1e-15, None);
        assert!(is_no_worse(&mark(2, 1.0, 2e-15, None), &exact, 1e-14));
        assert!(!is_no_worse(&mark(2, 1.0, 2e-14, None), &exact, 1e-14));
        // Of one run each, by how much they differ says nothing of how well they are known.
        assert!(!is_no_worse(&mark(2, 1.0, 0.9e-15, None), &exact, 0.0));
        assert!(is_no_worse(&mark(2, 1.0, 0.7e-15, None), &exact, 0.0));
    }
}
