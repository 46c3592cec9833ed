//! Equations of state at any state, without a run: properties, curves, and coexistence.

mod tables;

use lennard_literature::{
    EquationOfState, FluidState, FreezingLine, Phase, Property, Saturation, bisect,
    freezing_lines_of,
};
use serde::Serialize;
use serde_json::Value;

pub use tables::{coexistence, curve, freezing, single};

/// Name and version of the schema of every document about equations of state.
pub const SCHEMA: &str = lennard_io::schema!("eos", 2);

/// By what a state is given besides its temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Given {
    /// The number density, σ⁻³.
    Density(f64),
    /// The pressure, ε/σ³: the state is the stable fluid there.
    Pressure(f64),
}

/// One equation at one state.
#[derive(Debug, Clone)]
pub struct Evaluated {
    /// Which equation.
    pub equation: &'static dyn EquationOfState,
    /// The temperature asked for, ε/k_B.
    pub temperature: f64,
    /// What else was asked for.
    pub given: Given,
    /// All that follows, or why the equation gives nothing there.
    pub found: Result<Found, String>,
}

/// A state by an equation.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    /// Properties follow from it.
    pub state: FluidState,
    /// Where it lies.
    pub phase: Phase,
}

/// Evaluates one equation at one state.
#[must_use]
pub fn evaluate(
    equation: &'static dyn EquationOfState,
    temperature: f64,
    given: Given,
) -> Evaluated {
    let density = match given {
        Given::Density(density) => Ok(density),
        Given::Pressure(pressure) if !(pressure.is_finite() && pressure > 0.0) => {
            Err(format!("the pressure must be a finite positive number, found {pressure}"))
        }
        Given::Pressure(pressure) => equation
            .density(pressure, temperature)
            // Any density tells whether it is the temperature that lies outside.
            .ok_or_else(|| match equation.check(1e-6, temperature) {
                Err(outside) => outside.to_string(),
                Ok(()) => format!(
                    "{} covers no fluid at pressure {pressure} and temperature {temperature}",
                    equation.spec().name
                ),
            }),
    };
    let found = density.and_then(|density| {
        equation.check(density, temperature).map_err(|outside| outside.to_string())?;
        Ok(Found {
            state: equation.at(density, temperature),
            phase: equation.phase(density, temperature),
        })
    });
    Evaluated { equation, temperature, given, found }
}

/// A vapor and a liquid side by side, with what they differ by.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coexistence {
    /// Temperature, pressure and densities.
    #[serde(flatten)]
    pub saturation: Saturation,
    /// Heat of vaporization, h_vapor − h_liquid, ε per particle.
    pub heat_of_vaporization: f64,
    /// Densities at which the vapor and the liquid become unstable, σ⁻³; absent where they were not found.
    pub spinodal: Option<[f64; 2]>,
}

/// Coexistence at a temperature; `None` at the critical temperature and above, and where none is found.
#[must_use]
pub fn coexistence_at(equation: &dyn EquationOfState, temperature: f64) -> Option<Coexistence> {
    let saturation = equation.saturation(temperature)?;
    let enthalpy = |rho: f64| {
        let s = equation.at(rho, temperature);
        s.potential_energy + s.pressure / rho
    };
    let heat = enthalpy(saturation.vapor_density) - enthalpy(saturation.liquid_density);
    Some(Coexistence {
        saturation,
        heat_of_vaporization: heat,
        spinodal: equation.spinodal(temperature),
    })
}

/// A liquid and a crystal side by side.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Freezing {
    /// Whose line of densities it is.
    pub line: &'static str,
    /// Temperature, ε/k_B.
    pub temperature: f64,
    /// Pressure of the equation at the density of the liquid, ε/σ³; absent where the equation does not cover it.
    pub pressure: Option<f64>,
    /// Density of the freezing liquid, σ⁻³.
    pub liquid_density: f64,
    /// Density of the melting crystal, σ⁻³.
    pub crystal_density: f64,
}

/// Freezing at a temperature by every line that the model of an equation has; nothing below the triple points, and for models without a line.
#[must_use]
pub fn freezing_at(equation: &dyn EquationOfState, temperature: f64) -> Vec<Freezing> {
    let on_line = |line: &'static FreezingLine| {
        let liquid = line.freezing_density(temperature)?;
        let is_covered = equation.check(liquid, temperature).is_ok();
        Some(Freezing {
            line: &line.name,
            temperature,
            pressure: is_covered.then(|| equation.pressure(liquid, temperature)),
            liquid_density: liquid,
            crystal_density: line.melting_density(temperature)?,
        })
    };
    let lines = freezing_lines_of(equation).into_iter();
    lines.filter_map(on_line).collect()
}

