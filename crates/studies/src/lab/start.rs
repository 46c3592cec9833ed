//! The equilibrated start that all settings share.

use glam::DVec3;
use lennard_core::{
    Configuration, Energetics, ForceError, ForceTerm, Part, PeriodicBox, SpeciesTable, State,
    System, Want,
};
use lennard_engine::{
    Beginning, EngineError, Simulation, Unfollowed, measured_stage, prepare_from,
};
use lennard_forcefield::PairForces;
use lennard_integrators::{ThermostatOptions, bussi};
use lennard_scene::{Scene, Stage};

use crate::StudyError;

/// Time for which a scene that goes straight to measuring is brought to its temperature, τ.
const EQUILIBRATION_TIME: f64 = 8.0;
/// The most steps of that stage, however short they are.
const MOST_STEPS: u64 = 100_000;
/// Relaxation time of the bath that does it, τ.
const RELAXATION_TIME: f64 = 0.1;

/// Steps of `dt` τ that bring a scene to its temperature.
fn equilibration_steps(dt: f64) -> u64 {
    ((EQUILIBRATION_TIME / dt).ceil() as u64).min(MOST_STEPS)
}

/// A stage that brings a scene to the temperature of its measured stage, with a bath that acts within 0.1 τ.
pub(crate) fn to_temperature(scene: &Scene, steps: u64) -> Stage {
    Stage {
        steps,
        ..under_bussi("equilibrate", measured_stage(scene).temperature, RELAXATION_TIME)
    }
}

/// A stage without steps under a bath of Bussi, Donadio and Parrinello with the relaxation time `tau`, at one temperature.
pub(crate) fn under_bussi(name: &str, temperature: f64, tau: f64) -> Stage {
    Stage {
        name: name.into(),
        steps: 0,
        temperature,
        temperature_from: None,
        barostat: None,
        exchange: None,
        dt: None,
        thermostat: Some(ThermostatOptions::Bussi(bussi::Options { tau })),
        measure: false,
    }
}

/// Where all runs begin.
#[derive(Debug, Clone)]
pub struct Start {
    /// The box.
    pub cell: PeriodicBox,
    /// Positions, `[N]`, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ.
    pub velocities: Vec<DVec3>,
    /// The species of each particle.
    pub species: SpeciesTable,
}

impl Start {
    /// Runs what a scene does before it measures, with the scene's own settings. A scene that measures from the first
    /// step on is brought to its temperature for 8 τ.
    ///
    /// # Errors
    /// [`StudyError::Engine`] where the scene cannot be built or its equilibration fails.
    pub fn equilibrate(scene: &Scene) -> Result<Self, StudyError> {
        let mut before = scene.clone();
        before.observables.clear();
        before.stages = scene.stages.iter().take_while(|s| !s.measure).cloned().collect();
        if before.stages.is_empty() {
            before.stages.push(to_temperature(scene, equilibration_steps(scene.integrator.dt)));
        }
        let mut simulation = lennard_engine::prepare(before)?;
        simulation.run(&mut Unfollowed)?;
        Ok(simulation.into())
    }

    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is no particle.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Number density, σ⁻³.
    #[must_use]
    pub fn density(&self) -> f64 {
        self.positions.len() as f64 / self.cell.volume()
    }

    /// Number density of molecules of a scene, σ⁻³; of particles where it has none.
    pub(crate) fn density_of_molecules(&self, scene: &Scene) -> f64 {
        self.density() / scene.molecules().sites() as f64
    }

    /// Box and positions.
    pub(crate) fn configuration(&self) -> Configuration<'_> {
        Configuration::at_rest(&self.cell, &self.positions)
    }

    /// Masses and species of the particles.
    pub(crate) fn system(&self) -> System {
        System::of_species(self.species.clone())
    }

    /// The start as the state of a run.
    pub(crate) fn state(&self) -> State {
        State::new(self.cell, self.positions.clone(), self.velocities.clone())
    }

    /// A simulation of a scene from this start.
    pub(crate) fn simulation(&self, scene: Scene) -> Result<Simulation, EngineError> {
        let beginning = Beginning {
            cell: self.cell,
            positions: self.positions.clone(),
            velocities: Some(self.velocities.clone()),
            species: self.species.clone(),
            relax: false,
        };
        prepare_from(scene, beginning)
    }

    /// The forces of a scene in this box.
    pub(crate) fn forces(&self, scene: &Scene) -> Result<PairForces, EngineError> {
        Ok(lennard_engine::forces(scene, self.cell, &self.species)?.1)
    }

    /// Energies at the start by one part of the forces, and that part of the forces, `[N]` in ε/σ.
    pub(crate) fn evaluate(
        &self,
        forces: &mut impl ForceTerm,
        part: Part,
        want: Want,
    ) -> Result<(Energetics, Vec<DVec3>), ForceError> {
        let mut out = vec![DVec3::ZERO; self.len()];
        let energies = forces.evaluate(self.configuration(), part, want, &mut out)?;
        Ok((energies, out))
    }
}

impl From<Simulation> for Start {
    fn from(simulation: Simulation) -> Self {
        Self {
            cell: simulation.state.cell,
            positions: simulation.state.positions,
            velocities: simulation.state.velocities,
            species: simulation.system.species().clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::equilibration_steps;

    #[test]
    fn a_tiny_step_does_not_make_an_endless_equilibration() {
        assert_eq!(equilibration_steps(0.004), 2000);
        assert_eq!(equilibration_steps(1e-9), 100_000);
    }
}
