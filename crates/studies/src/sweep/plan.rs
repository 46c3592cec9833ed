//! From the tables of a study file to its points.
//!
//! A plan has the names of the points and no scene, so that one point of many thousands is found at once. In Rust a study runs so:
//!
//! ```no_run
//! use lennard_studies::sweep;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let plan = sweep::plan("studies/mine.toml".as_ref(), &[])?;
//! for planned in &plan.points {
//!     // Keys of the scene with their values, as `--set` takes them.
//!     println!("{}: {:?}", planned.name, planned.overrides());
//! }
//! // With scenes that are read and checked; `sweep::run_points` runs them, and gives means, errors and costs of each.
//! let sweep = plan.sweep()?;
//! # let _ = sweep;
//! # Ok(())
//! # }
//! ```

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lennard_core::random::Streams;
use lennard_scene::study::{Axis, AxisTable, AxisValue, LONGER, SEED, SHORT_KEYS, StudyFile};
use lennard_scene::{Name, Scene, SceneError, Source};
use rand::Rng;
use serde::Serialize;

use super::SweepError;
use crate::compare::StateOfMatter;

/// The most points that one process runs.
const MOST_POINTS: usize = 10_000;
/// The most points that a cluster shares.
const MOST_SHARED: usize = 100_000;
/// The most times that a point may be longer than the others.
const MOST_LONGER: f64 = 1e6;
/// The key of the name of a row, where `[[point]]` or `[zip]` gives one.
const NAME: &str = "name";

/// A value that a study chose.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SettingValue {
    /// A number.
    Number(f64),
    /// Anything else, in words.
    Words(String),
}

impl std::fmt::Display for SettingValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Words(words) => f.write_str(words),
        }
    }
}

/// What a study chose for one key of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Setting {
    /// The key: a short name, a key of the scene, or `name` where the study names the row.
    pub key: String,
    /// Its value.
    pub value: SettingValue,
}

/// One point.
#[derive(Debug, Clone)]
pub struct Point {
    /// Its name and the name of its folder: `rho0.85-T1.128`.
    pub name: Name,
    /// What the study chose for it, without the seed.
    pub settings: Vec<Setting>,
    /// Its scene.
    pub scene: Scene,
    /// Number of particles.
    pub atoms: usize,
    /// Their density in σ⁻³.
    pub density: f64,
}

impl Point {
    /// Its state by what was asked for, and the phase there by the equation of state of its model.
    #[must_use]
    pub fn planned(&self) -> StateOfMatter {
        let model = lennard_scene::model_kind(&self.scene);
        let equation = lennard_literature::equation_of_state_for(model).ok();
        StateOfMatter::new(self.density, self.scene.system.temperature, equation)
    }
}

/// A sweep, read and checked.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Its name; the file's stem unless the file gives another.
    pub name: Name,
    /// The file of its base scene.
    pub base: PathBuf,
    /// Its points, in the order of the file.
    pub points: Vec<Point>,
    /// Points that do not fit the scene, where a shipped study is laid over a scene of the user's.
    pub left_out: Vec<LeftOut>,
    /// What is read from them; empty where the study names nothing.
    pub readings: Vec<String>,
    /// The study file, for what is found wrong later.
    pub source: Source,
}

/// What was not tried, with the reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, serde::Deserialize)]
pub struct LeftOut {
    /// Which.
    pub what: String,
    /// Why.
    pub why: String,
}

impl LeftOut {
    /// The reason in one line.
    pub(crate) fn of(what: &str, error: &dyn std::fmt::Display) -> Self {
        let text = error.to_string();
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        Self { what: what.to_owned(), why: lines.join("; ") }
    }
}

/// The value that a point has on an axis.
#[derive(Debug, Clone)]
struct Choice {
    axis: Arc<Axis>,
    which: usize,
    /// Whether the row has a name, which stands for its values.
    is_named: bool,
}

impl Choice {
    fn value(&self) -> &AxisValue {
        &self.axis.values[self.which]
    }

    fn is_seed(&self) -> bool {
        self.axis.key == SEED
    }
}

/// A point before its scene is read.
#[derive(Debug, Clone)]
pub struct PlannedPoint {
    /// The name that the point has.
    pub name: Name,
    /// The names of its rows.
    names: Vec<String>,
    choices: Vec<Choice>,
}

