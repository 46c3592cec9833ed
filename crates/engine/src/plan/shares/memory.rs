//! Memory that is not there after a few steps with everything off.

use lennard_core::{Persist, StateArchive};
use lennard_scene::{Scene, Stage};

use crate::simulation::Simulation;

/// Bytes per particle that fused steps keep under a bath beside what they keep without one: positions, while forces wait.
const UNDER_A_BATH: u64 = 24;
/// A stage of so few steps takes none of them at once.
const FEW_STEPS: u64 = 3;

/// Bytes per particle that the fused steps of a scene keep under its baths beside what they keep without one.
pub(super) fn bytes_under_a_bath(scene: &Scene) -> u64 {
    let fuses = |stage: &Stage| stage.thermostat.is_some() && stage.steps > FEW_STEPS;
    if scene.stages.iter().any(fuses) { UNDER_A_BATH } else { 0 }
}

/// Bytes of what a checkpoint is put together in.
pub(super) fn checkpoint_bytes(bare: &Simulation) -> usize {
    let mut archive = StateArchive::default();
    Persist::save(bare, &mut archive.writer());
    archive.bytes()
}
