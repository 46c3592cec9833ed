//! From lists and grids to points.

use std::collections::BTreeSet;
use std::path::Path;

use lennard_core::random::Streams;
use lennard_scene::{Name, Scene};
use rand::Rng;
use serde::Serialize;

use super::SweepError;
use super::file::{Axes, OneOrMany};

/// The most points of one sweep.
const MOST_POINTS: usize = 10_000;

/// What a sweep chose for one key of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Setting {
    /// The key of the sweep.
    pub key: &'static str,
    /// Its value.
    pub value: f64,
}

/// One state point.
#[derive(Debug, Clone)]
pub struct Point {
    /// Its name and the name of its folder: `rho0.85-T1.128`.
    pub name: Name,
    /// What the sweep chose for it, without the seed.
    pub settings: Vec<Setting>,
    /// Its scene.
    pub scene: Scene,
    /// Number of particles.
    pub atoms: usize,
    /// Their density in σ⁻³.
    pub density: f64,
}

/// A point before its scene is read: its name, and the values of its keys.
#[derive(Debug, Clone)]
pub struct PlannedPoint {
    /// The name that the point has.
    pub name: Name,
    choice: Choice,
}

impl PlannedPoint {
    /// The keys of the sweep file that the point sets, with their values.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let chosen = KEYS.iter().zip(&self.choice);
        chosen.filter_map(|(key, value)| Some((key.name, value.as_deref()?)))
    }
}

/// A key of the sweep with its scene key and its short form in names.
struct Key {
    name: &'static str,
    /// Absent for what is no state, and so has no place in a name either.
    scene: Option<&'static str>,
    short: &'static str,
}

/// The key that makes independent runs of one state.
const SEED: &str = "seed";

const KEYS: [Key; 9] = [
    Key::new("density", Some("system.density"), "rho"),
    Key::new("temperature", Some("system.temperature"), "T"),
    Key::new("n_atoms", Some("system.n_atoms"), "N"),
    Key::new("n_molecules", Some("system.n_molecules"), "M"),
    Key::new("bond_length", Some("molecule.bond_length"), "L"),
    Key::new("r_cut", Some("truncation.r_cut"), "rc"),
    Key::new("dt", Some("integrator.dt"), "dt"),
    Key::new(SEED, Some("system.seed"), "seed"),
    Key::new("longer", None, ""),
];

impl Key {
    const fn new(name: &'static str, scene: Option<&'static str>, short: &'static str) -> Self {
        Self { name, scene, short }
    }
}
/// Where `longer` stands in [`KEYS`].
const LONGER: usize = KEYS.len() - 1;
/// The most times that a point may be longer than the others.
const MOST_LONGER: f64 = 1e6;

/// The values of the keys of one point, as text; `None` where the base scene decides.
type Choice = [Option<String>; KEYS.len()];

fn lists(axes: &Axes) -> [Option<Vec<String>>; KEYS.len()] {
    fn text<T: Clone + std::fmt::Display>(values: &Option<OneOrMany<T>>) -> Option<Vec<String>> {
        values.as_ref().map(|v| v.values().iter().map(ToString::to_string).collect())
    }
    [
        text(&axes.density),
        text(&axes.temperature),
        text(&axes.n_atoms),
        text(&axes.n_molecules),
        text(&axes.bond_length),
        text(&axes.r_cut),
        text(&axes.dt),
        text(&axes.seed),
        text(&axes.longer),
    ]
}

/// Every combination of the values of some axes, the last axis running fastest; one more than [`MOST_POINTS`] where there are more.
fn product(axes: &Axes) -> Vec<Choice> {
    let mut choices: Vec<Choice> = vec![Choice::default()];
    for (k, list) in lists(axes).into_iter().enumerate() {
        let Some(list) = list else { continue };
        choices = choices
            .iter()
            .flat_map(|choice| {
                list.iter().map(move |value| {
                    let mut choice = choice.clone();
                    choice[k] = Some(value.clone());
                    choice
                })
            })
            .take(MOST_POINTS + 1)
            .collect();
    }
    choices
}