impl PlannedPoint {
    /// The keys of the study that the point sets, with their values in words.
    pub fn values(&self) -> impl Iterator<Item = (&str, &str)> {
        self.choices.iter().map(|choice| (&*choice.axis.key, &*choice.value().words))
    }

    /// The keys of the scene that the point sets, with their values as `--set` takes them.
    #[must_use]
    pub fn overrides(&self) -> Vec<(String, String)> {
        let pair = |c: &Choice| Some((c.axis.scene_key()?.to_owned(), c.value().text.clone()));
        self.choices.iter().filter_map(pair).collect()
    }

    /// What was chosen, without the seed.
    pub(crate) fn settings(&self) -> Vec<Setting> {
        let is_state = |c: &&Choice| !c.is_named && !c.is_seed() && c.axis.scene_key().is_some();
        let chosen = self.choices.iter().filter(is_state).map(|choice| {
            let words = &choice.value().words;
            let number = words.parse().map(SettingValue::Number);
            let value = number.unwrap_or_else(|_| SettingValue::Words(words.clone()));
            Setting { key: choice.axis.key.clone(), value }
        });
        let named = (!self.names.is_empty()).then(|| Setting {
            key: NAME.to_owned(),
            value: SettingValue::Words(self.names.join(", ")),
        });
        named.into_iter().chain(chosen).collect()
    }

    /// The name of the state: the name of the point, with or without the seed.
    fn name_of(names: &[String], choices: &[Choice], with_seed: bool) -> String {
        let of_values = choices.iter().filter(|c| !c.is_named && (with_seed || !c.is_seed()));
        let parts = of_values.filter_map(part_of_name);
        names.iter().cloned().chain(parts).collect::<Vec<_>>().join("-")
    }
}

/// How a value stands in the name of a point: `rho0.85`, `shift`, `steps2500`. `None` for what is no part of a name.
fn part_of_name(choice: &Choice) -> Option<String> {
    let words = &choice.value().words;
    if let Some(short) = choice.axis.short() {
        let words: String = plain(&words.replace(' ', ""));
        return short.key.map(|_| format!("{}{words}", short.prefix));
    }
    let is_text = choice.value().text.starts_with(['"', '\'', '[', '{']);
    let last = choice.axis.key.rsplit('.').next().unwrap_or_default();
    let part = match words.starts_with(|c: char| c.is_ascii_alphabetic()) {
        _ if is_text => words.clone(),
        true => format!("{last}-{words}"),
        false => format!("{last}{words}"),
    };
    Some(plain(&part))
}

/// The text with dashes for what no name has.
fn plain(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    text.chars().map(|c| if is_plain(c) { c } else { '-' }).collect()
}

/// A study file, read, with the names of its points.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Its name; the file's stem unless the file gives another.
    pub name: Name,
    /// The study file.
    pub file: PathBuf,
    /// Its points, in the order of the file.
    pub points: Vec<PlannedPoint>,
    pub(super) study: StudyFile,
    /// Scene keys of all points, with their values.
    common: Vec<(String, String)>,
}

impl Plan {
    /// The points of a study file, with overrides for every point.
    ///
    /// # Errors
    /// [`SweepError`] where the file is wrong, or has more points than a cluster shares.
    pub(super) fn new(
        file: &Path,
        mut study: StudyFile,
        overrides: &[(String, String)],
    ) -> Result<Self, SweepError> {
        let common: Vec<(String, String)> = study.set.iter().chain(overrides).cloned().collect();
        if study.has_multiples() {
            study.multiply(&Scene::load(&study.base, &common)?)?;
        }
        let (name, points) = (study.name.clone(), expand(&study)?);
        Ok(Self { name, file: file.to_owned(), points, common, study })
    }

    /// The base scene, with what the study sets for all points.
    pub(super) fn base_scene(&self) -> Result<Scene, SweepError> {
        Ok(Scene::load(&self.study.base, &self.common)?)
    }

    /// Refuses keys that the scene has not got: of each key the first point that has it is read.
    pub(super) fn check_keys(&self) -> Result<(), SweepError> {
        let mut known: BTreeSet<*const Axis> = BTreeSet::new();
        for point in &self.points {
            if point.choices.iter().any(|c| !known.contains(&Arc::as_ptr(&c.axis))) {
                self.scene(point)?;
                known.extend(point.choices.iter().map(|c| Arc::as_ptr(&c.axis)));
            }
        }
        Ok(())
    }

