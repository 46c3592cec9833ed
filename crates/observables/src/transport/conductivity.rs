//! The thermal conductivity.

use crate::{Frames, ObservableSpec, Surroundings, recipe};
use lennard_core::exact::exact_sum;
use lennard_core::{DVec3, View, Want};

use super::DEFAULT_WINDOW;
use super::green_kubo::{LONG_ENOUGH, Words};
use super::of_flux::{Flux, OfFlux};

const SPEC: ObservableSpec = ObservableSpec {
    name: "thermal-conductivity",
    summary: "thermal conductivity from the correlation of the heat flux (Green–Kubo)",
    equation: "λ = V/(3T²) ∫₀^∞ ⟨J(0)·J(t)⟩ dt; V J = Σ_i [e_i v_i + ½ Σ_{j≠i} r_ij (F_ij·v_i)], e_i = ½ m v_i² + ½ Σ_j U(r_ij)",
    source: "J. H. Irving and J. G. Kirkwood, The statistical mechanical theory of transport processes IV, J. Chem. Phys. 18, 817 (1950), \
             equation 6.16; M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, 2nd ed. (2017), equations 2.122 and 2.123",
    dynamic: true,
    suits: crate::Suits::OneSpecies,
    every: 4,
    surroundings: Surroundings::Periodic,
    frames: Frames::Flows,
    follows_changing_box: false,
    alone: Some("follows the energy of single particles"),
    ..ObservableSpec::PLAIN
};

const WORDS: Words = Words {
    name: "thermal_conductivity",
    plain: "thermal conductivity",
    unit: "k_B/(στ)",
    correlation_unit: "k_B/(στ²)",
};

lennard_core::options! {
    /// Options of [`ThermalConductivity`].
    pub struct ThermalConductivityOptions {
        /// Longest lag of the correlation of the heat flux.
        window: f64 = DEFAULT_WINDOW, Between(1e-9, 1e9), in "τ";
    }
}

recipe! {
    ThermalConductivityOptions, lasting LONG_ENOUGH windows,
    |options, context| ThermalConductivity::new(options.window, context)?
}

/// The thermal conductivity λ in k_B/(στ) from the fluctuations of the heat flux at equilibrium.
///
/// The heat flux of pair forces is V J = Σ_i [e_i v_i + W_i v_i] with the energy e_i and the virial W_i = ½
/// Σ_j r_ij ⊗ F_ij of a particle, half of each pair to either side. The enthalpy that the particles carry, h Σ
/// v_i, must be taken off. In a fluid of one component it is the momentum times a constant. It vanishes here
/// because velocities are taken relative to the centre of mass.
///
/// With a plain cutoff e_i jumps by ½ U(r_cut), 0.008 ε at 2.5 σ, when a pair crosses the cutoff, and no force
/// does this work. About √50 such jumps at once change e_i by less than 0.06 of 6 ε. A tail correction is a
/// constant part of the enthalpy and does not enter.
pub type ThermalConductivity = OfFlux<HeatFlux>;

/// The heat flux J in ε/(σ²τ), relative to the centre of mass.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatFlux;

impl Flux for HeatFlux {
    const SPEC: &'static ObservableSpec = &SPEC;
    const WORDS: Words = WORDS;
    const WANT: Want = Want { per_particle: true, ..Want::NOTHING };
    const COMPONENTS: usize = 3;

    fn of(view: &View<'_>) -> Option<impl AsRef<[f64]>> {
        let state = view.state;
        let each = state.energetics.per_particle.as_ref()?;
        let masses = &view.system.masses;
        let mass: f64 = exact_sum(state.len(), |i| masses.of(i));
        let drift = view.system.momentum(&state.velocities) / mass;
        let sum: DVec3 = exact_sum(state.len(), |i| {
            let v = state.velocities[i] - drift;
            let (potential, virial) = each[i];
            let energy = 0.5 * masses.of(i) * v.length_squared() + potential;
            // Columns of the tensor belong to the components of the force: (r ⊗ F) v = r (F·v).
            energy * v + virial * v
        });
        Some((sum / view.cell().volume()).to_array())
    }

    fn prefactor(volume: f64, temperature: f64) -> f64 {
        volume / temperature.powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{context, normal};
    use lennard_core::{DMat3, Energetics, State, System};

    fn flux(velocities: Vec<DVec3>, each: Vec<(f64, DMat3)>) -> DVec3 {
        let n = velocities.len();
        let cell = context(2.0, n).cell;
        let mut state = State::new(cell, vec![DVec3::ZERO; n], velocities);
        state.energetics = Energetics { per_particle: Some(each), ..Energetics::default() };
        let system = System::atoms(n);
        let view = View::of(&state, &system);
        let flux = HeatFlux::of(&view).unwrap();
        DVec3::from_slice(flux.as_ref()) * cell.volume()
    }

    #[test]
    fn the_heat_flux_of_an_ideal_gas_has_its_exact_variance_in_any_frame() {
        // ⟨(½v²)² v_x²⟩ = 35/4 T³ less the enthalpy 5/2 T carried along, (5/2)² T³: 5/2 N T³.
        let (n, temperature, draws) = (200, 0.9_f64, 3000);
        let mut sum = 0.0;
        for s in 0..draws {
            let still: Vec<DVec3> = (0..n).map(|i| temperature.sqrt() * normal(5, s, i)).collect();
            let moving: Vec<DVec3> =
                still.iter().map(|v| *v + DVec3::new(3.0, -1.0, 0.5)).collect();
            let nothing = || vec![(0.0, DMat3::ZERO); n];
            let (a, b) = (flux(still, nothing()), flux(moving, nothing()));
            // Roundings of sums of 200 numbers up to some ten.
            assert!((a - b).length() < 1e-9);
            sum += a.length_squared() / 3.0;
        }
        let exact = 2.5 * n as f64 * temperature.powi(3);
        // 9000 nearly normal components know a variance to 1.5 %, and the centre of mass takes 1/N.
        assert!((sum / draws as f64 / exact - 1.0).abs() < 0.06, "{} {exact}", sum / draws as f64);
    }

    #[test]
    fn two_particles_carry_the_work_that_one_does_on_the_other() {
        // r_12 = x, F_12 = f x: each holds half of r ⊗ F. V J = Σ e_i v_i + ½ r_12 F_12·(v_1 + v_2).
        let (f, v1, v2) = (2.0, DVec3::new(1.0, 0.5, 0.0), DVec3::new(-1.0, -0.5, 0.0));
        let half = DMat3::from_cols(DVec3::X * (0.5 * f), DVec3::ZERO, DVec3::ZERO);
        let found = flux(vec![v1, v2], vec![(0.3, half), (0.7, half)]);
        let kinetic = 0.5 * v1.length_squared();
        let exact =
            (kinetic + 0.3) * v1 + (kinetic + 0.7) * v2 + 0.5 * f * DVec3::X * (v1.x + v2.x);
        assert!((found - exact).length() < 1e-15);
        // An asymmetric share of the work shows in the direction of r_ij, not in the direction of the
        // velocity.
        let tilted = DMat3::from_cols(DVec3::ZERO, DVec3::X, DVec3::ZERO);
        let found = flux(vec![v1, v2], vec![(0.0, tilted), (0.0, DMat3::ZERO)]);
        assert!((found - DVec3::X * v1.y).length() < 1e-15);
    }
}
