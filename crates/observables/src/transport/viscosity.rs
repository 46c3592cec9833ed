//! The shear viscosity.

use crate::{Frames, ObservableSpec, PressureTensor, Surroundings, recipe};
use lennard_core::{DMat3, View, Want};

use super::DEFAULT_WINDOW;
use super::green_kubo::{LONG_ENOUGH, Words};
use super::of_flux::{Flux, OfFlux};

const SPEC: ObservableSpec = ObservableSpec {
    name: "shear-viscosity",
    summary: "shear viscosity from the correlation of the pressure tensor (Green–Kubo)",
    equation: "η = V/T ∫₀^∞ ⟨P_s(0) P_s(t)⟩ dt, averaged over the five independent components P_s of the traceless symmetric pressure tensor",
    source: "P. J. Daivis and D. J. Evans, Comparison of constant pressure and constant volume nonequilibrium simulations of \
             sheared model decane, J. Chem. Phys. 100, 541 (1994), equation 11",
    dynamic: true,
    suits: crate::Suits::Atoms,
    every: 4,
    surroundings: Surroundings::Periodic,
    frames: Frames::Flows,
    follows_changing_box: false,
    alone: None,
    ..ObservableSpec::PLAIN
};

const WORDS: Words = Words {
    name: "shear_viscosity",
    plain: "shear viscosity",
    unit: "ετ/σ³",
    correlation_unit: "ε/σ³",
};

lennard_core::options! {
    /// Options of [`ShearViscosity`].
    pub struct ShearViscosityOptions {
        /// Longest lag of the correlation of the pressure tensor.
        window: f64 = DEFAULT_WINDOW, Between(1e-9, 1e9), in "τ";
    }
}

recipe! {
    ShearViscosityOptions, lasting LONG_ENOUGH windows,
    |options, context| ShearViscosity::new(options.window, context)?
}

/// The shear viscosity η in ετ/σ³ from the fluctuations of the pressure tensor at equilibrium.
///
/// Components: P_xy, P_xz, P_yz, (P_xx − P_yy)/2 and (2P_zz − P_xx − P_yy)/(2√3). The last two are shear
/// stresses in rotated axes. In an isotropic fluid all five have the same correlation and are independent, so
/// each counts once. Their mean equals V/(10T) ∫⟨P_os(0):P_os(t)⟩ dt with the traceless symmetric tensor
/// P_os. A tail correction is isotropic and does not enter.
pub type ShearViscosity = OfFlux<ShearStress>;

/// The shear stress in ε/σ³.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearStress;

impl Flux for ShearStress {
    const SPEC: &'static ObservableSpec = &SPEC;
    const WORDS: Words = WORDS;
    const WANT: Want = Want::VIRIAL_TENSOR;
    const COMPONENTS: usize = 5;

    fn of(view: &View<'_>) -> Option<impl AsRef<[f64]>> {
        Some(shear_components(&PressureTensor::of(view)?))
    }

    fn prefactor(volume: f64, temperature: f64) -> f64 {
        volume / temperature
    }
}

/// The five independent components of the traceless symmetric part.
fn shear_components(p: &DMat3) -> [f64; 5] {
    let (xx, yy, zz) = (p.x_axis.x, p.y_axis.y, p.z_axis.z);
    [
        0.5 * (p.y_axis.x + p.x_axis.y),
        0.5 * (p.z_axis.x + p.x_axis.z),
        0.5 * (p.z_axis.y + p.y_axis.z),
        0.5 * (xx - yy),
        (2.0 * zz - xx - yy) / (2.0 * 3.0_f64.sqrt()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{context, normal};
    use crate::{BuildContext, Observable};
    use lennard_core::{DVec3, Energetics, State, System};

    #[test]
    fn every_component_of_an_ideal_gas_has_the_variance_of_its_kinetic_stress() {
        // V²⟨P_s²⟩ = N T² for each of the five (⟨v_x²v_y²⟩ = T², ⟨(v_x² − v_y²)²⟩/4 = T²).
        let (n, temperature) = (40, 1.3_f64);
        let mut sums = [0.0; 5];
        let draws = 4000;
        for s in 0..draws {
            let velocities: Vec<DVec3> =
                (0..n).map(|i| temperature.sqrt() * normal(3, s, i)).collect();
            let p = velocities
                .iter()
                .fold(DMat3::ZERO, |m, v| m + DMat3::from_cols(*v * v.x, *v * v.y, *v * v.z));
            for (sum, c) in sums.iter_mut().zip(shear_components(&p)) {
                *sum += c * c;
            }
        }
        let exact = n as f64 * temperature.powi(2);
        for sum in sums {
            // A variance from 4000 draws of a nearly normal number is known to √(2/4000) = 2.2 %: four of these.
            assert!((sum / draws as f64 / exact - 1.0).abs() < 0.09, "{sums:?}");
        }
    }

    #[test]
    fn a_rotation_leaves_the_sum_of_the_squares() {
        let p = DMat3::from_cols_array(&[1.0, 0.3, -0.2, 0.3, -0.4, 0.7, -0.2, 0.7, 2.0]);
        let r = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -1.0).normalize(), 0.8);
        let square = |p: &DMat3| -> f64 { shear_components(p).iter().map(|c| c * c).sum() };
        // Roundings of numbers of order one.
        assert!((square(&p) - square(&(r * p * r.transpose()))).abs() < 1e-12);
    }

    #[test]
    fn stress_with_a_known_correlation_gives_its_viscosity() {
        // The virial of an artificial state follows an autoregressive process of variance s² V² per component.
        let context = BuildContext { dt: 0.02, ..context(5.0, 2) };
        let (volume, phi) = (125.0, 0.9_f64);
        let mut viscosity = ShearViscosity::new(4.0, &context).unwrap();
        let mut state = State::new(context.cell, vec![DVec3::ZERO; 2], vec![DVec3::X, -DVec3::X]);
        let system = System::atoms(2);
        let temperature = system.temperature(&state.velocities, lennard_core::Momentum::Conserved);
        let mut shear = DVec3::ZERO;
        for s in 0..60_000 {
            shear = phi * shear + (1.0 - phi * phi).sqrt() * normal(8, s, 0);
            let (a, b, c) = (shear.x * volume, shear.y * volume, shear.z * volume);
            let diagonal = normal(9, s, 0) * 1e-9;
            state.energetics = Energetics {
                virial: Some(DMat3::from_cols_array(&[
                    diagonal.x, a, b, a, diagonal.y, c, b, c, diagonal.z,
                ])),
                ..Energetics::default()
            };
            viscosity.sample(&View::of(&state, &system));
        }
        let estimate = viscosity.finish(0.0).averages[0].estimate;
        // Three of the five components are alive, and the trapezoidal sum of φ^k is ½(1 + φ)/(1 − φ) steps. The
        // constant kinetic difference P_xx − P_yy of two particles that never turn is small against both.
        let exact = 0.6 * volume / temperature * 0.02 * 0.5 * 1.9 / 0.1;
        let off = (estimate.mean - exact).abs();
        assert!(off < 4.0 * estimate.standard_error + 0.04 * exact, "{} {exact}", estimate.mean);
        assert!(estimate.standard_error < 0.1 * exact);
    }
}