    /// Refuses more points than one process runs.
    pub(super) fn fits_one_process(&self) -> Result<(), SceneError> {
        match self.points.len() > MOST_POINTS {
            true => Err(too_many(&self.study, MOST_POINTS)),
            false => Ok(()),
        }
    }

    /// The sweep with all its points.
    ///
    /// # Errors
    /// [`SweepError`] where the scene of a point is wrong.
    pub fn sweep(&self) -> Result<Sweep, SweepError> {
        self.part(0..self.points.len())
    }

    /// The sweep with some of its points, by number from 0; numbers beyond the last point are left out.
    ///
    /// # Errors
    /// [`SweepError`] where the scene of one of these points is wrong.
    pub fn part(&self, numbers: Range<usize>) -> Result<Sweep, SweepError> {
        let end = numbers.end.min(self.points.len());
        let planned = &self.points[numbers.start.min(end)..end];
        Ok(Sweep {
            name: self.name.clone(),
            base: self.study.base.clone(),
            points: planned.iter().map(|p| self.point(p)).collect::<Result<_, _>>()?,
            left_out: Vec::new(),
            readings: self.study.readings.clone(),
            source: self.study.source.clone(),
        })
    }

    /// The sweep with the points that fit the base scene; the others are left out, each with the reason.
    ///
    /// # Errors
    /// The first [`SweepError`] where no point fits that sets a key.
    pub(super) fn fitting(&self) -> Result<Sweep, SweepError> {
        let mut sweep = self.part(0..0)?;
        let (mut n_fitting, mut first) = (0, None);
        for planned in &self.points {
            match self.point(planned) {
                Ok(point) => {
                    sweep.points.push(point);
                    n_fitting += usize::from(!planned.overrides().is_empty());
                }
                Err(error) => {
                    let why: &dyn std::fmt::Display = match &error {
                        SweepError::Scene { source, .. } => source,
                        other => other,
                    };
                    sweep.left_out.push(LeftOut::of(planned.name.as_str(), why));
                    first.get_or_insert(error);
                }
            }
        }
        match first.filter(|_| n_fitting == 0) {
            Some(error) => Err(error),
            None => Ok(sweep),
        }
    }

    /// Checks the scenes of all points, and keeps none.
    ///
    /// # Errors
    /// [`SweepError`] where the scene of a point is wrong.
    pub fn check(&self) -> Result<(), SweepError> {
        self.points.iter().try_for_each(|point| self.point(point).map(drop))
    }

    /// The number of a point that is given by its number or its name.
    ///
    /// # Errors
    /// [`SweepError::File`] with the nearest name.
    pub fn number_of(&self, point: &str) -> Result<usize, SweepError> {
        let by_number = point.parse().ok().filter(|n| *n < self.points.len());
        let by_name = || self.points.iter().position(|p| p.name == point);
        by_number.or_else(by_name).ok_or_else(|| {
            let names = self.points.iter().map(|p| p.name.as_str());
            let last = self.points.len() - 1;
            let unknown = self.study.source.without_key(format!("there is no point `{point}`"));
            let allowed = format!("a number from 0 to {last}, or the name of a point");
            unknown.allowed(allowed).suggestion(lennard_scene::nearest(point, names)).into()
        })
    }

    /// The scene of a point before the seed is its own.
    fn scene(&self, planned: &PlannedPoint) -> Result<Scene, SweepError> {
        let mut own = planned.overrides();
        // What is typed for all points must not undo what makes the points different.
        let is_common = |(key, _): &&(String, String)| own.iter().all(|(k, _)| k != key);
        let mut all: Vec<(String, String)> =
            self.common.iter().filter(is_common).cloned().collect();
        all.append(&mut own);
        all.push(("name".into(), format!("{:?}", planned.name.as_str())));
        Scene::load(&self.study.base, &all).map_err(|source| self.refused(planned, source))
    }

    /// The trouble with the scene of a point, at the line of the study where that is at fault.
    fn refused(&self, planned: &PlannedPoint, source: SceneError) -> SweepError {
        let chosen = planned.choices.iter().map(|c| (&*c.axis, c.value()));
        match self.study.trace(&source, chosen) {
            Some(traced) => traced.into(),
            None => SweepError::Scene { point: planned.name.to_string(), source },
        }
    }