/// All points: each `[[point]]` with its lists, times the grid.
pub(super) fn expand(
    file: &Path,
    points: &[Axes],
    grid: Option<&Axes>,
) -> Result<Vec<PlannedPoint>, SweepError> {
    let value = |key: String, found: String, allowed: &str| SweepError::Value {
        file: file.to_owned(),
        key,
        found,
        allowed: allowed.into(),
    };
    let no_points = || {
        let names: Vec<&str> = KEYS[..LONGER].iter().map(|key| key.name).collect();
        let (last, others) = names.split_last().unwrap_or((&"", &[]));
        let allowed = format!(
            "[[point]] tables, or a [grid] of {} and {last}, with at least one value each (`{}` makes none)",
            others.join(", "),
            KEYS[LONGER].name
        );
        value("point".into(), "a sweep with no points".into(), &allowed)
    };
    if points.is_empty() && grid.is_none() {
        return Err(no_points());
    }
    for longer in points.iter().chain(grid).flat_map(|axes| &axes.longer) {
        let bad = longer.values().into_iter().find(|x| !(*x > 0.0 && *x <= MOST_LONGER));
        if let Some(bad) = bad {
            let allowed = format!("a number above 0 and up to {MOST_LONGER}");
            return Err(value("point.longer".into(), bad.to_string(), &allowed));
        }
    }
    let listed: Vec<Choice> = if points.is_empty() {
        vec![Choice::default()]
    } else {
        points.iter().flat_map(product).take(MOST_POINTS + 1).collect()
    };
    let mut choices = Vec::new();
    for one in &listed {
        for cell in grid.map_or_else(|| vec![Choice::default()], product) {
            let mut both = one.clone();
            for (k, value_of_grid) in cell.into_iter().enumerate() {
                if value_of_grid.is_some() && both[k].is_some() {
                    let key = format!("grid.{}", KEYS[k].name);
                    return Err(value(
                        key,
                        "a key that [[point]] has too".into(),
                        "each key in one of the two",
                    ));
                }
                both[k] = both[k].take().or(value_of_grid);
            }
            choices.push(both);
            if choices.len() > MOST_POINTS {
                return Err(value(
                    "grid".into(),
                    format!("more than {MOST_POINTS} points"),
                    "fewer",
                ));
            }
        }
    }
    // A list without values leaves no combination; a table without keys is no point.
    if choices.is_empty() || choices.iter().any(|c| c[..LONGER].iter().all(Option::is_none)) {
        return Err(no_points());
    }
    let mut names = BTreeSet::new();
    choices
        .into_iter()
        .map(|choice| {
            let name = name_of(&chosen(&choice), |key| key.scene.is_some());
            let Some(name) = Name::new(&*name) else {
                return Err(value(
                    "point".into(),
                    format!("values that name the point {name:?}"),
                    &format!("values that make a name: {}", Name::ALLOWED),
                ));
            };
            if !names.insert(name.clone()) {
                return Err(value("point".into(), format!("{name} twice"), "each point once"));
            }
            Ok(PlannedPoint { name, choice })
        })
        .collect()
}

/// The keys that have a value, with their values.
fn chosen(choice: &Choice) -> Vec<(&'static Key, &String)> {
    KEYS.iter().zip(choice).filter_map(|(k, v)| Some((k, v.as_ref()?))).collect()
}

/// The values of some keys as a name: `rho0.85-T1.128`.
fn name_of(chosen: &[(&Key, &String)], takes: impl Fn(&Key) -> bool) -> String {
    let parts: Vec<String> = chosen
        .iter()
        .filter(|(key, _)| takes(key))
        .map(|(key, value)| format!("{}{value}", key.short))
        .collect();
    parts.join("-")
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

/// Reads the scene of a point, and checks it.
pub(super) fn point(
    base: &Path,
    common: &[(String, String)],
    planned: &PlannedPoint,
) -> Result<Point, SweepError> {
    let chosen = chosen(&planned.choice);
    let name = planned.name.clone();
    let mut overrides: Vec<(String, String)> = chosen
        .iter()
        .filter_map(|(key, value)| Some((key.scene?.to_owned(), (*value).clone())))
        .collect();
    // What is typed for all points must not undo what makes the points different.
    let mut all: Vec<(String, String)> =
        common.iter().filter(|(key, _)| overrides.iter().all(|(k, _)| k != key)).cloned().collect();
    all.append(&mut overrides);
    all.push(("name".into(), format!("{:?}", name.as_str())));
    let refused = |source| SweepError::Scene { point: name.to_string(), source };
    let mut scene = Scene::load(base, &all).map_err(refused)?;
    let state = name_of(&chosen, |key| key.scene.is_some() && key.name != SEED);
    scene.system.seed = seed_of_point(scene.system.seed, &state);
    if let Some(longer) = planned.choice[LONGER].as_ref().and_then(|x| x.parse::<f64>().ok()) {
        for stage in scene.stages.iter_mut().filter(|stage| stage.measure) {
            stage.steps = (stage.steps as f64 * longer).round() as u64;
        }
    }
    // A lock file belongs to one state: settings of a sweep are written by hand.
    scene.settled().map_err(refused)?;
    let (atoms, density) = lennard_engine::size_and_density(&scene).map_err(|source| {
        SweepError::Start { point: name.to_string(), source: Box::new(source) }
    })?;
    let settings = chosen
        .iter()
        .filter(|(key, _)| key.scene.is_some() && key.name != SEED)
        .filter_map(|(key, value)| Some(Setting { key: key.name, value: value.parse().ok()? }))
        .collect();
    Ok(Point { name, settings, scene, atoms, density })
}

#[cfg(test)]
mod tests;
