//! Means of a run beside an equation of state: U and P at constant volume, density and U at constant pressure.

use lennard_observables::{
    Average, ChangingBox, Comparison, Observable, StatePoint, Thermodynamics,
};

use crate::{EquationOfState, FiniteSize, FiniteSizeDoubt, Kept, ModelKind, remark_for};

/// Means beside values of an equation, and remarks that belong beside them.
pub type Compared = (Vec<Comparison>, Vec<String>);

/// A model and the equation that describes it.
pub type Described = (ModelKind, &'static dyn EquationOfState);

/// U and P of `n` particles beside an equation, at a density and at the measured temperature that belongs to the positions
/// ([`Thermodynamics`]). Their box `kept` a quantity, or `None` where no term of finite size applies.
///
/// Where `results` are wanted, means count against which nothing speaks, in a stable state, so that a difference is a finding.
/// Otherwise whatever was averaged counts: short runs are compared with each other.
///
/// The error of each difference is the error of the series X_b − [X_EOS(T̄) + (T_b − T̄)·∂X_EOS/∂T],
/// which carries the correlation of X and T.
///
/// # Errors
/// Why nothing was compared; `None` where the averages say why.
pub fn at_constant_volume(
    (model, equation): Described,
    density: f64,
    n: usize,
    kept: Option<Kept>,
    thermodynamics: &Thermodynamics,
    results: bool,
) -> Result<Compared, Option<String>> {
    let equilibrium = thermodynamics.equilibrium();
    if results && equilibrium.doubt.is_some() {
        return Err(None);
    }
    let temperatures = &thermodynamics.series().temperature_of_positions[equilibrium.cut..];
    if temperatures.len() < 2 {
        return Err(Some("too few samples to compare with an equation of state".into()));
    }
    let temperature = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
    let outside = equation.check(density, temperature);
    outside.map_err(|outside| Some(format!("not compared: {outside}")))?;
    if results && let Some(unstable) = equation.unstable(density, temperature) {
        return Err(Some(format!("not compared: {unstable}")));
    }
    let state = equation.at(density, temperature);
    let shift = kept.and_then(|kept| FiniteSize::of(equation, density, temperature, n, kept));
    let own = equation.uncertainty(density, temperature);
    let averages = thermodynamics.finish(equilibrium.discarded).averages;
    let quantities = [
        (
            "potential_energy",
            state.potential_energy,
            shift.map(|f| f.potential_energy),
            thermodynamics.potential_energy_against(state.du_dt),
            own.as_ref().map(|u| u.potential_energy),
        ),
        (
            "pressure",
            state.pressure,
            shift.map(|f| f.pressure),
            thermodynamics.pressure_against(state.dp_dt),
            own.as_ref().map(|u| u.pressure),
        ),
    ];
    let doubt = shift.and_then(|f| f.doubt);
    let applies = doubt != Some(FiniteSizeDoubt::NotSmall);
    let at = StatePoint { temperature, half_steps: thermodynamics.has_half_steps(), density };
    let mut entries = Vec::new();
    for (name, infinite, term, against, reference_uncertainty) in quantities {
        let sound = |a: &&Average| a.name == name && (a.doubt.is_none() || !results);
        let Some(average) = averages.iter().find(sound) else {
            continue;
        };
        let finite_size = term.filter(|_| applies);
        let reference = infinite + finite_size.unwrap_or(0.0);
        entries.push(Comparison {
            finite_size,
            finite_size_uncertainty: term.filter(|_| doubt.is_some()).map(f64::abs),
            reference_uncertainty,
            ..entry(average, reference, against.standard_error, equation, at)
        });
    }
    let closed = shift.filter(|_| applies).map(|shift| {
        format!(
            "the references are for {n} particles in a closed box: {:+.5} ε and {:+.5} ε/σ³ beside an infinite system",
            shift.potential_energy, shift.pressure
        )
    });
    Ok((entries, closed.into_iter().chain(remark_for(model)).collect()))
}

/// Density and U of a run at constant pressure beside an equation at the pressure of the barostat.
///
/// Velocities without total momentum sample V^{N−1}: the mean of ρT + W/(3V) + P_tail is then P₀ + T/V, and the equation is
/// taken at that pressure. `missing` is the share of translations that the velocities lack, 1/N of free particles. The
/// temperature is the measured one that belongs to the positions.
///
/// # Errors
/// Why nothing was compared; `None` where the averages say why.
pub fn at_constant_pressure(
    (model, equation): Described,
    pressure: f64,
    missing: f64,
    thermodynamics: &Thermodynamics,
    changing: &ChangingBox,
) -> Result<Compared, Option<String>> {
    let equilibrium = thermodynamics.equilibrium();
    if equilibrium.doubt.is_some() {
        return Err(None);
    }
    let rows = &thermodynamics.series().temperature_of_positions[equilibrium.cut..];
    let temperature = rows.iter().sum::<f64>() / rows.len() as f64;
    let density = changing.density(equilibrium.discarded);
    let pressure = pressure + missing * density.estimate.mean * temperature;
    let name = &equation.spec().name;
    let Some(expected) = equation.density(pressure, temperature) else {
        return Err(Some(format!(
            "not compared: {name} covers no state at P = {pressure:.4}, T = {temperature:.4}"
        )));
    };
    let phase = equation.phase(expected, temperature);
    if !phase.is_stable() {
        return Err(Some(format!(
            "not compared: by {name} the state P = {pressure:.4}, T = {temperature:.4} is {}",
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
        Some(entry(average, reference, average.estimate.standard_error, equation, at))
    });
    Ok((sound.collect(), remark_for(model).into_iter().collect()))
}

/// A mean beside a value of an equation.
fn entry(
    average: &Average,
    reference: f64,
    standard_error: f64,
    equation: &dyn EquationOfState,
    at: StatePoint,
) -> Comparison {
    let difference = average.estimate.mean - reference;
    Comparison {
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
