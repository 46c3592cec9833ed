//! The state of a simulation as observers see it, and its values of the moment.

use lennard_core::{
    Configuration, DVec3, Energetics, ForceTerm, Momentum, Part, Shared, State, System,
    TailCorrection, View, WallReading, Want,
};
use lennard_forcefield::NeighborOptions;
use lennard_scene::Scene;

use crate::confinement::Confinement;
use crate::simulation::{Simulation, StageRun};
use crate::{EngineError, build};

/// What observers see, made from the parts so that the observers beside them may be changed meanwhile.
pub(crate) fn view<'a>(
    state: &'a State,
    system: &'a System,
    tail: Option<TailCorrection>,
    stage: Option<&StageRun>,
    walls: &'a [WallReading],
) -> View<'a> {
    View {
        state,
        system,
        momentum: stage.map_or(Momentum::Conserved, |s| s.integrator.momentum()),
        tail,
        heat: stage.map_or(0.0, |s| s.heat),
        tail_work: tail_work(state, stage),
        half_kick_step: stage.filter(|s| s.integrator.spec().half_kicks).map(|s| s.dt),
        walls,
        shared: Shared::default(),
    }
}

/// V·P_tail in ε of a stage whose box changes, else 0.
fn tail_work(state: &State, stage: Option<&StageRun>) -> f64 {
    match stage {
        Some(stage) if stage.tail_work != 0.0 => stage.tail_work / state.cell.volume(),
        _ => 0.0,
    }
}

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
    /// (K + U_conserved + V·P_tail − Σ heat)/N in ε, where the energy was asked for on this step.
    ///
    /// The tail is there with a barostat alone, and N is the number of molecules where there are some.
    #[must_use]
    pub fn conserved_energy_per_particle(&self) -> Option<f64> {
        let potential = self.state.energetics.conserved_potential?;
        let stage = self.stage.as_ref();
        let heat = stage.map_or(0.0, |s| s.heat) - tail_work(&self.state, stage);
        Some(
            (self.system.kinetic_energy(&self.state.velocities) + potential - heat)
                / self.system.n_molecules() as f64,
        )
    }

    /// Potential energy per particle (or molecule) in ε, with the tail where the scene has one, if asked for on this step.
    #[must_use]
    pub fn potential_energy_per_particle(&self) -> Option<f64> {
        let tail = self.tail().map_or(0.0, |t| t.energy_per_particle);
        Some(self.state.energetics.potential_energy? / self.system.n_molecules() as f64 + tail)
    }

    /// The tail correction at the present volume, if the scene has one.
    #[must_use]
    pub fn tail(&self) -> Option<TailCorrection> {
        let tail = self.tail_in(self.state.cell.volume())?;
        Some(TailCorrection {
            energy_per_particle: tail.energy_per_particle * self.system.molecules.sites() as f64,
            pressure: tail.pressure,
        })
    }

    /// What observers see of the state as it is.
    #[must_use]
    pub fn view(&self) -> View<'_> {
        let walls = self.forces.walls();
        let (tail, stage) = (self.tail(), self.stage.as_ref());
        view(&self.state, &self.system, tail, stage, walls)
    }

    /// Pressure P = ρT + W/(3V) + tail in ε/σ³, if the virial was asked for on this step. T is the temperature of
    /// half steps where the method has them ([`View::temperature_of_positions`]).
    #[must_use]
    pub fn pressure(&self) -> Option<f64> {
        let volume = self.state.cell.volume();
        let density = self.system.n_molecules() as f64 / volume;
        let view = self.view();
        let virial = self.state.energetics.scalar_virial()? - view.intramolecular_virial();
        let tail = self.tail().map_or(0.0, |t| t.pressure);
        Some(density * view.temperature_of_positions() + virial / (3.0 * volume) + tail)
    }

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

    /// What a force term gets of the state.
    pub(crate) fn configuration(&self) -> Configuration<'_> {
        let state = &self.state;
        Configuration {
            velocities: Some(&state.velocities),
            time: state.time,
            ..Configuration::at_rest(&state.cell, &state.positions)
        }
    }

    fn evaluated(&self) -> Result<(Vec<DVec3>, Energetics), EngineError> {
        let state = &self.state;
        let (scene, n) = (&self.scene, state.len());
        // A skin of the scene may no longer fit a box that has changed.
        let apart =
            Scene { neighbor: NeighborOptions { skin: None, ..scene.neighbor }, ..scene.clone() };
        let (_, provider) = build::forces(&apart, state.cell, self.system.species())?;
        let species = self.system.species().clone();
        let (_, confinement) = Confinement::with_system(scene, &self.start_cell, species);
        let mut terms = build::with_others(scene, confinement.beside(provider), &self.own);
        let mut forces = vec![DVec3::ZERO; n];
        let energetics = evaluate(scene, &mut terms, self.configuration(), &mut forces)?;
        Ok((forces, energetics))
    }
}

/// Forces with energy and virial of a configuration that a scene makes.
pub(crate) fn evaluate(
    scene: &Scene,
    terms: &mut dyn ForceTerm,
    at: Configuration<'_>,
    forces: &mut [DVec3],
) -> Result<Energetics, EngineError> {
    terms
        .evaluate(at, Part::All, Want::ENERGY_AND_VIRIAL, forces)
        .map_err(|e| scene.invalid("system", e, "a start configuration with finite forces").into())
}
