//! One sample of the thermodynamic series.

use lennard_core::{DVec3, TailCorrection, View};

use super::Thermodynamics;
use super::cutoffs::EndSums;

/// The values of one moment; energies, virial and volume are per molecule.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instant {
    pub time: f64,
    pub temperature: f64,
    pub temperature_of_positions: f64,
    pub kinetic_energy: f64,
    /// U without its tail.
    pub potential_energy: f64,
    /// P without its tail.
    pub pressure: f64,
    pub tail: TailCorrection,
    pub conserved_energy: f64,
    pub squared_force: f64,
    pub laplacian: f64,
    /// What the cutoff adds to Σ r²u″.
    pub curvature_of_ends: f64,
    /// The potential energy that configurations are sampled with.
    pub sampled_energy: f64,
    pub momentum: DVec3,
    /// W without its tail.
    pub virial: f64,
    pub volume: f64,
}

impl Instant {
    /// The row of the series, in the order of [`crate::ThermoSeries`].
    pub fn row(&self) -> [f64; 28] {
        let Self { kinetic_energy: kinetic, sampled_energy: sampled, virial, volume, .. } = *self;
        [
            self.time,
            self.temperature,
            self.temperature_of_positions,
            kinetic,
            self.potential_energy + self.tail.energy_per_particle,
            self.potential_energy,
            self.pressure + self.tail.pressure,
            self.pressure,
            self.conserved_energy,
            self.squared_force,
            self.laplacian,
            kinetic * kinetic,
            sampled,
            sampled * sampled,
            self.momentum.x,
            self.momentum.y,
            self.momentum.z,
            virial,
            virial * virial,
            sampled * virial,
            sampled * kinetic,
            kinetic.recip(),
            virial / kinetic,
            virial * virial / kinetic,
            volume,
            volume * volume,
            sampled * volume,
            self.curvature_of_ends,
        ]
    }
}

impl Thermodynamics {
    /// What the cutoff adds to sums over pairs; nothing where no number needs it.
    fn sums_of_ends(&self, view: &View<'_>) -> EndSums {
        let is_asked = self.options.configurational_temperature || self.curvature.is_some();
        if self.ends.are_none() || !is_asked {
            return EndSums::default();
        }
        let c = &self.context;
        let at = (self.energy_line.len(), c.every);
        self.ends.sums(view, &c.species, &c.molecules, at)
    }

    /// The values of a state.
    ///
    /// # Panics
    /// Where the state lacks what the observable asks for: that is a bug of the caller.
    pub(super) fn instant(&self, view: &View<'_>) -> Instant {
        let state = view.state;
        let energetics = &state.energetics;
        let asked = "the force evaluation gives what the observable wants";
        let n = view.system.n_molecules() as f64;
        let volume = view.cell().volume();
        let kinetic = view.system.kinetic_energy(&state.velocities) / n;
        let potential = energetics.potential_energy.expect(asked) / n;
        let conserved =
            energetics.conserved_potential.or(energetics.potential_energy).expect(asked);
        let virial = energetics.scalar_virial().expect(asked) - view.intramolecular_virial();
        let of_positions = view.temperature_of_positions();
        let ends = self.sums_of_ends(view);
        let (squared_force, laplacian) = if self.options.configurational_temperature {
            let squares: f64 = view.sum(|i| state.forces[i].length_squared());
            let laplacian = energetics.laplacian.expect(asked);
            (squares / n, (laplacian - 2.0 * ends.jump) / n)
        } else {
            (0.0, 0.0)
        };
        Instant {
            time: state.time,
            temperature: 2.0 * kinetic * n / view.n_dof(),
            temperature_of_positions: of_positions,
            kinetic_energy: kinetic,
            potential_energy: potential,
            pressure: n / volume * of_positions + virial / (3.0 * volume),
            tail: view.tail.unwrap_or_default(),
            conserved_energy: kinetic + (conserved + view.tail_work - view.heat) / n,
            squared_force,
            laplacian,
            curvature_of_ends: self.curvature.map_or(0.0, |c| c.of_ends(&ends)) / n,
            // In a box that changes, configurations are weighted with the energy of the tail too.
            sampled_energy: (conserved + view.tail_work) / n,
            momentum: view.system.momentum(&state.velocities) / n,
            virial: virial / n,
            volume: volume / n,
        }
    }
}
