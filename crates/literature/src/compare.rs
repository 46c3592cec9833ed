//! Comparing a run with an equation of state when temperature fluctuates too.

use crate::equation::EquationOfState;

/// What cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// There are no samples.
    #[error("there are no samples to compare")]
    Empty,
    /// The two series differ in length.
    #[error("one temperature for each value is needed: found {temperatures} and {values}")]
    Lengths {
        /// How many temperatures there are.
        temperatures: usize,
        /// How many values there are.
        values: usize,
    },
}

/// A property that can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Property {
    /// Potential energy per particle, ε.
    PotentialEnergy,
    /// Pressure, ε/σ³.
    Pressure,
}

/// A run's property beside the reference, sample by sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Differences {
    /// The mean temperature at which the reference was taken, ε/k_B.
    pub temperature: f64,
    /// The reference X_EOS(ρ, T̄).
    pub reference: f64,
    /// Its slope ∂X_EOS/∂T at constant density.
    pub slope: f64,
    /// X_i − [X_EOS(T̄) + (T_i − T̄)·∂X_EOS/∂T], one a sample.
    pub series: Vec<f64>,
}

/// The differences between the samples of a run and an equation of state at the run's mean
/// temperature, with the part that follows from the fluctuation of the temperature taken out:
/// X_i − [X_EOS(T̄) + (T_i − T̄)·∂X_EOS/∂T].
///
/// Their mean is X̄ − X_EOS(T̄); their standard error (to be taken with correlation in time, as for
/// any series) is that of this difference, the correlation of T and X included. The error of X̄
/// alone leaves out that of T̄: at constant energy U and T move against each other, and honest runs
/// would look wrong.
///
/// `temperatures` in ε/k_B and `values` in the units of the property, `[samples]` each, without the
/// equilibration part; `rho` in σ⁻³.
///
/// # Errors
/// [`CompareError`] where there are no samples or the two series differ in length.
pub fn differences(
    equation: &dyn EquationOfState,
    property: Property,
    rho: f64,
    temperatures: &[f64],
    values: &[f64],
) -> Result<Differences, CompareError> {
    if temperatures.len() != values.len() {
        return Err(CompareError::Lengths {
            temperatures: temperatures.len(),
            values: values.len(),
        });
    }
    if values.is_empty() {
        return Err(CompareError::Empty);
    }
    let temperature = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
    let state = equation.at(rho, temperature);
    let (reference, slope) = match property {
        Property::PotentialEnergy => (state.potential_energy, state.du_dt),
        Property::Pressure => (state.pressure, state.dp_dt),
    };
    let series = temperatures
        .iter()
        .zip(values)
        .map(|(t, x)| x - (reference + (t - temperature) * slope))
        .collect();
    Ok(Differences {
        temperature,
        reference,
        slope,
        series,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thol_2016;

    #[test]
    fn samples_on_the_tangent_of_the_equation_differ_by_their_offset_alone() {
        let equation = thol_2016();
        let (rho, mean, offset) = (0.8, 1.0, 0.01);
        let at = equation.at(rho, mean);
        let temperatures = [0.98, 1.0, 1.02];
        for (property, value, slope) in [
            (Property::PotentialEnergy, at.potential_energy, at.du_dt),
            (Property::Pressure, at.pressure, at.dp_dt),
        ] {
            let values = temperatures.map(|t| value + slope * (t - mean) + offset);
            let found = differences(equation, property, rho, &temperatures, &values).unwrap();
            assert!((found.temperature - mean).abs() < 1e-15);
            for d in found.series {
                // Roundings of numbers of order ten.
                assert!((d - offset).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn series_that_do_not_belong_together_are_refused() {
        let compare = |t: &[f64], x: &[f64]| {
            differences(thol_2016(), Property::Pressure, 0.8, t, x).unwrap_err()
        };
        assert_eq!(compare(&[], &[]), CompareError::Empty);
        assert_eq!(
            compare(&[1.0], &[]),
            CompareError::Lengths {
                temperatures: 1,
                values: 0
            }
        );
    }
}
