//! The means that each ensemble needs, and what follows from them.
//!
//! Source: R. Lustig, Statistical thermodynamics in the classical molecular dynamics ensemble, J. Chem. Phys. 100, 3048 (1994),
//! for constant energy; the derivatives of the Helmholtz energy in the canonical ensemble follow from its definition.

use super::base::{Base, Setting};
use super::influence::Part;
use crate::statistics::{error_of_mean, mean};
use crate::{BuildContext, Ensemble, ThermoSeries};

/// Means per particle: temperature, potential energy and virial with their tails, what the cutoff adds to Σ r²u″, and then what the
/// ensemble needs.
pub(super) fn parts(
    setting: &Setting,
    rows: &ThermoSeries,
    cut: usize,
    context: &BuildContext,
) -> Vec<Part> {
    let after = |column: &[f64]| column[cut..].to_vec();
    let n = context.n_molecules() as f64;
    let temperature = after(&rows.temperature_of_positions);
    // The tail of a volume is a constant of it.
    let tail = mean(&after(&rows.pressure)) - mean(&after(&rows.pressure_without_tail));
    let tail = 3.0 * tail * setting.volume / n;
    let virial: Vec<f64> = rows.virial[cut..].iter().map(|w| w + tail).collect();
    let mut parts = vec![
        Part::mean_of(temperature),
        Part::mean_of(after(&rows.potential_energy)),
        Part::mean_of(virial),
        Part::mean_of(after(&rows.curvature_of_ends)),
    ];
    match setting.ensemble {
        Ensemble::Canonical => {
            let (u, w) = (&rows.sampled_potential_energy[cut..], &rows.virial[cut..]);
            let pairs = [
                (u, u, &rows.sampled_potential_energy_squared),
                (u, w, &rows.sampled_energy_virial),
                (w, w, &rows.virial_squared),
            ];
            parts.extend(pairs.map(|(a, b, ab)| covariance(a, b, &ab[cut..])));
        }
        Ensemble::Isobaric { .. } => {
            let (v, u) = (&rows.volume[cut..], &rows.sampled_potential_energy[cut..]);
            parts.push(Part::mean_of(v.to_vec()));
            let pairs = [
                (v, v, &rows.volume_squared),
                (v, u, &rows.sampled_energy_volume),
                (u, u, &rows.sampled_potential_energy_squared),
            ];
            parts.extend(pairs.map(|(a, b, ab)| covariance(a, b, &ab[cut..])));
        }
        Ensemble::Microcanonical => parts.extend(at_constant_energy(rows, cut)),
    }
    parts
}

/// ⟨(a − ā)(b − b̄)⟩ from row means of a, b and ab.
fn covariance(a: &[f64], b: &[f64], products: &[f64]) -> Part {
    let (mean_a, mean_b) = (mean(a), mean(b));
    let rows = a
        .iter()
        .zip(b)
        .zip(products)
        .map(|((a, b), ab)| ab - mean_a * b - mean_b * a + mean_a * mean_b)
        .collect();
    Part::moment_of(rows, independent(a, b))
}

/// The independent samples of two series, by their geometric mean.
fn independent(a: &[f64], b: &[f64]) -> f64 {
    (error_of_mean(a).n_effective * error_of_mean(b).n_effective).sqrt()
}

/// K, 1/K and W per particle: ⟨K⟩, ⟨1/K⟩, cov(K, 1/K), cov(W, 1/K), ⟨(W − W̄)²/K⟩.
fn at_constant_energy(rows: &ThermoSeries, cut: usize) -> [Part; 5] {
    let (k, inverse, w) =
        (&rows.kinetic_energy[cut..], &rows.inverse_kinetic_energy[cut..], &rows.virial[cut..]);
    let w_mean = mean(w);
    let ones = vec![1.0; k.len()];
    let squares = rows.virial_squared_over_kinetic[cut..]
        .iter()
        .zip(&rows.virial_over_kinetic[cut..])
        .zip(inverse)
        .map(|((ww, w), inverse)| ww - 2.0 * w_mean * w + w_mean * w_mean * inverse)
        .collect();
    [
        Part::mean_of(k.to_vec()),
        Part::mean_of(inverse.to_vec()),
        covariance(k, inverse, &ones),
        covariance(w, inverse, &rows.virial_over_kinetic[cut..]),
        Part::moment_of(squares, independent(w, w)),
    ]
}

/// What all response functions follow from, by the means of [`parts`].
pub(super) fn base(setting: &Setting, context: &BuildContext, means: &[f64]) -> Base {
    match setting.ensemble {
        Ensemble::Canonical => canonical(setting, context, means),
        Ensemble::Microcanonical => microcanonical(setting, context, means),
        Ensemble::Isobaric { pressure } => isobaric(setting, context, means, pressure),
    }
}

/// V² ∂²U/∂V² per particle under affine scaling, (X + 2W)/9; not a number where X is not known.
pub(super) fn second_volume_derivative(
    setting: &Setting,
    energy: f64,
    virial: f64,
    of_ends: f64,
) -> f64 {
    let Some(curvature) = setting.curvature else {
        return f64::NAN;
    };
    let x = curvature.of_virial * virial - curvature.of_energy * energy + of_ends;
    (x + 2.0 * virial) / 9.0
}

