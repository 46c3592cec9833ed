//! The exchange of velocities of a stage, between its steps, and the profile that it leaves.

use std::any::Any;

use lennard_core::{Doubt, Observable};
use lennard_integrators::{ExchangeOptions, Exchanged};
use lennard_observables::{BuildContext, Driven, ExchangeProfile};
use lennard_scene::Scene;

use crate::Simulation;
use crate::schedule::Trigger;

/// When an exchange is due.
pub(crate) fn trigger(options: &ExchangeOptions) -> Trigger {
    Trigger::Every(options.every)
}

/// The exchange of the measured stages, which all have the same.
fn measured(scene: &Scene) -> Option<&ExchangeOptions> {
    let stage = scene.stages.iter().find(|stage| stage.measure)?;
    stage.exchange.as_ref()
}

/// The observable that measured stages with an exchange have besides the ones of the scene.
pub(crate) fn profile(scene: &Scene, context: &BuildContext) -> Option<ExchangeProfile> {
    let options = measured(scene)?;
    let driven = match options.kind {
        Exchanged::Heat => Driven::Heat,
        Exchanged::Momentum => Driven::Momentum(options.along()),
    };
    Some(ExchangeProfile::new(driven, options.axis, options.slabs, context))
}

/// What an exchange makes of the means of other observables.
pub(crate) fn doubt(scene: &Scene) -> Option<Doubt> {
    let options = measured(scene)?;
    Some(Doubt::Thermostat {
        why: format!(
            "an exchange drives {} through the fluid: a mean over the profile",
            options.kind.name()
        ),
        sets_it: false,
    })
}

/// Whether an observable is the profile of the exchange itself.
pub(crate) fn is_profile(observable: &dyn Observable) -> bool {
    let any: &dyn Any = observable;
    any.is::<ExchangeProfile>()
}

impl Simulation {
    /// Exchanges velocities where that is due. Energy and momentum stay, so that nothing else has to know.
    pub(crate) fn exchange(&mut self) {
        let step = self.state.step;
        let stage = self.current_stage();
        let (measure, options) = (stage.measure, stage.exchange.clone());
        let Some(options) = options.filter(|o| trigger(o).is_due(step, measure)) else {
            return;
        };
        let mass = self.system.masses.of(0);
        let state = &mut self.state;
        let carried = options.apply(&state.cell, &state.positions, mass, &mut state.velocities);
        if !measure {
            return;
        }
        for observer in &mut self.observers {
            let any: &mut dyn Any = observer.observable.as_mut();
            if let Some(profile) = any.downcast_mut::<ExchangeProfile>() {
                profile.add_carried(carried);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_a_driven_fluid_say_so_and_keep_their_errors() {
        let text = "[system]\nn_atoms = 256\ndensity = 0.3\ntemperature = 1.5\n[[stage]]\nname = \"a\"\nsteps = 10\n";
        let with = |exchange: &str| {
            let overrides = [("stage.a.exchange".to_owned(), exchange.to_owned())];
            doubt(&Scene::parse(text, "scene.toml", &overrides).unwrap_or_else(|e| panic!("{e}")))
        };
        assert_eq!(with("none"), None);
        let doubt = with("momentum").expect("a doubt");
        assert!(!doubt.takes_the_error());
        assert_eq!(
            doubt.reason(1),
            "an exchange drives momentum through the fluid: a mean over the profile"
        );
    }
}
