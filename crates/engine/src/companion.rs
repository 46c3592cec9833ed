//! A rank beside rank 0, which writes.

use std::sync::atomic::AtomicBool;

use crate::course::{Course, Writer};
use crate::follower::{Control, Ending};
use crate::{EngineError, Simulation};

/// Runs a shared simulation beside rank 0, which writes its files; `stop` is set from outside to stop all ranks.
///
/// # Errors
/// [`EngineError`] where physics stops the run, as on all ranks.
///
/// # Panics
/// Where the simulation is not shared: that is a bug of the caller.
pub fn run_beside(simulation: &mut Simulation, stop: &AtomicBool) -> Result<Ending, EngineError> {
    assert!(simulation.team.is_some(), "the simulation is shared");
    let control = Control { stop, deadline: None, progress: &mut () };
    let end = simulation.scene.total_steps();
    let mut course = Course::new(simulation, control, end, Companion::default());
    simulation.follow(&mut course)?;
    course.writer.checkpoint(simulation)?;
    Ok(course.ending)
}

/// Follows the run as the recorder of rank 0 does, and writes nothing.
#[derive(Default)]
struct Companion {
    last_checkpoint: Option<u64>,
}

impl Writer for Companion {
    fn write(&mut self, _: &mut Simulation, _: bool, _: bool) -> Result<(), EngineError> {
        Ok(())
    }

    /// Looks at what rank 0 looks at before it writes a checkpoint: a failure is met by all ranks.
    fn checkpoint(&mut self, simulation: &mut Simulation) -> Result<(), EngineError> {
        if self.last_checkpoint != Some(simulation.state.step) {
            simulation.watch_closely()?;
            self.last_checkpoint = Some(simulation.state.step);
        }
        Ok(())
    }
}
