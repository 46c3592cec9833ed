//! The heat baths of the measured stages, and what they make of the run.

use lennard_core::{Integrator, Ramp, ThermostatSpec};
use lennard_observables::{Ensemble, HeldTemperature};
use lennard_scene::{Scene, Stage};

use crate::own::OwnParts;

/// The thermostats of the measured stages.
pub(crate) fn measured_baths(scene: &Scene) -> Vec<&'static ThermostatSpec> {
    let measured = scene.stages.iter().filter(|s| s.measure);
    measured.filter_map(|s| Some(s.thermostat.as_ref()?.spec())).collect()
}

/// The ensemble that a stage samples; `None` where its dynamics sample none that is known.
pub(crate) fn ensemble(scene: &Scene, stage: &Stage, own: &OwnParts) -> Option<Ensemble> {
    let molecule = scene.molecule.as_ref();
    let by_bonds = molecule.is_some_and(|molecule| molecule.bonds.no_ensemble().is_some());
    if stage.is_ramp() || stage.exchange.is_some() || by_bonds {
        return None;
    }
    let canonical = stage.thermostat.as_ref().is_none_or(|bath| bath.spec().canonical);
    if let Some(control) = &stage.barostat {
        // A barostat without a thermostat beside it has one of its own.
        let pressure = control.pressure;
        return canonical.then_some(Ensemble::Isobaric { pressure });
    }
    match &stage.thermostat {
        Some(bath) => bath.spec().canonical.then_some(Ensemble::Canonical),
        // A method that loses energy stays at no energy.
        None => method(scene, own).spec().symplectic.then_some(Ensemble::Microcanonical),
    }
}

/// A fresh method: of the program where it brings one, else of the scene.
pub(crate) fn method(scene: &Scene, own: &OwnParts) -> Integrator {
    own.make_method().unwrap_or_else(|| lennard_integrators::build(&scene.integrator.method))
}

/// The temperature that the bath of the measured stages holds; `None` where they have none, or not all the same.
#[must_use]
pub fn held_temperature(scene: &Scene) -> Option<HeldTemperature> {
    let mut measured = scene.stages.iter().filter(|s| s.measure);
    let first = measured.next()?;
    let options = first.thermostat.as_ref()?;
    let bath = options.spec();
    let same = |s: &Stage| s.thermostat == first.thermostat && s.temperature == first.temperature;
    (bath.canonical && !first.is_ramp() && measured.all(same)).then_some(HeldTemperature {
        temperature: first.temperature,
        half_steps: bath.holds_half_steps,
        relaxation: options.relaxation(),
    })
}

/// The pressure that the barostat of the measured stages holds at each step; `None` without one.
pub(crate) fn measured_pressure(scene: &Scene) -> Option<Ramp> {
    let index = scene.stages.iter().position(|s| s.measure)?;
    let first = scene.steps_before(index);
    scene.stages[index].pressure_ramp(first)
}
