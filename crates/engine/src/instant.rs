//! The state of a simulation as observers see it, and its values of the moment.

use lennard_core::{Momentum, Shared, State, System, TailCorrection, View, WallReading};
use lennard_forcefield::Tail;

use crate::Simulation;
use crate::simulation::StageRun;

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

/// A tail per particle as observers see it: per molecule of so many sites.
fn correction(tail: Option<Tail>, sites: usize) -> Option<TailCorrection> {
    tail.map(|t| TailCorrection {
        energy_per_particle: t.energy_per_particle * sites as f64,
        pressure: t.pressure,
    })
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
        let tail = self.tail_in(self.state.cell.volume());
        correction(tail, self.system.molecules.sites())
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
}
