//! A run beside the literature.

use lennard_core::{Average, Observable};
use lennard_io::StatePoint;
use lennard_literature::{EquationOfState, FiniteSize, FiniteSizeDoubt, Kept, ModelKind};
use lennard_observables::Thermodynamics;
use lennard_scene::{Scene, model_kind};

use crate::baths::measured_baths;

/// What was compared, and what could not be.
#[derive(Debug, Clone, Default)]
pub struct Comparison {
    /// Measured values beside reference values.
    pub entries: Vec<lennard_io::Comparison>,
    /// Remarks that belong beside them.
    pub remarks: Vec<String>,
}

/// The viscosity of the reference table near a scene's state, for the finite-size correction of D;
/// `None` where the model is not Lennard-Jones or none is near.
#[must_use]
pub fn viscosity_for(scene: &Scene, density: f64) -> Option<f64> {
    let is_another_fluid = matches!(
        model_kind(scene),
        ModelKind::Other { .. }
            | ModelKind::Mie { .. }
            | ModelKind::TwoCenter { .. }
            | ModelKind::Mixture { .. }
            | ModelKind::KobAndersen
    );
    if is_another_fluid || scene.confined_by().is_some() {
        return None;
    }
    let temperature = scene.stages.iter().rev().find(|s| s.measure)?.temperature;
    lennard_literature::viscosity_near(density, temperature).map(|v| v.value)
}

/// By how much U and P of `atoms` particles differ from the equation's, which is for an infinite system; `None` at
/// constant pressure.
fn finite_size(
    scene: &Scene,
    equation: &dyn EquationOfState,
    density: f64,
    temperature: f64,
    atoms: usize,
) -> Option<FiniteSize> {
    if scene.stages.iter().any(|s| s.measure && s.barostat.is_some()) {
        return None;
    }
    let with_bath = scene.stages.iter().any(|s| s.measure && s.thermostat.is_some());
    let kept = if with_bath { Kept::Temperature } else { Kept::Energy };
    FiniteSize::of(equation, density, temperature, atoms, kept)
}

/// The model of a scene and the equation of state that describes it; else a comparison that says why there is none.
pub(crate) fn equation_for(
    scene: &Scene,
) -> Result<(ModelKind, &'static dyn EquationOfState), Comparison> {
    let model = model_kind(scene);
    let equation = lennard_literature::equation_of_state_for(model);
    let why = match (scene.not_homogeneous(), equation) {
        (None, Ok(equation)) => return Ok((model, equation)),
        (None, Err(none)) => none.to_string(),
        (Some(why), _) => format!("not compared with any equation of state: {why}"),
    };
    Err(Comparison { remarks: vec![why], ..Comparison::default() })
}

/// U and P of a run beside the equation of state that describes its model, at ρ and the measured temperature that
/// belongs to the positions ([`Thermodynamics`]).
///
/// The error of each difference is the error of the series X_b − [X_EOS(T̄) + (T_b − T̄)·∂X_EOS/∂T],
/// which carries the correlation of X and T.
#[must_use]
pub fn with_equation_of_state(
    scene: &Scene,
    density: f64,
    atoms: usize,
    thermodynamics: &Thermodynamics,
) -> Comparison {
    beside_equation_of_state(scene, density, atoms, thermodynamics, Compared::Results)
}

/// What a state is by an equation of state that covers it, where it is no stable fluid.
pub(crate) fn unstable(
    equation: &dyn EquationOfState,
    density: f64,
    temperature: f64,
) -> Option<String> {
    let phase = equation.phase(density, temperature);
    (!phase.is_stable()).then(|| {
        let name = &equation.spec().name;
        let phase = phase.describe();
        format!("by {name} the state ρ = {density:.4}, T = {temperature:.4} is {phase}")
    })
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compared {
    /// Results alone: means against which nothing speaks, in a stable state, so that the difference is a finding.
    Results,
    /// Whatever was averaged: studies of settings compare short runs with each other, and tell their statistical floor.
    Anything,
}

/// As [`with_equation_of_state`], with a choice of what is compared.
#[must_use]
pub fn beside_equation_of_state(
    scene: &Scene,
    density: f64,
    atoms: usize,
    thermodynamics: &Thermodynamics,
    what: Compared,
) -> Comparison {
    let results = what == Compared::Results;
    let (model, equation) = match equation_for(scene) {
        Ok(found) => found,
        Err(comparison) => return comparison,
    };
    let mut comparison = Comparison::default();
    let equilibrium = thermodynamics.equilibrium();
    let ramp = scene.stages.iter().any(|s| s.measure && s.is_ramp());
    let scaled = ramp || measured_baths(scene).iter().any(|bath| !bath.canonical);
    if results && (equilibrium.doubt.is_some() || scaled) {
        // The averages say why.
        return comparison;
    }
    let series = thermodynamics.series();
    let temperatures = &series.temperature_of_positions[equilibrium.cut..];
    if temperatures.len() < 2 {
        comparison.remarks.push("too few samples to compare with an equation of state".into());
        return comparison;
    }
    let mean_temperature = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
    if let Err(outside) = equation.check(density, mean_temperature) {
        comparison.remarks.push(format!("not compared: {outside}"));
        return comparison;
    }
    if results && let Some(unstable) = unstable(equation, density, mean_temperature) {
        comparison.remarks.push(format!("not compared: {unstable}"));
        return comparison;
    }
    let state = equation.at(density, mean_temperature);
    let finite_size = finite_size(scene, equation, density, mean_temperature, atoms);
    let own = equation.uncertainty(density, mean_temperature);
    let averages = thermodynamics.finish(equilibrium.discarded).averages;
    let quantities = [
        (
            "potential_energy",
            state.potential_energy,
            finite_size.map(|f| f.potential_energy),
            thermodynamics.potential_energy_against(state.du_dt),
            own.as_ref().map(|u| u.potential_energy),
        ),
        (
            "pressure",
            state.pressure,
            finite_size.map(|f| f.pressure),
            thermodynamics.pressure_against(state.dp_dt),
            own.as_ref().map(|u| u.pressure),
        ),
    ];
    let doubt = finite_size.and_then(|f| f.doubt);
    let applies = doubt != Some(FiniteSizeDoubt::NotSmall);
    for (name, infinite, term, against, reference_uncertainty) in quantities {
        let sound = |a: &&Average| a.name == name && (a.doubt.is_none() || !results);
        let Some(average) = averages.iter().find(sound) else {
            continue;
        };
        let finite_size = term.filter(|_| applies);
        let reference = infinite + finite_size.unwrap_or(0.0);
        let difference = average.estimate.mean - reference;
        comparison.entries.push(lennard_io::Comparison {
            quantity: name.to_owned(),
            unit: average.unit.clone(),
            measured: average.estimate.mean,
            reference,
            finite_size,
            finite_size_uncertainty: term.filter(|_| doubt.is_some()).map(f64::abs),
            reference_uncertainty,
            difference,
            standard_error: against.standard_error,
            in_standard_errors: difference / against.standard_error,
            at: StatePoint {
                temperature: mean_temperature,
                half_steps: thermodynamics.has_half_steps(),
                density,
            },
            source: equation.spec().citation(),
            remark: equation.spec().model.clone(),
        });
    }
    if let Some(shift) = finite_size.filter(|_| applies) {
        comparison.remarks.push(format!(
            "the references are for {atoms} particles in a closed box: {:+.5} ε and {:+.5} ε/σ³ beside an infinite system",
            shift.potential_energy, shift.pressure
        ));
    }
    comparison.remarks.extend(lennard_literature::remark_for(model));
    comparison
}
