//! Where the watchdog looks during a run, and what its findings become.

use lennard_core::{ForceError, IntegratorSpec, StepError};

use crate::close_pairs::closest_pair;
use crate::failure::{LARGEST_MOVE, PhysicsFailure, Symptom};
use crate::watchdog::{self, Seen};
use crate::{EngineError, Simulation};

impl Simulation {
    /// Looks for signs of a run gone wrong.
    pub(crate) fn watch(&mut self) -> Result<(), EngineError> {
        let stage = self.stage_run();
        let (step, dt) = (self.state.step, stage.dt);
        let at_end = stage.steps_done == self.current_stage().steps;
        if let Some(energy) = self.conserved_energy_per_particle() {
            // Energies are per molecule, and the limit is for each of its sites.
            let sites = self.system.molecules.sites() as f64;
            watchdog::check_energy(stage.start_energy / sites, energy / sites)
                .map_err(|s| self.diagnosed(s))?;
        } else if !step.is_multiple_of(watchdog::EVERY) && !at_end {
            return Ok(());
        }
        if step.is_multiple_of(watchdog::LISTS_EVERY) || at_end {
            let seen = self.watch_closely()?;
            self.force_check.count(seen);
            return Ok(());
        }
        watchdog::check_speeds(self.system.own(), &self.state, dt, self.largest_move())
            .map_err(|s| self.diagnosed(s))
    }

    /// Checks speeds, and forces of a few particles, whatever the step. It counts nothing, since the counts of a run must
    /// not depend on its checkpoints.
    pub(crate) fn watch_closely(&self) -> Result<Seen, EngineError> {
        let dt = self.stage_run().dt;
        watchdog::check_speeds(self.system.own(), &self.state, dt, self.largest_move())
            .map_err(|s| self.diagnosed(s))?;
        let at = self.configuration();
        let other = |particle| self.forces.force_on(particle, at);
        let seen = self.force_check.look(&self.system, &self.state, other);
        seen.map_err(|s| self.diagnosed(s))
    }

    /// The longest legal move of a particle in one step, σ: soft bodies must not pass through each other between two looks.
    fn largest_move(&self) -> f64 {
        if self.scene.contact.is_none() {
            return LARGEST_MOVE;
        }
        let pairs = self.scene.species_pairs();
        let distances = pairs.map(|[a, b]| self.scene.contact_distance(a, b));
        distances.fold(LARGEST_MOVE, |least, distance| least.min(0.25 * distance))
    }

    pub(crate) fn failed(&self, error: StepError) -> EngineError {
        match error {
            StepError::Force(e) => self.diagnosed(Symptom::NonFinite(e)),
            StepError::NotConverged { .. }
            | StepError::BondTurned { .. }
            | StepError::BondsNotConverged { .. }
            | StepError::ContactsNotConverged { .. } => self.diagnosed(Symptom::Method(error)),
            // Everything else is a combination that the scene should not ask for.
            other => self
                .scene
                .invalid("integrator.kind", other, "a method that suits the forces")
                .into(),
        }
    }

    /// The estimate of [`watchdog::rough_stable_dt`], τ, for the pair of species with the shortest step; `None` where a method
    /// has no such limit, and without pair forces.
    pub(crate) fn rough_stable_dt(&self, method: &IntegratorSpec, temperature: f64) -> Option<f64> {
        let acts = self.scene.longest_cutoff() > 0.0;
        let limit = method.stability_limit.filter(|_| acts)?;
        let species = self.system.species();
        let fastest = watchdog::fastest_pair(&self.scene, species, temperature, limit);
        Some(fastest.map_or(f64::INFINITY, |pair| pair.stable_dt))
    }

    /// Puts together what is known of a failure.
    fn diagnosed(&self, symptom: Symptom) -> EngineError {
        let (plan, stage, state) = (self.current_stage(), self.stage_run(), &self.state);
        let spec = stage.integrator.spec();
        let beyond = match symptom {
            Symptom::NonFinite(ForceError::BeyondWall { particle, .. }) => Some(particle),
            _ => None,
        };
        let (own, species) = (self.system.own(), self.system.species());
        EngineError::Physics(Box::new(PhysicsFailure {
            step: state.step,
            time: state.time,
            stage: plan.name.to_string(),
            method: spec.name,
            dt: stage.dt,
            dt_limit: self.rough_stable_dt(spec, plan.temperature),
            symptom,
            // Several ranks would have to tell each other all positions.
            closest: own.team().map_or_else(
                || closest_pair(&self.scene, species, &state.cell, &state.positions, 0.9),
                |_| None,
            ),
            non_finite: own.count(state.positions.iter().filter(|r| !r.is_finite()).count()),
            fastest: watchdog::fastest(own, state),
            speed_beyond: beyond
                .map(|number| own.vector(own.index(number).map(|i| state.velocities[i])).length()),
            steps_into_stage: stage.steps_done,
            temperature: plan.temperature,
            density: self.system.len() as f64 / state.cell.volume(),
            kept: Vec::new(),
        }))
    }
}
