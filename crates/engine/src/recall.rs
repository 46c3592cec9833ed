//! The forces that a state already has, for starting a method anew without evaluating them again.

use lennard_core::{
    Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceProvider, Part, Persist,
    RestoreError, State, StateReader, StateWriter, Want,
};

/// Gives back the forces and energetics of a state: right as long as nothing but velocities has changed.
pub struct Recall {
    forces: Vec<DVec3>,
    energetics: Energetics,
    properties: ForceProperties,
}

impl Recall {
    /// The forces of `state`, which come from a provider with these properties.
    pub fn new(state: &State, properties: ForceProperties) -> Self {
        Self {
            forces: state.forces.clone(),
            energetics: state.energetics.clone(),
            properties,
        }
    }
}

impl ForceProvider for Recall {
    fn evaluate(
        &mut self,
        _at: Configuration<'_>,
        part: Part,
        _want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        if part != Part::All {
            return Err(ForceError::NotSplit);
        }
        forces.copy_from_slice(&self.forces);
        Ok(self.energetics.clone())
    }

    fn properties(&self) -> ForceProperties {
        self.properties
    }
}

impl Persist for Recall {
    fn save(&self, _to: &mut StateWriter<'_>) {}

    fn restore(&mut self, _from: &StateReader<'_>) -> Result<(), RestoreError> {
        Ok(())
    }
}
