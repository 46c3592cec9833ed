//! One sample of the thermodynamic series.

use lennard_core::{DVec3, View};

use super::Thermodynamics;
use super::cutoffs::EndSums;
use crate::thermo_series::ThermoRow;

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

    /// The values of a state, with its momentum per molecule.
    ///
    /// # Panics
    /// Where the state lacks what the observable asks for: that is a bug of the caller.
    pub(super) fn row(&self, view: &View<'_>, momentum: DVec3) -> ThermoRow {
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
        let pressure = n / volume * of_positions + virial / (3.0 * volume);
        let tail = view.tail.unwrap_or_default();
        // In a box that changes, configurations are weighted with the energy of the tail too.
        let sampled = (conserved + view.tail_work) / n;
        let (virial, volume) = (virial / n, volume / n);
        ThermoRow {
            time: state.time,
            temperature: 2.0 * kinetic * n / view.n_dof(),
            temperature_of_positions: of_positions,
            kinetic_energy: kinetic,
            potential_energy: potential + tail.energy_per_particle,
            potential_energy_without_tail: potential,
            pressure: pressure + tail.pressure,
            pressure_without_tail: pressure,
            conserved_energy: kinetic + (conserved + view.tail_work - view.heat) / n,
            squared_force,
            laplacian,
            kinetic_energy_squared: kinetic * kinetic,
            sampled_potential_energy: sampled,
            sampled_potential_energy_squared: sampled * sampled,
            momentum_x: momentum.x,
            momentum_y: momentum.y,
            momentum_z: momentum.z,
            virial,
            virial_squared: virial * virial,
            sampled_energy_virial: sampled * virial,
            sampled_energy_kinetic: sampled * kinetic,
            inverse_kinetic_energy: kinetic.recip(),
            virial_over_kinetic: virial / kinetic,
            virial_squared_over_kinetic: virial * virial / kinetic,
            volume,
            volume_squared: volume * volume,
            sampled_energy_volume: sampled * volume,
            curvature_of_ends: self.curvature.map_or(0.0, |c| c.of_ends(&ends)) / n,
        }
    }
}