/// A20, A11, A01 and A02, the derivatives of the residual Helmholtz energy, from var(U), cov(U, U_V), var(U_V) and means, with
/// V·U_V = −W/3.
fn canonical(setting: &Setting, context: &BuildContext, means: &[f64]) -> Base {
    let &[t, energy, virial, of_ends, uu, uw, ww] = means else {
        unreachable!("the canonical ensemble has seven means");
    };
    let n = context.n_molecules() as f64;
    let rho = n / setting.volume;
    let beta = 1.0 / t;
    let second = second_volume_derivative(setting, energy, virial, of_ends);
    let a01 = beta * virial / 3.0;
    let a20 = -beta * beta * n * uu;
    let a11 = a01 - beta * beta * n * uw / 3.0;
    let a02 = beta * (second - beta * n * ww / 9.0) - 2.0 * a01;
    Base {
        density: rho,
        temperature: t,
        heat_capacity: 1.5 - a20,
        pressure_slope: rho * (1.0 + a01 - a11),
        dp_drho: t * (1.0 + 2.0 * a01 + a02),
        mass: setting.mass,
        correlation: uw / (uu * ww).sqrt(),
    }
}

/// Derivatives of the entropy of the states below an energy, with m = N_f/2 and n = N_f/3.
///
/// The ideal part of the degrees of freedom that the kept momentum takes is added, so that the values are for N_f = 3N.
/// K is scaled to the temperature of the positions, which a finite step makes differ from its own.
fn microcanonical(setting: &Setting, context: &BuildContext, means: &[f64]) -> Base {
    let &[t, energy, virial, of_ends, kinetic, inverse, k_inverse, w_inverse, ww_inverse] = means
    else {
        unreachable!("constant energy has nine means");
    };
    let atoms = context.n_molecules() as f64;
    let volume = setting.volume;
    let rho = atoms / volume;
    let (m, n) = (setting.n_dof / 2.0, setting.n_dof / 3.0);
    // 1/K of all particles, scaled.
    let scale = kinetic / (m * t);
    let per_all = |x: f64| scale * x;
    let inverse = per_all(inverse);
    let w_inverse = per_all(w_inverse);
    let ww_inverse = per_all(ww_inverse);
    let capacity = 1.0 / (1.0 - (1.0 - 1.0 / m) * (1.0 - k_inverse));
    // ⟨W/K⟩ and ⟨W²/K⟩ from central moments; W has its tail, which is constant.
    let w_over_k = w_inverse + virial * inverse;
    let ww_over_k = ww_inverse + 2.0 * virial * w_inverse + virial * virial * inverse;
    let slope = n / volume + capacity * (m - 1.0) * atoms * w_inverse / (3.0 * volume);
    let omega = n / volume + (m - 1.0) * atoms * w_over_k / (3.0 * volume);
    let second = atoms * second_volume_derivative(setting, energy, virial, of_ends);
    let mean_slope = -atoms * virial / (3.0 * volume);
    let pressure = n * t / volume - mean_slope;
    let of_volume = n * (n - 1.0) * t / volume.powi(2) - 2.0 * n / volume * mean_slope
        + (m - 1.0) * (atoms / (3.0 * volume)).powi(2) * ww_over_k
        - second / volume.powi(2);
    let isentropic = of_volume - pressure * omega - pressure * slope / capacity;
    let missing = atoms - n;
    let of_sound = -volume.powi(2) * isentropic / atoms + missing / atoms * t * 5.0 / 3.0;
    let heat_capacity = (capacity - m) / atoms + 1.5;
    let pressure_slope = slope + missing / volume;
    Base {
        density: rho,
        temperature: t,
        heat_capacity,
        pressure_slope,
        dp_drho: of_sound - t * (pressure_slope / rho).powi(2) / heat_capacity,
        mass: setting.mass,
        correlation: f64::NAN,
    }
}

/// κ_T, α_P and c_p from the fluctuations of V and of H = U + P₀V, with the energy that the motion feels.
fn isobaric(setting: &Setting, context: &BuildContext, means: &[f64], pressure: f64) -> Base {
    let &[t, _, _, _, volume, vv, vu, uu] = means else {
        unreachable!("constant pressure has eight means");
    };
    let n = context.n_molecules() as f64;
    let vh = vu + pressure * vv;
    let hh = uu + 2.0 * pressure * vu + pressure * pressure * vv;
    let rho = 1.0 / volume;
    let compressibility = n * vv / (volume * t);
    let expansion = n * vh / (volume * t * t);
    let at_pressure = n * hh / (t * t) + 1.5;
    Base {
        density: rho,
        temperature: t,
        heat_capacity: at_pressure - t * expansion.powi(2) / (rho * compressibility),
        pressure_slope: expansion / compressibility,
        dp_drho: 1.0 / (rho * compressibility),
        mass: setting.mass,
        correlation: f64::NAN,
    }
}
