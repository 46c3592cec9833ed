//! The diagrams as data: one kind of error each, never mixed.

use super::advice::advice;
use super::kinds::{Floor, Kind, kinds};
use super::types::{Axis, Chart, ChartedPoint, Mark, Panel, median};
use crate::StudyError;
use crate::lab::Workbench;
use crate::settings::Settings;

/// An error counts as smaller than another from this share of it on: less is chance.
const SMALLER: f64 = 0.95;

/// All diagrams of a chart.
///
/// # Errors
/// [`StudyError`] where the settings of the scene do not fit it, which they do.
pub(super) fn panels(bench: &Workbench, chart: &Chart) -> Result<Vec<Panel>, StudyError> {
    let kinds = kinds(bench, chart)?;
    Ok(kinds.iter().map(|kind| panel(bench, chart, kind)).collect())
}

fn panel(bench: &Workbench, chart: &Chart, kind: &Kind) -> Panel {
    let mut marks: Vec<Mark> = chart
        .points
        .iter()
        .filter_map(|point| {
            let (error, standard_error, failure) = match (kind.read)(point)? {
                Ok((error, se)) => (Some(error), se, None),
                Err(why) => (None, None, Some(why)),
            };
            let (wall, pair_forces) = cost(bench, chart, point)?;
            let spread = point.cost().map(|c| (c.wall.lowest, c.wall.highest));
            Some(Mark {
                number: point.number,
                wall,
                wall_range: spread,
                pair_forces,
                error,
                standard_error,
                failure,
                on_wall_front: false,
                on_forces_front: false,
            })
        })
        .collect();
    let (floor, floor_words) = match kind.floor {
        Floor::None => (None, ""),
        Floor::At(value, words) => (Some(value), words),
        Floor::Statistical => {
            (median(marks.iter().filter_map(|m| m.standard_error).collect()), "one standard error")
        }
    };
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
    Panel { floor, floor_words, advice, marks, ..kind.panel.clone() }
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
