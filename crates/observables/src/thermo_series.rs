//! The time series of the thermodynamic quantities.

use crate::series::columns;
use crate::statistics::mean;

columns! {
    /// The time series of [`crate::Thermodynamics`]: columns of equal length, energies per particle.
    pub struct ThermoSeries of ThermoRow {
        /// Time in τ; the mean time of the row's samples.
        time,
        /// Kinetic temperature 2K/n_dof on whole steps.
        temperature,
        /// The temperature that belongs to the positions: of half steps, or of whole steps where the method has no half
        /// ones.
        temperature_of_positions,
        /// Kinetic energy K/N.
        kinetic_energy,
        /// Potential energy per particle, with the tail where it is on.
        potential_energy,
        /// Potential energy per particle without the tail.
        potential_energy_without_tail,
        /// Pressure in ε/σ³, with the tail where it is on.
        pressure,
        /// Pressure without the tail.
        pressure_without_tail,
        /// (K + conserved potential − Σ heat)/N: what exact dynamics would keep constant.
        conserved_energy,
        /// Mean square force |∇U|²/N in ε²/σ²; zero where the configurational temperature is off.
        squared_force,
        /// Laplacian ∇²U/N in ε/σ², corrected for the jump of the force at the cutoff; zero where off.
        laplacian,
        /// Mean of (K/N)², for fluctuations: row means of a square survive averaging in pairs.
        kinetic_energy_squared,
        /// Potential energy per particle of which the forces are the gradient, U_s/N: for a plain cutoff the shifted one.
        /// Configurations are sampled with its Boltzmann factor, so fluctuations are taken of it. In a box that changes, the
        /// energy of the tail that the box feels, V·P_tail, belongs to it.
        sampled_potential_energy,
        /// Mean of (U_s/N)².
        sampled_potential_energy_squared,
        /// Total momentum per particle, x, in σ/τ.
        momentum_x,
        /// Total momentum per particle, y.
        momentum_y,
        /// Total momentum per particle, z.
        momentum_z,
        /// W/N = Σ r·F/N without the tail.
        virial,
        /// Mean of (W/N)².
        virial_squared,
        /// Mean of (U_s/N)(W/N).
        sampled_energy_virial,
        /// Mean of (U_s/N)(K/N).
        sampled_energy_kinetic,
        /// Mean of N/K.
        inverse_kinetic_energy,
        /// Mean of W/K.
        virial_over_kinetic,
        /// Mean of (W/N)²·N/K.
        virial_squared_over_kinetic,
        /// V/N.
        volume,
        /// Mean of (V/N)².
        volume_squared,
        /// Mean of (U_s/N)(V/N).
        sampled_energy_volume,
        /// What the cutoff adds to Σ r²u″/N, ε.
        curvature_of_ends,
    }
}

impl ThermoSeries {
    /// (K − K̄)(U_s − Ū_s) of each row after `cut`, at constant temperature, whose true mean is zero: velocities know nothing of positions there.
    ///
    /// U takes its energy from K for a while, so that both fluctuate together in a run. What follows from this alone is a quarter
    /// of the error of second derivatives. The leapfrog leaves cov(U, K) = −(T·h²/12)·cov(U, ∇²U/m), some 5·10⁻⁴ of var(U) at h = 0.004.
    pub(crate) fn exchange(&self, cut: usize) -> Vec<f64> {
        let (k, u) = (&self.kinetic_energy[cut..], &self.sampled_potential_energy[cut..]);
        let (mean_k, mean_u) = (mean(k), mean(u));
        let products = self.sampled_energy_kinetic[cut..].iter();
        products
            .zip(k.iter().zip(u))
            .map(|(ku, (k, u))| ku - mean_k * u - mean_u * k + mean_k * mean_u)
            .collect()
    }

    /// The columns of the table `measured`, with energies in the unit `per_particle`. The temperature of the positions has a
    /// column of its own, `temperature_half_steps`, where the method has half steps.
    pub(crate) fn measured<'a>(
        &'a self,
        half_steps: bool,
        per_particle: &'a str,
    ) -> impl Iterator<Item = (&'a str, &'a str, &'a Vec<f64>)> {
        let columns = [
            ("temperature", "ε/k_B", &self.temperature),
            ("temperature_half_steps", "ε/k_B", &self.temperature_of_positions),
            ("kinetic_energy", per_particle, &self.kinetic_energy),
            ("potential_energy", per_particle, &self.potential_energy),
            ("potential_energy_without_tail", per_particle, &self.potential_energy_without_tail),
            ("pressure", "ε/σ³", &self.pressure),
            ("pressure_without_tail", "ε/σ³", &self.pressure_without_tail),
            ("conserved_energy", per_particle, &self.conserved_energy),
            ("momentum_x", "σ/τ per particle", &self.momentum_x),
            ("momentum_y", "σ/τ per particle", &self.momentum_y),
            ("momentum_z", "σ/τ per particle", &self.momentum_z),
        ];
        let is_there = move |name: &str| half_steps || name != "temperature_half_steps";
        columns.into_iter().filter(move |(name, ..)| is_there(name))
    }
}
