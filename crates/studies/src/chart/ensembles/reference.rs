//! What density and variance of V should be at the pressure and temperature of a scene.

use lennard_scene::{Scene, model_kind};
use serde::Serialize;

use super::point::EnsemblePoint;
use crate::lab::Value;

/// Density and variance of V that every right choice samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reference {
    /// Density, σ⁻³.
    pub density: f64,
    /// Its standard error, where it is a mean of runs.
    pub density_error: Option<f64>,
    /// Variance of the volume, σ⁶.
    pub variance: f64,
    /// Its standard error, likewise.
    pub variance_error: Option<f64>,
    /// Where they come from.
    pub source: String,
}

/// The reference of a scene with `units` molecules or particles. `missing` is 1 − n_dof/3N.
///
/// The equation of state gives ρ at P₀ + missing·ρT, and var V = T·V·κ_T. Without an equation that covers the state, both are the
/// means of all runs, weighted by their independent samples.
pub(super) fn reference(
    scene: &Scene,
    units: f64,
    missing: f64,
    temperature: f64,
    pressure: f64,
    points: &[EnsemblePoint],
) -> Option<Reference> {
    let of_runs = |why: &str| {
        let all: Vec<_> = points.iter().filter_map(EnsemblePoint::found).collect();
        let density = together(all.iter().map(|s| s.density))?;
        let variance = together(all.iter().map(|s| s.variance))?;
        Some(Reference {
            density: density.0,
            density_error: Some(density.1),
            variance: variance.0,
            variance_error: Some(variance.1),
            source: format!("the mean of all runs here: {why}"),
        })
    };
    let equation = match lennard_literature::equation_of_state_for(model_kind(scene)) {
        Ok(equation) => equation,
        Err(none) => return of_runs(&none.to_string()),
    };
    let Some(first) = equation.density(pressure, temperature) else {
        return of_runs("the equation of state covers no such state");
    };
    let shifted = pressure + missing * first * temperature;
    let density = equation.density(shifted, temperature).unwrap_or(first);
    if !equation.phase(density, temperature).is_stable() {
        return of_runs("the equation of state calls this state unstable");
    }
    let state = equation.at(density, temperature);
    let compressibility = 1.0 / (density * state.dp_drho);
    Some(Reference {
        density,
        density_error: None,
        variance: temperature * (units / density) * compressibility,
        variance_error: None,
        source: equation.spec().name.clone(),
    })
}

/// The mean of values, each as heavy as its number of independent samples, with its standard error. The errors themselves are no good
/// weights: a variance that came out small by chance has a small error too.
fn together(values: impl Iterator<Item = Value>) -> Option<(f64, f64)> {
    let (mut weights, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for value in values.filter(|v| v.standard_error.is_finite() && v.n_effective > 0.0) {
        let weight = value.n_effective;
        weights += weight;
        sum += weight * value.mean;
        squares += (weight * value.standard_error).powi(2);
    }
    (weights > 0.0).then(|| (sum / weights, squares.sqrt() / weights))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_runs_trusts_the_long_ones() {
        let value = |mean, standard_error, n_effective| Value { mean, standard_error, n_effective };
        let (mean, error) =
            together([value(1.0, 1.0, 10.0), value(2.0, 0.5, 40.0)].into_iter()).unwrap();
        assert!((mean - 1.8).abs() < 1e-12 && (error - 500.0_f64.sqrt() / 50.0).abs() < 1e-12);
        assert!(together([value(1.0, f64::NAN, 10.0)].into_iter()).is_none());
    }
}
