//! Runs with everything off: what benchmarks, studies and plans time.

use lennard_core::Want;
use lennard_scene::{Scene, Stage};

use crate::EngineError;
use crate::follower::StopAt;
use crate::schedule::{Action, Operation, Trigger};
use crate::simulation::Simulation;

/// Steps of a stage that ends when its follower says so; as an interval, one that no run reaches.
pub const ENDLESS: u64 = 1_000_000_000_000_000;

/// The stage that a scene measures: the last measured one, or the last of all.
///
/// # Panics
/// Where the scene has no stage, which no reader lets pass.
#[must_use]
pub fn measured_stage(scene: &Scene) -> &Stage {
    let measured = scene.stages.iter().rev().find(|s| s.measure);
    measured.or(scene.stages.last()).expect("a scene has a stage: its reader refuses one without")
}

/// The scene with its measured stage alone: without end, at constant energy, with nothing to observe or write.
#[must_use]
pub fn bare(scene: &Scene) -> Scene {
    let mut bare = scene.clone();
    bare.stages = vec![Stage {
        steps: ENDLESS,
        thermostat: None,
        barostat: None,
        measure: false,
        ..measured_stage(scene).clone()
    }];
    bare.observables.clear();
    bare.output.trajectory_every = None;
    bare
}

/// Takes `steps` steps and asks the forces of each for `want`; where that is nothing, several are taken in one go.
///
/// # Errors
/// [`EngineError`] where the run fails.
pub fn take(simulation: &mut Simulation, steps: u64, want: Want) -> Result<(), EngineError> {
    let end = simulation.state.step + steps;
    let wanted =
        (!want.is_nothing()).then(|| Operation::new(Action::Call, Trigger::Always).wanting(want));
    let schedule = wanted.into_iter().collect();
    simulation.follow(&mut StopAt::following(schedule, end)).map(drop)
}
