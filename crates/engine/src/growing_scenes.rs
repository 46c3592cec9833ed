//! Scenes without an end that is planned from the start: what a program adds to them while it runs.
//!
//! A scene has at least one measured stage. Where none is planned yet, one stands in at the end; it is never run, and what a
//! user sees does not have it.

use lennard_scene::{Scene, SceneError, Stage};
use toml::{Table, Value};

use crate::Simulation;

/// The stage that stands in where a scene has no measured stage yet. It is the last one and is never run.
const STAND_IN: &str = "unplanned";

/// A scene from its text. Where it has no stages, one stands in.
///
/// # Errors
/// [`SceneError`] for the first thing that is wrong.
pub fn from_text(
    text: &str,
    name: &str,
    overrides: &[(String, String)],
) -> Result<Scene, SceneError> {
    let has_stages = match text.parse::<Table>() {
        Ok(table) => table.contains_key("stage"),
        Err(_) => true, // The reader says what is wrong.
    };
    let scene = if has_stages || overrides.iter().any(|(key, _)| key == "stage") {
        Scene::parse(text, name, overrides)
    } else {
        let stage = format!("\n[[stage]]\nname = \"{STAND_IN}\"\nsteps = 1\n");
        Scene::parse(&(text.to_owned() + &stage), name, overrides)
    };
    scene.map_err(SceneError::without_line)
}

/// The stages that are to be run: all but the one that stands in.
#[must_use]
pub fn planned_stages(scene: &Scene) -> &[Stage] {
    match scene.stages.split_last() {
        Some((last, others)) if last.name == STAND_IN => others,
        _ => &scene.stages,
    }
}

/// The number of steps that are to be run.
#[must_use]
pub fn planned_steps(scene: &Scene) -> u64 {
    planned_stages(scene).iter().map(|s| s.steps).sum()
}

/// A scene as TOML, without the stage that stands in.
///
/// A scene of the command line needs a measured stage. Where it has none, the last one is marked, which changes no step.
#[must_use]
pub fn planned_text(scene: &Scene) -> String {
    let mut told = scene.clone();
    let stands_in = planned_stages(scene).len() < scene.stages.len();
    told.stages = planned_stages(scene).to_vec();
    if let Some(last) = told.stages.last_mut() {
        last.measure |= stands_in;
        return told.resolved_toml();
    }
    let text = told.resolved_toml();
    match text.parse::<Table>() {
        Ok(mut table) => {
            table.remove("stage");
            table.to_string()
        }
        Err(_) => text,
    }
}

/// Puts a stage at the end that stands in for a measured one, where there is none.
fn with_stand_in(mut scene: Scene) -> Scene {
    if !scene.stages.iter().any(|s| s.measure) {
        scene.stages.push(Stage {
            name: STAND_IN.into(),
            steps: 1,
            temperature: scene.system.temperature,
            temperature_from: None,
            dt: None,
            thermostat: None,
            barostat: None,
            exchange: None,
            measure: true,
        });
    }
    scene
}

/// What is added to a scene, each as TOML.
pub struct Addition<'a> {
    /// The keys of a stage.
    pub stage: &'a str,
    /// Tables `[[observable]]` in the place of the tables of the scene.
    pub observables: Option<&'a str>,
    /// Keys over the keys of `[output]`.
    pub output: Option<&'a str>,
}

fn table(text: &str) -> Result<Table, SceneError> {
    // The reader of scenes says what is wrong with a text; it has read ours already.
    text.parse::<Table>().or_else(|_| Scene::parse(text, "scene", &[]).map(|_| Table::new()))
}

/// The scene of a simulation with a stage more. No stage before it is measured any more.
///
/// # Errors
/// [`SceneError`] for the first thing that is wrong.
pub fn with_stage(simulation: &Simulation, addition: &Addition<'_>) -> Result<Scene, SceneError> {
    let scene = simulation.scene_to_grow();
    let mut all = table(&scene.resolved_toml())?;
    let stage = table(addition.stage)?;
    let is_measured = stage.get("measure") != Some(&Value::Boolean(false));
    if let Some(Value::Array(all)) = all.get_mut("stage") {
        all.truncate(planned_stages(&scene).len());
        for stage in all.iter_mut().filter_map(Value::as_table_mut) {
            stage.insert("measure".to_owned(), Value::Boolean(false));
        }
        all.push(Value::Table(stage));
        if !is_measured {
            let stand_in = format!("name = \"{STAND_IN}\"\nsteps = 1\n");
            all.push(Value::Table(table(&stand_in)?));
        }
    }
    if let Some(text) = addition.observables {
        let observables = table(text)?.remove("observable");
        all.insert("observable".to_owned(), observables.unwrap_or(Value::Array(Vec::new())));
    }
    if let (Some(text), Some(Value::Table(output))) = (addition.output, all.get_mut("output")) {
        output.extend(table(text)?);
    }
    Scene::parse(&all.to_string(), scene.source.file(), &[]).map_err(SceneError::without_line)
}

/// The scene of a simulation whose last stage is longer.
///
/// # Errors
/// [`SceneError`] where that stage is a ramp: a longer ramp is another one.
pub fn prolonged(simulation: &Simulation, steps: u64) -> Result<Scene, SceneError> {
    let mut scene = simulation.scene_to_grow();
    let Some(last) = planned_stages(&scene).len().checked_sub(1) else {
        return Ok(scene);
    };
    if scene.stages[last].is_ramp() {
        let key = format!("stage.{last}.steps");
        let found = format!("{steps} more steps of a ramp");
        let refused = scene.source.invalid(&key, found, "a new stage: run(steps, …)");
        return Err(refused.without_line());
    }
    let stage = &mut scene.stages[last];
    stage.steps = stage.steps.saturating_add(steps);
    Ok(scene)
}

/// The scene of a simulation that ends where it is: steps and stages to come are dropped.
#[must_use]
pub fn ended(simulation: &Simulation) -> Scene {
    let mut scene = simulation.scene_to_grow();
    match &simulation.stage {
        None => scene.stages.clear(),
        Some(under_way) => {
            scene.stages.truncate(under_way.index + 1);
            scene.stages[under_way.index].steps = under_way.steps_done.max(1);
        }
    }
    with_stand_in(scene)
}
