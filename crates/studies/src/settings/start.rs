//! The equilibrated start that all settings share.

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_engine::{Beginning, Simulation, Unfollowed};
use lennard_integrators::{ThermostatOptions, bussi};
use lennard_scene::{Scene, Stage};

use crate::StudyError;

/// Time for which a scene that goes straight to measuring is brought to its temperature, τ.
const EQUILIBRATION_TIME: f64 = 8.0;
/// Relaxation time of the bath that does it, τ.
const RELAXATION_TIME: f64 = 0.1;

/// Where all runs begin.
#[derive(Debug, Clone)]
pub struct Start {
    /// The box.
    pub cell: PeriodicBox,
    /// Positions, `[N]`, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ.
    pub velocities: Vec<DVec3>,
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
        before.stages = scene
            .stages
            .iter()
            .take_while(|s| !s.measure)
            .cloned()
            .collect();
        if before.stages.is_empty() {
            before.stages.push(Stage {
                name: "equilibrate".into(),
                steps: (EQUILIBRATION_TIME / scene.integrator.dt).ceil() as u64,
                temperature: measured_stage(scene).temperature,
                dt: None,
                thermostat: Some(ThermostatOptions::Bussi(bussi::Options {
                    tau: RELAXATION_TIME,
                })),
                measure: false,
            });
        }
        let mut simulation = lennard_engine::prepare(before)?;
        simulation.run(&mut Unfollowed)?;
        let Simulation { state, .. } = simulation;
        Ok(Self {
            cell: state.cell,
            positions: state.positions,
            velocities: state.velocities,
        })
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

    /// The same place for a simulation to begin from.
    pub(crate) fn beginning(&self) -> Beginning {
        Beginning {
            cell: self.cell,
            positions: self.positions.clone(),
            velocities: Some(self.velocities.clone()),
            relax: false,
        }
    }
}

/// The stage that is measured: the last that is, or the last of all.
pub(crate) fn measured_stage(scene: &Scene) -> &Stage {
    let measured = scene.stages.iter().rev().find(|s| s.measure);
    measured
        .or(scene.stages.last())
        .expect("a scene has a stage: its reader refuses one without")
}
