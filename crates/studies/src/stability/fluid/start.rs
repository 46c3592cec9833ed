//! The fluid of the study: state points, truncations, and equilibrated starts.

use glam::DVec3;
use lennard_core::random::Streams;
use lennard_core::{Momentum, PeriodicBox, State, System, Want};
use lennard_forcefield::{
    Conditions, ForceFieldOptions, KernelOptions, Precision, SplitOptions, TruncationKind,
    TruncationOptions, build,
};
use lennard_integrators::IntegratorOptions;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use crate::StudyError;
use crate::lab::Rig;

/// Density of all state points, σ⁻³: the density of the liquid near its triple point.
pub const DENSITY: f64 = 0.8442;
/// Cutoff, σ.
pub const R_CUT: f64 = 2.5;
/// fcc cells along each side; four atoms each.
const CELLS: usize = 4;
/// Atoms.
pub const ATOMS: usize = 4 * CELLS * CELLS * CELLS;
/// Seed of the velocities at the start.
const SEED: u64 = 1967;
/// Steps of the equilibration.
const EQUILIBRATION_STEPS: u64 = 4000;
/// Step of the equilibration, τ: small enough for the hottest state.
const EQUILIBRATION_DT: f64 = 0.002;
/// Steps between two scalings of the velocities to the temperature.
const RESCALE_EVERY: u64 = 20;
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
pub(crate) struct Start {
    pub(crate) state_point: usize,
    pub(crate) truncation: usize,
    cell: PeriodicBox,
    positions: Vec<DVec3>,
    velocities: Vec<DVec3>,
}

impl Start {
    /// Melts an fcc lattice and brings it to the temperature.
    pub(crate) fn equilibrate(
        state_point: usize,
        truncation: usize,
        quick: bool,
    ) -> Result<Self, StudyError> {
        let temperature = STATES[state_point].temperature;
        let side = (ATOMS as f64 / DENSITY).cbrt();
        let cell = PeriodicBox::new(DVec3::splat(side))?;
        let mut start = Self {
            state_point,
            truncation,
            cell,
            positions: lattice(side),
            velocities: velocities(temperature),
        };
        let method = IntegratorOptions::default();
        let mut rig = start.rig(&method, EQUILIBRATION_DT, Precision::Double, Want::NOTHING)?;
        let steps = if quick { EQUILIBRATION_STEPS / 8 } else { EQUILIBRATION_STEPS };
        for _ in 0..steps / RESCALE_EVERY {
            rig.steps(RESCALE_EVERY)?;
            let now = rig.system.temperature(&rig.state.velocities, Momentum::Conserved);
            let factor = (temperature / now).sqrt();
            for v in &mut rig.state.velocities {
                *v *= factor;
            }
        }
        start.positions = rig.state.positions;
        start.velocities = rig.state.velocities;
        Ok(start)
    }

    /// A method from this start on, with the forces that it needs.
    pub(crate) fn rig(
        &self,
        method: &IntegratorOptions,
        dt: f64,
        precision: Precision,
        want: Want,
    ) -> Result<Rig, StudyError> {
        let options = ForceFieldOptions {
            truncation: TruncationOptions::new(TRUNCATIONS[self.truncation].0, R_CUT),
            kernel: KernelOptions { precision, ..KernelOptions::default() },
            split: matches!(method, IntegratorOptions::Respa(_)).then_some(SPLIT),
            ..ForceFieldOptions::default()
        };
        let conditions = Conditions {
            cell: self.cell,
            n_atoms: self.positions.len(),
            temperature: STATES[self.state_point].temperature,
            dt,
            mixture: None,
        };
        let state = State::new(self.cell, self.positions.clone(), self.velocities.clone());
        let at = (System::atoms(self.positions.len()), state);
        let forces = Box::new(build(&options, &conditions)?);
        Rig::start(lennard_integrators::build(method), at, forces, dt, want)
    }
}

/// An fcc lattice that fills the box.
fn lattice(side: f64) -> Vec<DVec3> {
    let a = side / CELLS as f64;
    let basis = [
        DVec3::new(0.25, 0.25, 0.25),
        DVec3::new(0.75, 0.75, 0.25),
        DVec3::new(0.75, 0.25, 0.75),
        DVec3::new(0.25, 0.75, 0.75),
    ];
    (0..CELLS.pow(3))
        .flat_map(|c| {
            let corner = [c % CELLS, c / CELLS % CELLS, c / CELLS.pow(2)].map(|i| i as f64);
            basis.map(|b| a * (DVec3::from_array(corner) + b))
        })
        .collect()
}

/// Normal velocities without total momentum, scaled to the temperature.
fn velocities(temperature: f64) -> Vec<DVec3> {
    let mut random = Streams::new(SEED).sequential("stability-velocities");
    let mut velocities: Vec<DVec3> = (0..ATOMS)
        .map(|_| DVec3::from_array(std::array::from_fn(|_| StandardNormal.sample(&mut random))))
        .collect();
    let mean = velocities.iter().sum::<DVec3>() / ATOMS as f64;
    for v in &mut velocities {
        *v -= mean;
    }
    let factor =
        (temperature / System::atoms(ATOMS).temperature(&velocities, Momentum::Conserved)).sqrt();
    velocities.into_iter().map(|v| v * factor).collect()
}
