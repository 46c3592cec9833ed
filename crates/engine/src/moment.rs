//! The values of a moment, whatever was asked of the forces on the last step.

use lennard_core::{Configuration, DVec3, Energetics, ForceTerm, Part, Want};
use lennard_forcefield::NeighborOptions;
use lennard_scene::Scene;

use crate::confinement::Confinement;
use crate::simulation::Simulation;
use crate::{EngineError, build};

/// The values of a moment, in reduced units; energies are for each particle, or for each molecule. What is not known at its step
/// is not a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Kinetic temperature 2K/n_dof of whole steps, ε/k_B.
    pub temperature: f64,
    /// K/N, ε.
    pub kinetic_energy: f64,
    /// U/N with the tail where the scene has one, ε.
    pub potential_energy: f64,
    /// P, ε/σ³.
    pub pressure: f64,
}

impl Moment {
    pub(crate) fn of(simulation: &Simulation) -> Self {
        let view = simulation.view();
        Self {
            temperature: view.temperature(),
            kinetic_energy: view.kinetic_energy() / simulation.system.n_molecules() as f64,
            potential_energy: simulation.potential_energy_per_particle().unwrap_or(f64::NAN),
            pressure: simulation.pressure().unwrap_or(f64::NAN),
        }
    }
}

impl Simulation {
    /// The values of the state as it is. What is missing is evaluated with a list made for it, so that what
    /// the run computes next keeps its bits.
    ///
    /// # Errors
    /// [`EngineError`] where a force is not finite.
    pub fn moment(&mut self) -> Result<Moment, EngineError> {
        let found = &self.state.energetics;
        let is_complete = found.potential_energy.is_some() && found.scalar_virial().is_some();
        if is_complete && self.stage.is_some() {
            return Ok(Moment::of(self));
        }
        let (forces, energetics) = self.on_its_threads(|simulation| simulation.evaluated())??;
        let forces = std::mem::replace(&mut self.state.forces, forces);
        let energetics = std::mem::replace(&mut self.state.energetics, energetics);
        let moment = Moment::of(self);
        self.state.forces = forces;
        self.state.energetics = energetics;
        Ok(moment)
    }

    /// The forces at the positions as they are, `[N]`, ε/σ.
    ///
    /// # Errors
    /// [`EngineError`] where a force is not finite.
    pub fn present_forces(&self) -> Result<Vec<DVec3>, EngineError> {
        match &self.stage {
            Some(_) => Ok(self.state.forces.clone()),
            // No method has asked for forces yet.
            None => Ok(self.evaluated()?.0),
        }
    }

    fn evaluated(&self) -> Result<(Vec<DVec3>, Energetics), EngineError> {
        let state = &self.state;
        let (scene, n) = (&self.scene, state.len());
        // A skin of the scene may no longer fit a box that has changed.
        let apart =
            Scene { neighbor: NeighborOptions { skin: None, ..scene.neighbor }, ..scene.clone() };
        let (_, provider) = build::forces(&apart, state.cell, self.system.species())?;
        let (_, confinement) = {
            let species = self.system.species().clone();
            Confinement::with_system(scene, &self.start_cell, species)
        };
        let mut terms = build::with_others(scene, confinement.beside(provider), &self.own);
        let mut forces = vec![DVec3::ZERO; n];
        let at = Configuration {
            velocities: Some(&state.velocities),
            time: state.time,
            ..Configuration::at_rest(&state.cell, &state.positions)
        };
        let evaluated = terms.evaluate(at, Part::All, Want::ENERGY_AND_VIRIAL, &mut forces);
        let refused = |e| {
            let allowed = "a start configuration with finite forces";
            scene.source.invalid("system", e, allowed)
        };
        let energetics = evaluated.map_err(refused)?;
        Ok((forces, energetics))
    }
}