    /// Reads the scene of a point, and checks it.
    fn point(&self, planned: &PlannedPoint) -> Result<Point, SweepError> {
        let mut scene = self.scene(planned)?;
        let state = PlannedPoint::name_of(&planned.names, &planned.choices, false);
        scene.system.seed = seed_of_point(scene.system.seed, &state);
        let longer = planned.choices.iter().find(|c| c.axis.key == LONGER);
        if let Some(longer) = longer.and_then(|c| c.value().words.parse::<f64>().ok()) {
            for stage in scene.stages.iter_mut().filter(|stage| stage.measure) {
                stage.steps = (stage.steps as f64 * longer).round() as u64;
            }
        }
        // A lock file belongs to one state: settings of a sweep are written by hand.
        scene.settled().map_err(|source| self.refused(planned, source))?;
        let (atoms, density) = lennard_engine::size_and_density(&scene).map_err(|source| {
            SweepError::Start { point: planned.name.to_string(), source: Box::new(source) }
        })?;
        let (name, mut settings) = (planned.name.clone(), planned.settings());
        // A quantity with a unit is a number for figures.
        for Setting { key, value } in &mut settings {
            let short = SHORT_KEYS.iter().find(|short| short.name == *key);
            let key = short.and_then(|short| short.key).unwrap_or(key);
            if let Some((_, reduced)) = scene.source.quantities().get(key) {
                *value = SettingValue::Number(*reduced);
            }
        }
        Ok(Point { name, settings, scene, atoms, density })
    }
}

/// The seed of a point: the first number of a stream of `seed` that is named after the point, such as
/// `sweep/rho0.85-T1.128`. The last bit is dropped, so that a scene file can hold the number. Here `seed` is the seed of
/// the scene or of the point, and the name is the name of the point without its seed.
///
/// With one seed for all points, points would feel the same noise of their heat baths, and their results would err alike.
fn seed_of_point(seed: u64, name: &str) -> u64 {
    let stream = format!("sweep/{name}");
    Streams::new(seed).sequential(&stream).next_u64() >> 1
}

/// A point in the making: the names of its rows, and its values.
#[derive(Debug, Clone, Default)]
struct Row {
    names: Vec<String>,
    choices: Vec<Choice>,
}

impl Row {
    /// The row of the `which`th values of some axes.
    fn of(name: Option<&String>, axes: &[Arc<Axis>], which: usize) -> Self {
        let is_named = name.is_some();
        let choice = |axis: &Arc<Axis>| Choice { axis: Arc::clone(axis), which, is_named };
        Self {
            names: name.into_iter().cloned().collect(),
            choices: axes.iter().map(choice).collect(),
        }
    }
}

/// Each row of some with each of others, the others running fastest; one more than the most where there are more.
fn multiplied(rows: &[Row], others: &[Row]) -> Vec<Row> {
    let joined = |row: &Row, other: &Row| Row {
        names: row.names.iter().chain(&other.names).cloned().collect(),
        choices: row.choices.iter().chain(&other.choices).cloned().collect(),
    };
    let all = rows.iter().flat_map(|row| others.iter().map(move |other| joined(row, other)));
    all.take(MOST_SHARED + 1).collect()
}

/// Every combination of the values of some axes.
fn product(table: &AxisTable) -> Vec<Row> {
    let name = table.names.first();
    table.axes.iter().fold(vec![Row::of(name, &[], 0)], |rows, axis| {
        let axis = [Arc::new(axis.clone())];
        let of_axis = |which| Row { names: Vec::new(), ..Row::of(name, &axis, which) };
        multiplied(&rows, &(0..axis[0].values.len()).map(of_axis).collect::<Vec<_>>())
    })
}

/// The first values of all axes, then the second ones.
fn zipped(table: &AxisTable) -> Vec<Row> {
    let axes: Vec<Arc<Axis>> = table.axes.iter().map(|axis| Arc::new(axis.clone())).collect();
    let length = axes.first().map_or(0, |axis| axis.values.len());
    (0..length).map(|which| Row::of(table.names.get(which), &axes, which)).collect()
}

