//! A run beside the literature: U and P at constant volume, density and U at constant pressure.

use lennard_io::StatePoint;
use lennard_literature::{EquationOfState, FiniteSize, FiniteSizeDoubt, Kept, ModelKind};
use lennard_observables::{Average, ChangingBox, Observable, Thermodynamics};
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

impl Comparison {
    /// Nothing compared, and why; `None` where the averages say why.
    pub(crate) fn without(why: Option<String>) -> Self {
        Self { entries: Vec::new(), remarks: why.into_iter().collect() }
    }
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

/// The model of a scene and the equation of state that describes it; else why there is none.
pub(crate) fn equation_for(
    scene: &Scene,
) -> Result<(ModelKind, &'static dyn EquationOfState), String> {
    let model = model_kind(scene);
    let equation = lennard_literature::equation_of_state_for(model);
    match (scene.not_homogeneous(), equation) {
        (None, Ok(equation)) => Ok((model, equation)),
        (None, Err(none)) => Err(none.to_string()),
        (Some(why), _) => Err(format!("not compared with any equation of state: {why}")),
    }
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

/// U and P of a run beside the equation of state that describes its model, at ρ and the measured temperature that
/// belongs to the positions ([`Thermodynamics`]).
///
/// The error of each difference is the error of the series X_b − [X_EOS(T̄) + (T_b − T̄)·∂X_EOS/∂T],
/// which carries the correlation of X and T.
#[must_use]
pub fn beside_equation_of_state(
    scene: &Scene,
    density: f64,
    atoms: usize,
    thermodynamics: &Thermodynamics,
    what: Compared,
) -> Comparison {
    at_constant_volume(scene, density, atoms, thermodynamics, what)
        .unwrap_or_else(Comparison::without)
}

/// As [`beside_equation_of_state`].
///
/// # Errors
/// Why nothing was compared; `None` where the averages say why.
pub(crate) fn at_constant_volume(
    scene: &Scene,
    density: f64,
    atoms: usize,
    thermodynamics: &Thermodynamics,
    what: Compared,
) -> Result<Comparison, Option<String>> {
    let results = what == Compared::Results;
    let (model, equation) = equation_for(scene).map_err(Some)?;
    let mut comparison = Comparison::default();
    let equilibrium = thermodynamics.equilibrium();
    let ramp = scene.stages.iter().any(|s| s.measure && s.is_ramp());
    let scaled = ramp || measured_baths(scene).iter().any(|bath| !bath.canonical);
    if results && (equilibrium.doubt.is_some() || scaled) {
        // The averages say why.
        return Err(None);
    }
    let series = thermodynamics.series();
    let temperatures = &series.temperature_of_positions[equilibrium.cut..];
    if temperatures.len() < 2 {
        return Err(Some("too few samples to compare with an equation of state".into()));
    }
    let mean_temperature = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
    let outside = equation.check(density, mean_temperature);
    outside.map_err(|outside| Some(format!("not compared: {outside}")))?;
    if results && let Some(unstable) = unstable(equation, density, mean_temperature) {
        return Err(Some(format!("not compared: {unstable}")));
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
    let half_steps = thermodynamics.has_half_steps();
    let at = StatePoint { temperature: mean_temperature, half_steps, density };
    for (name, infinite, term, against, reference_uncertainty) in quantities {
        let sound = |a: &&Average| a.name == name && (a.doubt.is_none() || !results);
        let Some(average) = averages.iter().find(sound) else {
            continue;
        };
        let finite_size = term.filter(|_| applies);
        let reference = infinite + finite_size.unwrap_or(0.0);
        comparison.entries.push(lennard_io::Comparison {
            finite_size,
            finite_size_uncertainty: term.filter(|_| doubt.is_some()).map(f64::abs),
            reference_uncertainty,
            ..entry(average, reference, against.standard_error, equation, at)
        });
    }
    if let Some(shift) = finite_size.filter(|_| applies) {
        comparison.remarks.push(format!(
            "the references are for {atoms} particles in a closed box: {:+.5} ε and {:+.5} ε/σ³ beside an infinite system",
            shift.potential_energy, shift.pressure
        ));
    }
    comparison.remarks.extend(lennard_literature::remark_for(model));
    Ok(comparison)
}

/// Density and U of a run at constant pressure beside the equation of state at the pressure of the barostat.
///
/// `n_dof` counts the degrees of freedom of centres of mass, of `atoms` particles or molecules.
/// Velocities without total momentum sample V^{N−1}: the mean of ρT + W/(3V) + P_tail is then P₀ + T/V, and the equation is
/// taken at that pressure. The temperature is the measured one that belongs to the positions.
///
/// # Errors
/// Why nothing was compared; `None` where the averages say why.
pub(crate) fn at_constant_pressure(
    scene: &Scene,
    atoms: usize,
    n_dof: f64,
    thermodynamics: &Thermodynamics,
    changing: &ChangingBox,
) -> Result<Comparison, Option<String>> {
    let (model, equation) = equation_for(scene).map_err(Some)?;
    let stage = scene.stages.iter().find(|s| s.measure && !s.is_ramp());
    let Some(control) = stage.and_then(|s| s.barostat.as_ref()) else {
        return Err(Some("not compared: pressure or temperature change on the way".into()));
    };
    let equilibrium = thermodynamics.equilibrium();
    if equilibrium.doubt.is_some() {
        // The averages say why.
        return Err(None);
    }
    let rows = &thermodynamics.series().temperature_of_positions[equilibrium.cut..];
    let temperature = rows.iter().sum::<f64>() / rows.len() as f64;
    let density = changing.density(equilibrium.discarded);
    let n = atoms as f64;
    let missing = (n - n_dof / 3.0) / n;
    let pressure = control.pressure + missing * density.estimate.mean * temperature;
    let Some(expected) = equation.density(pressure, temperature) else {
        return Err(Some(format!(
            "not compared: {} covers no state at P = {pressure:.4}, T = {temperature:.4}",
            equation.spec().name
        )));
    };
    let phase = equation.phase(expected, temperature);
    if !phase.is_stable() {
        return Err(Some(format!(
            "not compared: by {} the state P = {pressure:.4}, T = {temperature:.4} is {}",
            equation.spec().name,
            phase.describe()
        )));
    }
    let averages = thermodynamics.finish(equilibrium.discarded).averages;
    let energy = averages.iter().find(|a| a.name == "potential_energy");
    let at =
        StatePoint { temperature, half_steps: thermodynamics.has_half_steps(), density: expected };
    let of_energy = equation.at(expected, temperature).potential_energy;
    let found = [(Some(&density), expected), (energy, of_energy)];
    let sound = found.into_iter().filter_map(|(average, reference)| {
        let average = average.filter(|a| a.doubt.is_none())?;
        let standard_error = average.estimate.standard_error;
        Some(entry(average, reference, standard_error, equation, at))
    });
    let remarks = lennard_literature::remark_for(model).into_iter().collect();
    Ok(Comparison { entries: sound.collect(), remarks })
}

/// A mean beside a value of an equation.
fn entry(
    average: &Average,
    reference: f64,
    standard_error: f64,
    equation: &dyn EquationOfState,
    at: StatePoint,
) -> lennard_io::Comparison {
    let difference = average.estimate.mean - reference;
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
