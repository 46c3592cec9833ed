//! Means of a run beside an equation of state: U and P at constant volume, density and U at constant pressure.

use lennard_observables::{
    Average, ChangingBox, Comparison, Estimate, Observable, StatePoint, Thermodynamics, statistics,
};

use crate::{EquationOfState, FiniteSize, FiniteSizeDoubt, Kept, ModelKind, remark_for};

/// Means beside values of an equation, and remarks that belong beside them.
pub type Compared = (Vec<Comparison>, Vec<String>);

/// A model and the equation that describes it.
pub type Described = (ModelKind, &'static dyn EquationOfState);

/// A value by an equation, as a closed box has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// The value, with what the closed box adds.
    pub value: f64,
    /// Its slope with temperature at constant density.
    pub slope: f64,
    /// What the closed box adds, where that is known well enough.
    pub finite_size: Option<f64>,
    /// What that may be off by, where it is doubted.
    pub finite_size_uncertainty: Option<f64>,
    /// What the equation itself may be off by, where that is known.
    pub own_uncertainty: Option<f64>,
}

impl Expected {
    /// The mean of a series from sample `cut` on, less the value. Its error is the error of the series
    /// X_b − [X_EOS(T̄) + (T_b − T̄)·∂X_EOS/∂T], which carries the correlation of X and T.
    #[must_use]
    pub fn difference(&self, series: &[f64], temperatures: &[f64], cut: usize) -> Estimate {
        let about = statistics::about_line(series, temperatures, self.slope, cut);
        Estimate { mean: about.mean - self.value, ..about }
    }
}

/// U and P of a closed box by an equation.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedBox {
    /// The temperature of the equation: the mean of the measured ones, ε/k_B.
    pub temperature: f64,
    /// Potential energy per particle, ε.
    pub potential_energy: Expected,
    /// Pressure, ε/σ³.
    pub pressure: Expected,
    /// What belongs beside a comparison.
    pub remarks: Vec<String>,
}

impl ClosedBox {
    /// Of `n` particles at a density and at the mean of the measured temperatures that belong to the positions. Their box
    /// `kept` a quantity, or `None` where no term of finite size applies.
    ///
    /// # Errors
    /// Why the equation says nothing.
    pub fn of(
        (model, equation): Described,
        density: f64,
        temperatures: &[f64],
        n: usize,
        kept: Option<Kept>,
    ) -> Result<Self, String> {
        if temperatures.len() < 2 {
            return Err("too few samples to compare with an equation of state".into());
        }
        let temperature = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
        equation
            .check(density, temperature)
            .map_err(|outside| format!("not compared: {outside}"))?;
        let state = equation.at(density, temperature);
        let shift = kept.and_then(|kept| FiniteSize::of(equation, density, temperature, n, kept));
        let doubt = shift.and_then(|shift| shift.doubt);
        let applies = doubt != Some(FiniteSizeDoubt::NotSmall);
        let own = equation.uncertainty(density, temperature);
        let (of_u, of_p) = (shift.map(|s| s.potential_energy), shift.map(|s| s.pressure));
        let (own_u, own_p) =
            (own.as_ref().map(|o| o.potential_energy), own.as_ref().map(|o| o.pressure));
        let both = [
            (state.potential_energy, state.du_dt, of_u, own_u),
            (state.pressure, state.dp_dt, of_p, own_p),
        ];
        let [potential_energy, pressure] = both.map(|(infinite, slope, term, own_uncertainty)| {
            let finite_size = term.filter(|_| applies);
            Expected {
                value: infinite + finite_size.unwrap_or(0.0),
                slope,
                finite_size,
                finite_size_uncertainty: term.filter(|_| doubt.is_some()).map(f64::abs),
                own_uncertainty,
            }
        });
        let closed = shift.filter(|_| applies).map(|shift| {
            format!(
                "the references are for {n} particles in a closed box: {:+.5} ε and {:+.5} ε/σ³ beside an infinite system",
                shift.potential_energy, shift.pressure
            )
        });
        let remarks = closed.into_iter().chain(remark_for(model)).collect();
        Ok(Self { temperature, potential_energy, pressure, remarks })
    }
}

/// U and P of a run beside an equation for its [`ClosedBox`]. Means count against which nothing speaks, in a stable state, so that
/// a difference is a finding. Its error is the error of [`Expected::difference`].
///
/// # Errors
/// Why nothing was compared; `None` where the averages say why.
pub fn at_constant_volume(
    described: Described,
    density: f64,
    n: usize,
    kept: Option<Kept>,
    thermodynamics: &Thermodynamics,
) -> Result<Compared, Option<String>> {
    let equilibrium = thermodynamics.equilibrium();
    if equilibrium.doubt.is_some() {
        return Err(None);
    }
    let (rows, cut) = (thermodynamics.series(), equilibrium.cut);
    let temperatures = &rows.temperature_of_positions;
    let closed = ClosedBox::of(described, density, &temperatures[cut..], n, kept).map_err(Some)?;
    let (temperature, equation) = (closed.temperature, described.1);
    if let Some(unstable) = equation.unstable(density, temperature) {
        return Err(Some(format!("not compared: {unstable}")));
    }
    let quantities = [
        ("potential_energy", closed.potential_energy, &rows.potential_energy),
        ("pressure", closed.pressure, &rows.pressure),
    ];
    let averages = thermodynamics.finish(equilibrium.discarded).averages;
    let at = StatePoint { temperature, half_steps: thermodynamics.has_half_steps(), density };
    let sound = quantities.into_iter().filter_map(|(name, expected, series)| {
        let error = expected.difference(series, temperatures, cut).standard_error;
        let average = averages.iter().find(|a| a.name == name && a.doubt.is_none())?;
        Some(Comparison {
            finite_size: expected.finite_size,
            finite_size_uncertainty: expected.finite_size_uncertainty,
            reference_uncertainty: expected.own_uncertainty,
            ..entry(average, expected.value, error, equation, at)
        })
    });
    Ok((sound.collect(), closed.remarks))
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
