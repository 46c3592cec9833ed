//! What is asked of a chart, what is known of its points, and what its diagrams hold.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_engine::stopwatch::BUSY;
use serde::{Deserialize, Serialize};

use crate::lab::{Cost, Failed, ForceErrors, Measured, Slopes, Timing, TrajectoryError};
use crate::settings::Settings;
use crate::sweep::LeftOut;

/// How many settings are tried.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Size {
    /// A dozen and a half: a first look.
    Quick,
    /// Every dt with the methods that matter, and every truncation with every cutoff in both precisions, crossed where
    /// the two meet.
    #[default]
    Default,
    /// Everything with everything.
    Full,
}

/// How to make a chart.
pub struct ChartOptions<'a> {
    /// The output folder, which exists.
    pub folder: &'a Path,
    /// How many settings.
    pub size: Size,
    /// Whether what the folder holds is thrown away.
    pub anew: bool,
    /// Points whose errors are measured at once, one thread each. Costs are timed one after the other.
    pub workers: usize,
    /// Threads of each timed run.
    pub threads: usize,
    /// Whether the points of other engines are added, where they are installed.
    pub with_peers: bool,
    /// Set from outside to stop; what is finished is kept.
    pub stop: &'a AtomicBool,
    /// The command, for the page.
    pub command: String,
}

/// What is run for how long: a function of scene and size, never of a clock.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Lengths {
    /// How many settings are tried, in words.
    pub size: Size,
    /// Settings, the tightest included.
    pub points: usize,
    /// Time for which each run is measured, τ.
    pub time: f64,
    /// The same for the tightest run, τ.
    pub tight_time: f64,
    /// Length of the trajectories that are compared, and of the way there and back, τ.
    pub short_time: f64,
    /// Timings of each.
    pub repeats: usize,
    /// Length of a timing by a model of the costs, s.
    pub timing_seconds: f64,
    /// Threads of a timed run.
    pub threads: usize,
    /// The processor that the timings belong to.
    pub cpu: String,
    /// The version of the program.
    pub version: String,
}

/// The names by which files tell a result from a failure.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Result")]
enum Stored<T, E> {
    #[serde(rename = "found")]
    Ok(T),
    #[serde(rename = "failed")]
    Err(E),
}

/// All errors of one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Of the forces at the start.
    pub forces: ForceErrors,
    /// Of energy, temperature, U and P, over a run.
    #[serde(with = "Stored")]
    pub measured: Result<Measured, Failed>,
    /// Of a short trajectory.
    #[serde(with = "Stored")]
    pub trajectory: Result<TrajectoryError, Failed>,
    /// Distance from the start after the way there and back, σ.
    #[serde(with = "Stored")]
    pub reversibility: Result<f64, Failed>,
}

/// One choice of settings with what it costs and errs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChartedPoint {
    /// Its number on the diagrams, from 1.
    pub number: usize,
    /// Another engine, by name; absent for this one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine: Option<String>,
    /// The settings in a line.
    pub label: String,
    /// The settings.
    pub settings: Settings,
    /// Pair forces for each particle and τ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pair_forces_per_atom_tau: Option<f64>,
    /// Why it could not be timed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_timed: Option<Failed>,
    /// The timings so far.
    #[serde(default)]
    pub timings: Vec<Timing>,
    /// Its errors, once they are measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors: Option<Errors>,
}

impl ChartedPoint {
    /// A point of which nothing is known yet.
    #[must_use]
    pub fn new(number: usize, settings: Settings) -> Self {
        Self {
            number,
            engine: None,
            label: settings.label(),
            settings,
            pair_forces_per_atom_tau: None,
            not_timed: None,
            timings: Vec::new(),
            errors: None,
        }
    }

    /// Its cost, once it is known.
    pub(crate) fn cost(&self) -> Option<Cost> {
        Cost::of(&self.timings, self.pair_forces_per_atom_tau?)
    }

    /// What its run measured, where it came to its end.
    #[must_use]
    pub fn measured(&self) -> Option<&Measured> {
        self.errors.as_ref()?.measured.as_ref().ok()
    }

    /// Why its run failed.
    #[must_use]
    pub fn failure(&self) -> Option<&Failed> {
        self.errors.as_ref()?.measured.as_ref().err()
    }

    /// Whether all is known of it but its costs.
    pub(crate) fn is_measured(&self) -> bool {
        self.errors.is_some()
    }

    /// Whether it has `repeats` timings, or cannot be timed.
    pub(crate) fn is_timed(&self, repeats: usize) -> bool {
        self.not_timed.is_some() || self.timings.len() >= repeats
    }
}

/// The two ways to count cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Wall time for each particle and τ, s.
    #[default]
    Wall,
    /// Pair forces for each particle and τ.
    Forces,
}

/// One error of one point.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
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
    /// Its standard error, where it is statistical; not a number where the run was too short to know it.
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
    pub(crate) fn cost(&self, axis: Axis) -> f64 {
        match axis {
            Axis::Wall => self.wall,
            Axis::Forces => self.pair_forces,
        }
    }

    /// The smallest and the largest cost that were seen: a count of pair forces has no range.
    pub(crate) fn cost_range(&self, axis: Axis) -> Option<(f64, f64)> {
        match axis {
            Axis::Wall => self.wall_range,
            Axis::Forces => Some((self.pair_forces, self.pair_forces)),
        }
    }

    /// Whether it is on the front by one of the two measures.
    pub(crate) fn on_front(&self, axis: Axis) -> bool {
        match axis {
            Axis::Wall => self.on_wall_front,
            Axis::Forces => self.on_forces_front,
        }
    }
}

