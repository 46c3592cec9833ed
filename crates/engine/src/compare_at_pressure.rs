//! A run at constant pressure beside the literature: density and energy at (P₀, T).

use lennard_core::{Average, Observable};
use lennard_io::StatePoint;
use lennard_literature::EquationOfState;
use lennard_observables::{ChangingBox, Thermodynamics};
use lennard_scene::Scene;

use crate::compare::{Comparison, equation_for};

/// Density and U of a run at constant pressure beside the equation of state at the pressure of the barostat.
///
/// `n_dof` counts the degrees of freedom of centres of mass, of `atoms` particles or molecules.
/// Velocities without total momentum sample V^{N−1}: the mean of ρT + W/(3V) + P_tail is then P₀ + T/V, and the equation is
/// taken at that pressure. The temperature is the measured one that belongs to the positions.
#[must_use]
pub fn at_constant_pressure(
    scene: &Scene,
    atoms: usize,
    n_dof: f64,
    thermodynamics: &Thermodynamics,
    changing: &ChangingBox,
) -> Comparison {
    let (model, equation) = match equation_for(scene) {
        Ok(found) => found,
        Err(comparison) => return comparison,
    };
    let mut comparison = Comparison::default();
    let stage = scene.stages.iter().find(|s| s.measure && !s.is_ramp());
    let Some(control) = stage.and_then(|s| s.barostat.as_ref()) else {
        comparison.remarks.push("not compared: pressure or temperature change on the way".into());
        return comparison;
    };
    let equilibrium = thermodynamics.equilibrium();
    if equilibrium.doubt.is_some() {
        // The averages say why.
        return comparison;
    }
    let rows = &thermodynamics.series().temperature_of_positions[equilibrium.cut..];
    let temperature = rows.iter().sum::<f64>() / rows.len() as f64;
    let density = changing.density(equilibrium.discarded);
    let n = atoms as f64;
    let missing = (n - n_dof / 3.0) / n;
    let pressure = control.pressure + missing * density.estimate.mean * temperature;
    let Some(expected) = equation.density(pressure, temperature) else {
        comparison.remarks.push(format!(
            "not compared: {} covers no state at P = {pressure:.4}, T = {temperature:.4}",
            equation.spec().name
        ));
        return comparison;
    };
    let phase = equation.phase(expected, temperature);
    if !phase.is_stable() {
        comparison.remarks.push(format!(
            "not compared: by {} the state P = {pressure:.4}, T = {temperature:.4} is {}",
            equation.spec().name,
            phase.describe()
        ));
        return comparison;
    }
    let averages = thermodynamics.finish(equilibrium.discarded).averages;
    let energy = averages.iter().find(|a| a.name == "potential_energy");
    let at =
        StatePoint { temperature, half_steps: thermodynamics.has_half_steps(), density: expected };
    let of_energy = equation.at(expected, temperature).potential_energy;
    let found = [(Some(&density), expected), (energy, of_energy)];
    let sound = found.into_iter().filter_map(|(average, reference)| {
        let average = average.filter(|a| a.doubt.is_none())?;
        Some(entry(average, reference, equation, at))
    });
    comparison.entries.extend(sound);
    comparison.remarks.extend(lennard_literature::remark_for(model));
    comparison
}

fn entry(
    average: &Average,
    reference: f64,
    equation: &dyn EquationOfState,
    at: StatePoint,
) -> lennard_io::Comparison {
    let difference = average.estimate.mean - reference;
    let standard_error = average.estimate.standard_error;
    lennard_io::Comparison {
        quantity: average.name.clone(),
        unit: average.unit.clone(),
        measured: average.estimate.mean,
        reference,
        finite_size: None,
        finite_size_uncertainty: None,
        reference_uncertainty: None,
        difference,
        standard_error,
        in_standard_errors: difference / standard_error,
        at,
        source: equation.spec().citation(),
        remark: equation.spec().model.clone(),
    }
}