/// The temperature at which the liquid of a freezing line has a pressure (ε/σ³) by an equation; `None` outside the line and the equation.
#[must_use]
pub fn freezing_temperature(
    equation: &dyn EquationOfState,
    line: &FreezingLine,
    pressure: f64,
) -> Option<f64> {
    /// Halvings of the range of temperatures: to rounding. The pressure of a liquid is steep, and small near the triple point.
    const HALVINGS: usize = 50;
    /// The highest temperature that is looked at, ε/k_B.
    const HOTTEST: f64 = 5.0;
    /// Part of the pressure by which it may be missed.
    const ON_THE_LINE: f64 = 1e-6;
    if !equation.has_freezing_line() {
        return None;
    }
    let excess = |t: f64| {
        let liquid = line.freezing_density(t)?;
        equation.check(liquid, t).ok()?;
        Some(equation.pressure(liquid, t) - pressure)
    };
    let is_below = |t: f64| excess(t).is_some_and(|x| x < 0.0);
    if !is_below(line.t_triple) {
        return None;
    }
    let [low, _] = bisect(line.t_triple, HOTTEST, HALVINGS, is_below);
    // Where the equation ends before the line has the pressure, the bisection ends at the last state that it covers.
    (excess(low)?.abs() < ON_THE_LINE * pressure).then_some(low)
}

/// Freezing by one equation as JSON.
#[must_use]
pub fn freezing_json(equation: &dyn EquationOfState, rows: &[Freezing]) -> Value {
    let spec = equation.spec();
    let triple_points: Vec<Value> = freezing_lines_of(equation)
        .into_iter()
        .filter_map(|line| {
            let point = line.triple_point(equation)?;
            Some(serde_json::json!({
                "line": line.name,
                "source": line.citation,
                "doi": line.doi,
                "status": line.status,
                "temperature": point.temperature,
                "pressure": point.pressure,
                "liquid_density": point.liquid_density,
                "vapor_density": point.vapor_density,
            }))
        })
        .collect();
    serde_json::json!({
        "equation": spec.key,
        "source": spec.citation(),
        "critical_point": spec.critical,
        "triple_points": triple_points,
        "freezing": rows,
    })
}

/// Evaluated states as one JSON document.
#[must_use]
pub fn states_json(evaluated: &[Evaluated], properties: &[&Property]) -> Value {
    let states: Vec<Value> = evaluated
        .iter()
        .map(|e| {
            let spec = e.equation.spec();
            let mut state = serde_json::json!({
                "equation": spec.key,
                "source": spec.citation(),
                "judges": spec.superseded.is_none(),
                "temperature": e.temperature,
            });
            match &e.found {
                Ok(found) => {
                    state["density"] = found.state.rho.into();
                    state["phase"] = serde_json::to_value(found.phase).unwrap_or_default();
                    let all =
                        properties.iter().map(|p| (p.key.to_owned(), (p.of)(&found.state).into()));
                    state["properties"] = Value::Object(all.collect());
                }
                Err(outside) => state["outside"] = outside.as_str().into(),
            }
            state
        })
        .collect();
    serde_json::json!({ "schema": SCHEMA, "states": states })
}

/// Coexistence by one equation as JSON.
#[must_use]
pub fn coexistence_json(equation: &dyn EquationOfState, rows: &[Coexistence]) -> Value {
    let spec = equation.spec();
    serde_json::json!({
        "equation": spec.key,
        "source": spec.citation(),
        "critical_point": spec.critical,
        "coexistence": rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_literature::{freezing_lines, thol_2015, thol_2016};

    #[test]
    fn a_freezing_line_has_a_temperature_for_each_pressure_that_the_equation_covers() {
        let [line, older] = freezing_lines();
        for (t, rows) in [(0.8, 2), (1.0, 2), (1.5, 2)] {
            let found = freezing_at(thol_2016(), t);
            assert_eq!(found.len(), rows);
            for (line, row) in [line, older].into_iter().zip(&found) {
                let pressure = row.pressure.unwrap();
                let back = freezing_temperature(thol_2016(), line, pressure).unwrap();
                assert!((back - t).abs() < 1e-6, "{back} {t}");
            }
        }
        // Near the triple point the pressure is a hundredth of its change over a degree: no bisection may end early.
        for t in [0.6941, 0.6945, 0.695, 0.696, 0.698] {
            let row = freezing_at(thol_2016(), t)[0];
            let pressure = row.pressure.unwrap();
            assert!(pressure < 0.1, "{row:?}");
            let back = freezing_temperature(thol_2016(), line, pressure).unwrap();
            assert!((back - t).abs() < 1e-9, "{back} {t}");
        }
        // Below the triple point, beyond the equation, and for another model there is none.
        assert_eq!(freezing_temperature(thol_2016(), line, 1e-4), None);
        assert_eq!(freezing_temperature(thol_2016(), line, 1e4), None);
        assert_eq!(freezing_temperature(thol_2015(), line, 4.0), None);
    }
}
