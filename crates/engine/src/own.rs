//! Parts of a simulation that a program brings, beside what its scene names.

use std::sync::Arc;

use lennard_core::{
    Configuration, DVec3, ForceProperties, ForceTerm, Integrator, Method, Part, PeriodicBox, Want,
};
use lennard_observables::Observable;
use lennard_scene::{ProgramParts, Scene, SceneError};

use crate::schedule::Observer;

/// Forces, an integrator and observables of a program of one's own.
///
/// A simulation makes each part anew where it needs one, as a clone of what was given. The resolved scene names the parts in
/// `[program]`: no scene file holds them, so that the command line refuses to run or to resume it.
#[derive(Clone, Default)]
pub struct OwnParts {
    forces: Vec<OwnForce>,
    method: Option<OwnMethod>,
    observables: Vec<OwnObservable>,
}

#[derive(Clone)]
struct OwnForce {
    name: String,
    properties: ForceProperties,
    make: Arc<dyn Fn() -> Box<dyn ForceTerm> + Send + Sync>,
}

#[derive(Clone)]
struct OwnMethod {
    name: &'static str,
    make: Arc<dyn Fn() -> Integrator + Send + Sync>,
}

#[derive(Clone)]
struct OwnObservable {
    name: &'static str,
    every: u64,
    make: Arc<dyn Fn() -> Box<dyn Observable> + Send + Sync>,
}

impl OwnParts {
    /// No part.
    #[must_use]
    pub fn none() -> Self {
        Self::default()
    }

    /// With a force term that acts beside the forces of the scene. The name stands in the resolved scene.
    #[must_use]
    pub fn force(
        mut self,
        name: impl Into<String>,
        term: impl ForceTerm + Clone + Sync + 'static,
    ) -> Self {
        self.forces.push(OwnForce {
            name: name.into(),
            properties: term.properties(),
            make: Arc::new(move || Box::new(term.clone())),
        });
        self
    }

    /// With a method in the place of the scene's integrator; the scene keeps its `dt`.
    #[must_use]
    pub fn method(mut self, method: impl Method + Clone + Sync + 'static) -> Self {
        self.method = Some(OwnMethod {
            name: method.spec().name,
            make: Arc::new(move || Integrator::new(method.clone())),
        });
        self
    }

    /// With an observable that samples every so many steps of measured stages.
    #[must_use]
    pub fn observable(
        mut self,
        every: u64,
        observable: impl Observable + Clone + Sync + 'static,
    ) -> Self {
        self.observables.push(OwnObservable {
            name: observable.spec().name,
            every: every.max(1),
            make: Arc::new(move || Box::new(observable.clone())),
        });
        self
    }

