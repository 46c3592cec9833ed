//! Springs that are too stiff for the step of a stage.

use crate::Scene;

/// A stage whose step does not bear a spring.
pub(crate) struct TooStiff {
    /// Index of the stage.
    pub stage: usize,
    /// Its step, τ.
    pub dt: f64,
    /// The limit of ω·h under its method.
    pub limit: f64,
}

impl Scene {
    /// The first stage whose step does not bear a vibration of ω per τ: ω·h must stay below the limit of the method.
    pub(crate) fn too_stiff(&self, omega: f64) -> Option<TooStiff> {
        self.stages.iter().enumerate().find_map(|(i, stage)| {
            // A bath that stands inside the step takes the place of the integrator.
            let limit = self.method_of(stage).spec().stability_limit?;
            let dt = self.stage_dt(stage);
            (omega * dt >= limit).then_some(TooStiff { stage: i, dt, limit })
        })
    }
}
