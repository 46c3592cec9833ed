//! The fluid of the study: state points, truncations, and equilibrated starts.

use lennard_core::Want;
use lennard_forcefield::{Precision, SplitOptions, TruncationKind, TruncationOptions};
use lennard_integrators::IntegratorOptions;
use lennard_scene::Scene;
use serde::Serialize;

use crate::StudyError;
use crate::lab::{Rig, Start};

/// Density of all state points, σ⁻³: the density of the liquid near its triple point.
pub const DENSITY: f64 = 0.8442;
/// Cutoff, σ.
pub const R_CUT: f64 = 2.5;
/// Atoms.
pub const ATOMS: usize = 256;
/// Steps of the equilibration.
const EQUILIBRATION_STEPS: u64 = 4000;
/// Where the near part of the force ends for methods that split it, and over which distance, σ.
const SPLIT: SplitOptions = SplitOptions { r_split: 1.7, width: 0.3 };

/// A state point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StatePoint {
    /// Name for files and legends.
    pub name: &'static str,
    /// T*, ε/k_B.
    pub temperature: f64,
}

/// The liquid near its triple point, and the same density at T* = 1.5 and 5.
pub const STATES: [StatePoint; 3] = [
    StatePoint { name: "T* = 0.722", temperature: 0.722 },
    StatePoint { name: "T* = 1.5", temperature: 1.5 },
    StatePoint { name: "T* = 5", temperature: 5.0 },
];

/// The truncations, with their names.
pub const TRUNCATIONS: [(TruncationKind, &str); 4] = [
    (TruncationKind::Cut, "cut"),
    (TruncationKind::Shift, "shift"),
    (TruncationKind::ForceShift, "force-shift"),
    (TruncationKind::Switch, "switch"),
];

/// An equilibrated state of one state point under one truncation.
#[derive(Debug, Clone)]
pub(crate) struct FluidStart {
    pub(crate) state_point: usize,
    pub(crate) truncation: usize,
    scene: Scene,
    start: Start,
}

impl FluidStart {
    /// Melts an fcc lattice and scales its velocities to the temperature, every 20 steps and at the end.
    pub(crate) fn equilibrate(
        state_point: usize,
        truncation: usize,
        quick: bool,
    ) -> Result<Self, StudyError> {
        let temperature = STATES[state_point].temperature;
        let steps = if quick { EQUILIBRATION_STEPS / 8 } else { EQUILIBRATION_STEPS };
        // The step is small enough for the hottest state.
        let text = format!(
            "[system]\nn_atoms = {ATOMS}\ndensity = {DENSITY:?}\ntemperature = {temperature:?}\nseed = 1967\n\
             [integrator]\ndt = 0.002\n\
             [[stage]]\nname = \"equilibrate\"\nsteps = {steps}\nthermostat = {{ kind = \"rescale\", every = 20 }}\n\
             [[stage]]\nname = \"production\"\nsteps = 1\n"
        );
        let mut scene = Scene::parse(&text, "the fluid of the study", &[]).map_err(|e| {
            StudyError::Settings { label: "the fluid of the study".into(), reason: e.to_string() }
        })?;
        scene.truncation = TruncationOptions::new(TRUNCATIONS[truncation].0, R_CUT);
        let start = Start::equilibrate(&scene)?;
        Ok(Self { state_point, truncation, scene, start })
    }

    /// A method from this start on, with the forces that it needs.
    pub(crate) fn rig(
        &self,
        method: &IntegratorOptions,
        dt: f64,
        precision: Precision,
        want: Want,
    ) -> Result<Rig, StudyError> {
        let mut scene = self.scene.clone();
        scene.integrator.method = method.clone();
        scene.integrator.dt = dt;
        scene.integrator.split = matches!(method, IntegratorOptions::Respa(_)).then_some(SPLIT);
        scene.kernel.precision = precision;
        let forces = Box::new(self.start.forces(&scene)?);
        let at = (self.start.system(), self.start.state());
        Rig::start(lennard_integrators::build(method), at, forces, dt, want)
    }
}
