//! Runs with everything off: what benchmarks, studies and plans time.

use lennard_core::Want;
use lennard_scene::{Scene, Stage};

use crate::EngineError;
use crate::simulation::{Follower, Simulation, Verdict};

/// Steps of a stage that ends when its follower says so; as an interval, one that no run reaches.
pub const ENDLESS: u64 = 1_000_000_000_000_000;

/// The stage that a scene measures: the last measured one, or the last of all.
///
/// # Panics
/// Where the scene has no stage, which no reader lets pass.
#[must_use]
pub fn measured_stage(scene: &Scene) -> &Stage {
    let measured = scene.stages.iter().rev().find(|s| s.measure);
    measured
        .or(scene.stages.last())
        .expect("a scene has a stage: its reader refuses one without")
}

/// The scene with its measured stage alone: without end, at constant energy, with nothing to observe or write.
#[must_use]
pub fn bare(scene: &Scene) -> Scene {
    let mut bare = scene.clone();
    bare.stages = vec![Stage {
        steps: ENDLESS,
        thermostat: None,
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
    simulation.run(&mut Until { end, want }).map(drop)
}

/// Stops at a step.
struct Until {
    end: u64,
    want: Want,
}

impl Follower for Until {
    fn want(&self, _scene: &Scene, _step: u64, _measured: bool) -> Want {
        self.want
    }

    fn looks_at(&self, _scene: &Scene, step: u64, _measured: bool) -> bool {
        step == self.end || !self.want.is_nothing()
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<Verdict, EngineError> {
        Ok(if simulation.state.step == self.end {
            Verdict::Stop
        } else {
            Verdict::Continue
        })
    }
}
