//! The equilibrated start that all settings share.

use std::time::{Duration, Instant};

use glam::DVec3;
use lennard_core::{
    Configuration, Energetics, ForceError, ForceTerm, Momentum, Part, PeriodicBox, SpeciesTable,
    State, System, Want,
};
use lennard_engine::stopwatch::timed;
use lennard_engine::{EngineError, Simulation, Unfollowed, measured_stage, prepare_from, take};
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

/// Where all runs of a study begin: an equilibrated fluid.
///
/// Every study begins here. [`Start::equilibrate`] makes the start of a scene, shipped or a user's. [`Start::simulation`] runs the
/// engine's loop from there, [`super::Rig`] a method and [`Start::forces`] without the engine, and [`super::Workbench`] runs other
/// settings of the same scene.
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
        simulation.follow(&mut Unfollowed)?;
        Ok(simulation.into())
    }

    /// Runs a scene from its own beginning for `steps` steps, or for as long as `limit` allows, and tells how long a step takes then, s.
    ///
    /// # Errors
    /// [`EngineError`] where the scene cannot be built or its run fails.
    pub fn warmed(scene: Scene, steps: u64, limit: Duration) -> Result<(Self, f64), EngineError> {
        /// Steps between two looks at the clock, and steps that are timed.
        const LOOKS: u64 = 5;
        const TIMED: u64 = 20;
        let mut simulation = lennard_engine::prepare(scene)?;
        let end = Instant::now() + limit;
        while simulation.state.step < steps && Instant::now() < end {
            take(&mut simulation, LOOKS, Want::NOTHING)?;
        }
        let (seconds, taken) = timed(|| take(&mut simulation, TIMED, Want::NOTHING));
        taken?;
        Ok((simulation.into(), seconds / TIMED as f64))
    }

    /// A simulation of a scene from this start whose list is built and whose memory is touched, for a clock.
    ///
    /// # Errors
    /// [`EngineError`] where the scene cannot be built or its run fails.
    pub fn settled(&self, scene: Scene) -> Result<Simulation, EngineError> {
        let mut simulation = self.simulation(scene)?;
        take(&mut simulation, Self::SETTLING_STEPS, Want::NOTHING)?;
        Ok(simulation)
    }

    /// Steps that [`Start::settled`] takes: the list is built, memory is touched, caches are warm.
    pub const SETTLING_STEPS: u64 = 5;

    /// Temperature of the velocities, ε/k_B.
    #[must_use]
    pub fn temperature(&self) -> f64 {
        self.system().temperature(&self.velocities, Momentum::Conserved)
    }

    /// Number of particles.
    pub(crate) fn len(&self) -> usize {
        self.positions.len()
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
    #[must_use]
    pub fn system(&self) -> System {
        System::of_species(self.species.clone())
    }

    /// The start as the state of a run.
    #[must_use]
    pub fn state(&self) -> State {
        State::new(self.cell, self.positions.clone(), self.velocities.clone())
    }

    /// A simulation of a scene from this start.
    ///
    /// # Errors
    /// [`EngineError`] where the scene cannot be built.
    pub fn simulation(&self, scene: Scene) -> Result<Simulation, EngineError> {
        let Self { cell, positions, velocities, species } = self.clone();
        prepare_from(scene, lennard_engine::Start::at(cell, positions, velocities, species))
    }

    /// The forces of a scene in this box.
    ///
    /// # Errors
    /// [`EngineError`] where they do not fit.
    pub fn forces(&self, scene: &Scene) -> Result<PairForces, EngineError> {
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