/// All points: `[[point]]` × `[zip]` × `[grid]`.
fn expand(study: &StudyFile) -> Result<Vec<PlannedPoint>, SceneError> {
    no_key_twice(study)?;
    good_lengths(study)?;
    let listed = study.points.iter().flat_map(product).take(MOST_SHARED + 1).collect();
    let factors = [
        (!study.points.is_empty()).then_some(listed),
        study.zip.as_ref().map(zipped),
        study.grid.as_ref().map(product),
    ];
    let factors = factors.into_iter().flatten();
    let points = factors.fold(vec![Row::default()], |points, rows| multiplied(&points, &rows));
    if points.len() > MOST_SHARED {
        return Err(too_many(study, MOST_SHARED));
    }
    let is_none = |row: &Row| {
        row.names.is_empty() && row.choices.iter().all(|c| c.axis.scene_key().is_none())
    };
    // A list without values leaves no combination; a table without keys is no point, unless it names the base scene.
    if points.is_empty() || points.iter().any(is_none) {
        return Err(no_points(study));
    }
    let mut taken = BTreeSet::new();
    let mut planned = Vec::with_capacity(points.len());
    for Row { names, mut choices } in points {
        choices.sort_by_key(|choice| choice.axis.rank());
        let text = PlannedPoint::name_of(&names, &choices, true);
        let Some(name) = Name::new(&*text) else {
            return Err(refuse(study, "point")
                .found(format!("values that name the point {text:?}"))
                .allowed(format!("values that make a name: {}", Name::ALLOWED)));
        };
        if !taken.insert(name.clone()) {
            return Err(refuse(study, "point")
                .found(format!("{name} twice"))
                .allowed("each point once"));
        }
        planned.push(PlannedPoint { name, names, choices });
    }
    Ok(planned)
}

fn refuse(study: &StudyFile, key: &str) -> SceneError {
    study.source.refuse(key, "is not allowed")
}

fn too_many(study: &StudyFile, most: usize) -> SceneError {
    let way = match most {
        MOST_POINTS => "; `--points`, `--point` and `--emit` share more out to many processes",
        _ => "",
    };
    refuse(study, "grid")
        .found(format!("more than {most} points"))
        .allowed(format!("at most {most}{way}"))
}

fn no_points(study: &StudyFile) -> SceneError {
    let keys = SHORT_KEYS.iter().filter(|short| short.key.is_some()).map(|short| short.name);
    let keys: Vec<&str> = keys.collect();
    refuse(study, "point").found("a sweep with no points").allowed(format!(
        "[[point]] tables, a [zip] or a [grid] of {} or any key of the scene, with at least one value each (`{LONGER}` makes none)",
        keys.join(", ")
    ))
}

/// Refuses a key in two of the tables that are multiplied.
fn no_key_twice(study: &StudyFile) -> Result<(), SceneError> {
    let point = study.points.iter().map(|table| ("[[point]]", table));
    let rest = [("[zip]", &study.zip), ("[grid]", &study.grid)];
    let rest = rest.into_iter().filter_map(|(name, table)| Some((name, table.as_ref()?)));
    let all: Vec<(&str, &AxisTable)> = point.chain(rest).collect();
    for (name, table) in &all {
        for axis in &table.axes {
            let has_it = |t: &AxisTable| t.axes.iter().any(|other| other.key == axis.key);
            let earlier = all.iter().take_while(|(other, _)| other != name);
            if let Some((other, _)) = earlier.into_iter().find(|(_, t)| has_it(t)) {
                return Err(refuse(study, &axis.path)
                    .found(format!("a key that {other} has too"))
                    .allowed("each key in one of the two"));
            }
        }
    }
    Ok(())
}

/// Refuses a `longer` that is no number in its range.
fn good_lengths(study: &StudyFile) -> Result<(), SceneError> {
    let tables = study.points.iter().chain(&study.zip).chain(&study.grid);
    for axis in tables.flat_map(|table| &table.axes).filter(|axis| axis.key == LONGER) {
        let is_good =
            |v: &AxisValue| v.text.parse().is_ok_and(|x: f64| x > 0.0 && x <= MOST_LONGER);
        if let Some(bad) = axis.values.iter().find(|value| !is_good(value)) {
            return Err(refuse(study, &axis.path)
                .found(&bad.text)
                .allowed(format!("a number above 0 and up to {MOST_LONGER}")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