    /// The name of the method; `None` where the scene's own is used.
    pub(crate) fn method_name(&self) -> Option<&'static str> {
        self.method.as_ref().map(|m| m.name)
    }

    /// The names of the observables.
    pub(crate) fn observable_names(&self) -> impl Iterator<Item = &'static str> {
        self.observables.iter().map(|o| o.name)
    }

    /// Their names, as the resolved scene has them.
    #[must_use]
    pub fn names(&self) -> ProgramParts {
        let of_kind = |fields: bool| {
            let kind = self.forces.iter().filter(move |f| f.is_field() == fields);
            kind.map(|f| f.name.clone()).collect()
        };
        ProgramParts {
            fields: of_kind(true),
            forces: of_kind(false),
            integrator: self.method_name().map(str::to_owned),
            observables: self.observable_names().map(str::to_owned).collect(),
        }
    }

    /// The scene with the names of these parts.
    ///
    /// # Errors
    /// [`SceneError`] where it names other parts, or does not go with these.
    pub(crate) fn enter(&self, scene: Scene) -> Result<Scene, SceneError> {
        let names = self.names();
        if scene.program == names {
            return Ok(scene);
        }
        if !scene.program.is_empty() {
            let found = format!(
                "{}, and the program that reads it brings {}",
                scene.program.in_words(),
                names.in_words()
            );
            let allowed =
                "a run by the program that brings these parts, or the scene without `[program]`";
            return Err(scene.invalid("program", found, allowed));
        }
        scene.with_program(names)
    }

    /// The axes along which a force of the program changes the total momentum.
    pub(crate) fn pushed(&self) -> [bool; 3] {
        let all = self.forces.iter().map(|f| f.properties);
        all.fold(ForceProperties::default(), ForceProperties::with_term).breaks_momentum
    }

    /// The force terms, made anew.
    pub(crate) fn make_forces(&self) -> impl Iterator<Item = Box<dyn ForceTerm>> {
        self.forces.iter().map(|f| (f.make)())
    }

    /// The method, made anew; `None` where the scene's own is used.
    pub(crate) fn make_method(&self) -> Option<Integrator> {
        self.method.as_ref().map(|m| (m.make)())
    }

    /// The observables, made anew.
    pub(crate) fn make_observers(&self) -> impl Iterator<Item = Observer> {
        self.observables.iter().map(|o| Observer { every: o.every, observable: (o.make)() })
    }

    /// Whether each force keeps its contract at the start.
    pub(crate) fn check_forces(
        &self,
        scene: &Scene,
        cell: &PeriodicBox,
        positions: &[DVec3],
        velocities: &[DVec3],
    ) -> Result<(), SceneError> {
        let at = Configuration {
            velocities: Some(velocities),
            ..Configuration::at_rest(cell, positions)
        };
        for own in &self.forces {
            own.keeps_its_contract(at).map_err(|(found, allowed)| {
                let key = if own.is_field() { "program.fields" } else { "program.forces" };
                scene.invalid(key, format!("`{}`, {found}", own.name), allowed)
            })?;
        }
        Ok(())
    }
}

/// How near `force_on` must come to `evaluate`, relative to the force: both are rounded alike except for the order of sums.
const SAME_FORCE: f64 = 1e-9;
/// So many forces are compared at most: of a term that sums over pairs, one alone costs as much as there are particles.
const FORCES_COMPARED: usize = 200;
/// Everything that a run may ask of a force.
const ALL: Want =
    Want { energy: true, virial: true, virial_tensor: true, laplacian: true, per_particle: true };

impl OwnForce {
    fn is_field(&self) -> bool {
        self.properties.breaks_momentum.contains(&true)
    }

    /// Whether the term gives all that may be wanted, and the same force by both roads; else what it does and what it must do.
    fn keeps_its_contract(&self, at: Configuration<'_>) -> Result<(), (String, &'static str)> {
        let mut term = (self.make)();
        // What stood there before must not count.
        let mut forces = vec![DVec3::NAN; at.positions.len()];
        let found = term
            .evaluate(at, Part::All, ALL, &mut forces)
            .map_err(|e| (format!("which fails at the start: {e}"), "finite forces"))?;
        let given = [
            ("energy", found.potential_energy.is_some() && found.conserved_potential.is_some()),
            ("virial", found.virial.is_some()),
            ("Laplacian", found.laplacian.is_some()),
            ("energy of each particle", found.per_particle.is_some()),
        ];
        if let Some((missing, _)) = given.iter().find(|(_, given)| !given) {
            let allowed = "a term that gives what it is asked for; 0 where it has none";
            return Err((format!("which gives no {missing}"), allowed));
        }
        if let Some(i) = forces.iter().position(|f| !f.is_finite()) {
            let found = format!("whose force on particle {} is {}", i + 1, forces[i]);
            return Err((found, "a term that writes a finite force for each particle"));
        }
        let largest = forces.iter().map(|f| f.length()).fold(0.0, f64::max);
        let apart = forces.len().div_ceil(FORCES_COMPARED);
        for (i, force) in forces.iter().enumerate().step_by(apart) {
            let alone = term.force_on(i, at);
            if (alone - *force).length() > SAME_FORCE * largest {
                let found = format!(
                    "whose `force_on` gives {alone} for particle {}, and `evaluate` {force}",
                    i + 1
                );
                return Err((
                    found,
                    "the same force by both: the watchdog checks one by the other",
                ));
            }
        }
        Ok(())
    }
}
