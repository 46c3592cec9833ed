//! Whether the last state of a run is a crystal, which no equation of a fluid describes.

use lennard_core::Remark;
use lennard_observables::{solid_share, solid_share_bytes};

use crate::Simulation;

/// Above this share of solid-like particles a state is no liquid: dense liquids have some hundredths.
const FROZEN: f64 = 0.3;
/// Fewer particles say nothing.
const FEWEST_PARTICLES: usize = 100;

/// Whether a run of this simulation looks at its last state.
fn looks(simulation: &Simulation) -> bool {
    simulation.system.molecules.are_atoms() && simulation.state.len() >= FEWEST_PARTICLES
}

/// Bytes that the look takes.
pub(crate) fn bytes(simulation: &Simulation) -> usize {
    if looks(simulation) { solid_share_bytes(simulation.state.len()) } else { 0 }
}

/// The remark that belongs beside the means of a run whose last state is a crystal, or has one in it.
pub(crate) fn frozen(simulation: &Simulation) -> Option<Remark> {
    if !looks(simulation) {
        return None;
    }
    let state = &simulation.state;
    let share = solid_share(&state.cell, &state.positions);
    (share > FROZEN).then_some(Remark::Frozen { solid_share: share })
}
