//! Steps that are taken at once with the step under way, and the bath and the noise that belong to each of them.

use super::{Step, tick};
use crate::{FrictionAndNoise, FusedBath, FusedSteps, Moving, Thermostat, Want, rigid};

impl<'a> Step<'a> {
    /// With so many further steps that may be taken with it, where the method is kick-drift-kick.
    pub(crate) fn with_steps_ahead(self, ahead: u64) -> Self {
        Self { ahead, ..self }
    }

    /// With a bath after the step, and after the further steps.
    pub(crate) fn with_bath(self, bath: Option<&'a mut Box<dyn Thermostat>>) -> Self {
        Self { bath, ..self }
    }

    /// The bath, which acts once at the end of the step.
    pub(crate) fn take_bath(&mut self) -> Option<&'a mut Box<dyn Thermostat>> {
        self.bath.take()
    }

    /// Friction and noise O of the whole step: counts the kinetic energy gained as heat. They stand between two half drifts,
    /// once in a step.
    pub fn friction_and_noise(&mut self, noise: &FrictionAndNoise) {
        // The heat is then what friction and noise put in, without the part that rigid bonds take off before them.
        self.project_velocities();
        self.noise = Some(*noise);
        let (state, system) = (&mut *self.state, self.system);
        let of_step = noise.in_step(state.step, self.dt);
        let mut heat = Moving::of(state).noise(&of_step, &system.masses);
        if system.molecules.are_rigid() {
            let before = system.kinetic_energy(&state.velocities);
            rigid::project_velocities(system, &state.positions, &mut state.velocities);
            heat += system.kinetic_energy(&state.velocities) - before;
        }
        self.add_heat(heat);
    }

    pub(super) fn fused_steps(&mut self) {
        let (n_dof, dt) = (self.n_dof(), self.dt);
        let state = &mut *self.state;
        let before = self.bath.as_ref().map(|bath| bath.copy());
        let is_noise = self.noise.is_some();
        let bath = match (self.noise, self.bath.as_deref_mut()) {
            (Some(noise), _) => Some(FusedBath::noise(noise, dt, state.step)),
            (None, bath) => {
                bath.map(|bath| FusedBath::scaling(bath.as_mut(), n_dof, dt, state.step))
            }
        };
        let mut steps = FusedSteps {
            cell: &state.cell,
            positions: &mut state.positions,
            velocities: &mut state.velocities,
            forces: &mut state.forces,
            masses: &self.system.masses,
            dt,
            steps: self.ahead,
            bath,
        };
        let taken = self.backend.advance(&mut steps);
        let bath = steps.bath;
        if taken > 0 {
            let mut heats = bath.map(FusedBath::into_heats).unwrap_or_default();
            if is_noise {
                // The noise of this step came first, and the last noise belongs to the step that ends next.
                heats.insert(0, self.report.heat);
                self.report.heat = heats.pop().unwrap_or_default();
            }
            self.report.earlier_heats = heats;
        } else if let (Some(bath), Some(before)) = (&mut self.bath, before) {
            **bath = before;
        }
        for _ in 0..taken {
            tick(state, self.dt);
        }
        self.report.force_evaluations += taken as u32;
        if taken < self.ahead {
            self.want = Want::NOTHING;
        }
        self.ahead = 0;
    }
}
