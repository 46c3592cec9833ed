//! What the study of mechanics measured.

use serde::Serialize;

use super::{collisions, comparison, fluid, maps, precise, pressure, relaxing};
use crate::StudyOptions;
use crate::claims::Claim;

/// Everything that was measured.
#[derive(Debug, Clone, Serialize)]
pub struct MechanicsMeasurements {
    /// Whether runs were short.
    pub is_quick: bool,
    /// Bonds held in each way.
    pub ways: Vec<comparison::WayResults>,
    /// Stiffness of springs, and the distance of their dumbbells from rigid ones at the end, σ.
    pub model_errors: Vec<(f64, f64)>,
    /// Relaxation.
    pub relaxing: relaxing::Relaxing,
    /// Problems with known solutions.
    pub solved: Vec<precise::Solved>,
    /// SPOOK.
    pub maps: maps::Maps,
    /// Collisions.
    pub collisions: collisions::Collisions,
    /// Drifts of fluids.
    pub drifts: Vec<fluid::FluidDrift>,
    /// Fluids beside equations of state.
    pub states: Vec<fluid::StateResults>,
    /// Pressures between walls.
    pub pressure: pressure::WallPressure,
}

/// The study: what was found, and what follows.
#[derive(Debug, Clone, Serialize)]
pub struct MechanicsStudy {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// What was asked for.
    pub options: StudyOptions,
    /// The measurements.
    pub found: MechanicsMeasurements,
    /// What is claimed, by whom, and whether it holds.
    pub claims: Vec<Claim>,
}