/// What a diagram advises in place of the scene's own settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Advice {
    /// The point of this number costs less and errs no more, as far as both are known.
    Cheaper(usize),
    /// Some seem to cost less and to err no more, and the chart does not know their errors or costs well enough.
    NotResolved,
    /// Nothing costs less and errs no more.
    Itself,
}

/// A diagram: one kind of error.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Panel {
    /// File stem.
    pub name: String,
    /// Section of the page.
    #[serde(skip_serializing)]
    pub section: String,
    /// What the error is of.
    pub title: String,
    /// Label of the axis of the error.
    pub label: String,
    /// The error's name and unit in the first picture; absent where it is not in it.
    #[serde(skip_serializing)]
    pub in_overview: Option<String>,
    /// What is shown, in sentences.
    pub about: String,
    /// Errors below this say nothing.
    #[serde(skip_deserializing)]
    pub floor: Option<f64>,
    /// What makes that floor, in a few words.
    #[serde(skip_deserializing)]
    pub floor_words: &'static str,
    /// What would do as well as the scene's own settings for less; absent where their error is not known.
    #[serde(skip_deserializing)]
    pub advice: Option<Advice>,
    /// The points. Those for which there is no such error are not among them.
    #[serde(skip_deserializing)]
    pub marks: Vec<Mark>,
}

impl Panel {
    /// The mark of a point.
    pub(crate) fn mark(&self, number: usize) -> Option<&Mark> {
        self.marks.iter().find(|m| m.number == number)
    }
}

/// The tightest settings, which others are compared with, and the untruncated fluid.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Tightest {
    /// How runs are carried to one temperature.
    pub slopes: Slopes,
    /// The step at which ω·dt is 1 for the fastest pair or spring, τ: light and small particles are fast.
    pub step_of_fastest: f64,
    /// Farthest pairs in the forces of the untruncated fluid, σ; absent where the potential ends by itself.
    pub reach: Option<f64>,
    /// What that sum leaves out, relative to the forces.
    pub left_out_of_forces: Option<f64>,
    /// Index of the tightest point.
    pub tightest: usize,
}

/// A chart: every point with its costs and errors.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Chart {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// Particles.
    pub atoms: usize,
    /// Number density of the start, σ⁻³.
    pub density: f64,
    /// What was run for how long.
    pub plan: Lengths,
    /// Whether every point is finished.
    pub finished: bool,
    /// What errors are measured against.
    #[serde(flatten)]
    pub against: Tightest,
    /// How cost is counted where settings are compared: wall time, or pair forces where clocks were disturbed.
    pub cost_by: Axis,
    /// The points; the scene's own settings stand first.
    pub points: Vec<ChartedPoint>,
    /// Settings that were not tried, with the reason.
    pub left_out: Vec<LeftOut>,
    /// What else is to be known: engines that are not installed.
    pub remarks: Vec<String>,
    /// The diagrams.
    pub panels: Vec<Panel>,
    /// The command, for the page.
    #[serde(skip)]
    pub command: String,
}

impl Chart {
    /// The point of a number.
    pub(crate) fn point(&self, number: usize) -> Option<&ChartedPoint> {
        self.points.iter().find(|p| p.number == number)
    }

    /// The settings of a point in a line, with the engine where it is another.
    pub(crate) fn label(&self, number: usize) -> String {
        self.point(number).map_or_else(String::new, |point| match &point.engine {
            Some(engine) => format!("{engine}: {}", point.label),
            None => point.label.clone(),
        })
    }

    /// Whether the cost of a point may be compared with the cost of the scene's own settings. A pair force costs the same within one
    /// precision and one kernel alone.
    pub(crate) fn is_comparable(&self, number: usize) -> bool {
        let (Some(own), Some(point)) = (self.points.first(), self.point(number)) else {
            return false;
        };
        let (a, b) = (&own.settings, &point.settings);
        self.cost_by == Axis::Wall
            || (a.precision, a.list) == (b.precision, b.list) && point.engine.is_none()
    }

    /// `errors of 3 of 42 settings are measured, 0 are timed`.
    #[must_use]
    pub fn progress(&self) -> String {
        let count =
            |is: &dyn Fn(&ChartedPoint) -> bool| self.points.iter().filter(|p| is(p)).count();
        format!(
            "errors of {} of {} settings are measured, {} are timed",
            count(&ChartedPoint::is_measured),
            self.points.len(),
            count(&|p| p.is_timed(self.plan.repeats))
        )
    }

    /// By how much repeated timings differ, over their median. The scene's own settings count, or the middle one of all points where it
    /// differs more.
    #[must_use]
    pub fn scatter(&self) -> f64 {
        scatter(&self.points)
    }
}

/// As [`Chart::scatter`].
fn scatter(points: &[ChartedPoint]) -> f64 {
    let of = |p: &ChartedPoint| p.cost().map(|cost| cost.wall.scatter());
    let own = points.first().and_then(of).unwrap_or(0.0);
    median(points.iter().filter_map(of).collect()).unwrap_or(0.0).max(own)
}

/// How cost is counted: by wall time, unless clocks were disturbed.
pub(super) fn cost_by(points: &[ChartedPoint]) -> Axis {
    if scatter(points) > BUSY { Axis::Forces } else { Axis::Wall }
}

/// The middle one of the values that are finite.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
