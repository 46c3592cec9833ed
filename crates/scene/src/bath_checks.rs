//! What must hold between the baths of a stage, its step and what is measured.

use lennard_core::number::short;
use lennard_integrators::thermostats;

use crate::reference::quoted;
use crate::{PressureControl, Scene, SceneError, Stage};

/// The fewest relaxation times of the volume's proposals: below, the box jumps by more than it fluctuates.
const FEWEST_INTERVALS: f64 = 20.0;

/// Refuses observables whose equation needs a temperature that is held, where a measured stage holds none.
pub(crate) fn temperatures_are_held(scene: &Scene) -> Result<(), SceneError> {
    let free = scene.stages.iter();
    let Some(free) = free.filter(|s| s.measure).find(|s| !s.holds_one_temperature()) else {
        return Ok(());
    };
    for (i, table) in scene.observables.iter().enumerate() {
        if !table.options.needs_temperature() {
            continue;
        }
        let found = match &free.thermostat {
            None => "without thermostat".to_owned(),
            Some(_) if free.temperature_from.is_some() => {
                "with a ramp of the temperature".to_owned()
            }
            Some(bath) => format!("with thermostat {:?}", bath.name()),
        };
        let canonical = thermostats().iter().filter(|t| t.canonical);
        let names: Vec<&str> = canonical.map(|t| t.name).collect();
        return Err(scene
            .source
            .refuse(&format!("observable.{i}.kind"), "needs a temperature that is held")
            .found(format!(
                "{:?} in the measured stage {:?} {found}",
                table.options.name(),
                free.name
            ))
            .allowed(format!("thermostat = one of {}, at one temperature", quoted(&names))));
    }
    Ok(())
}

/// Whether each barostat has the bath, the interval and the observables that it needs.
pub(crate) fn barostats_fit(scene: &Scene) -> Result<(), SceneError> {
    for (i, stage) in scene.stages.iter().enumerate() {
        let Some(control) = &stage.barostat else {
            continue;
        };
        has_its_thermostat(scene, i, stage, control)?;
        is_slow_enough(scene, i, stage, control)?;
        if stage.measure {
            measures_no_flux(scene, i)?;
        }
    }
    Ok(())
}

fn has_its_thermostat(
    scene: &Scene,
    index: usize,
    stage: &Stage,
    control: &PressureControl,
) -> Result<(), SceneError> {
    let spec = control.options.spec();
    let suits =
        |name: &str, canonical: bool| canonical && spec.thermostat.is_none_or(|t| t == name);
    let bath = stage.thermostat.as_ref().map(|t| t.spec());
    if bath.is_some_and(|bath| suits(bath.name, bath.canonical)) {
        return Ok(());
    }
    let all = thermostats().iter();
    let fit: Vec<&str> = all.filter(|t| suits(t.name, t.canonical)).map(|t| t.name).collect();
    Err(scene
        .source
        .refuse(
            &format!("stage.{index}.barostat"),
            "needs a thermostat that samples the canonical ensemble beside it",
        )
        .found(bath.map_or_else(
            || format!("`{}` in a stage without thermostat", spec.name),
            |bath| format!("`{}` with thermostat `{}`", spec.name, bath.name),
        ))
        .allowed(match fit.as_slice() {
            [one] => format!("thermostat = {one:?}"),
            several => format!("thermostat = one of {}", quoted(several)),
        }))
}

fn is_slow_enough(
    scene: &Scene,
    index: usize,
    stage: &Stage,
    control: &PressureControl,
) -> Result<(), SceneError> {
    let (tau, interval) = (control.options.tau(), control.options.interval());
    let shortest = FEWEST_INTERVALS * interval as f64 * scene.stage_dt(stage);
    if tau >= shortest * (1.0 - 1e-12) {
        return Ok(());
    }
    Err(scene
        .source
        .refuse(
            &format!("stage.{index}.barostat.tau"),
            "is too short for the steps between two changes of the box",
        )
        .found(format!("tau = {tau} τ with {interval} steps of {} τ", scene.stage_dt(stage)))
        .allowed(format!(
            "at least {FEWEST_INTERVALS}·interval·dt = {} τ, or a smaller `interval`",
            short(shortest)
        )))
}

/// Refuses observables of fluxes through a box that changes.
fn measures_no_flux(scene: &Scene, index: usize) -> Result<(), SceneError> {
    for (i, table) in scene.observables.iter().enumerate() {
        let name = table.options.name();
        if !table.options.follows_changing_box() {
            return Err(scene
                .source
                .refuse(
                    &format!("observable.{i}.kind"),
                    "follows a flux, which a changing box disturbs",
                )
                .found(format!(
                    "{name:?} with a barostat in the measured stage {:?}",
                    scene.stages[index].name
                ))
                .allowed("a stage with barostat and `measure = false`, then a measured one without barostat"));
        }
    }
    Ok(())
}
