//! Equations of state at any state, without a run: properties, curves, and coexistence.

use lennard_literature::{
    EquationOfState, FluidState, FreezingLine, Phase, Property, Saturation, bisect,
    freezing_lines_of,
};
use lennard_observables::quantities::{quantity_name, quantity_unit};
use lennard_observables::{Cell, Table, Tone};
use serde::Serialize;
use serde_json::Value;

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
pub(crate) fn freezing_temperature(
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

/// Digits that a reader sees.
const DIGITS: usize = 6;

fn value(evaluated: &Evaluated, property: &Property) -> Cell {
    let found = evaluated.found.as_ref().ok();
    let cell = Cell::rounded(found.map(|f| (property.of)(&f.state)), DIGITS);
    match evaluated.equation.spec().superseded {
        Some(_) => cell.toned(Tone::Faint),
        None => cell,
    }
}

/// One state: a row for each property, a column for each equation that covers it.
#[must_use]
pub fn single(evaluated: &[Evaluated], properties: &[&Property]) -> Table {
    let mut table = Table::rows_of("state", properties)
        .column("Property", |p| quantity_name(p.key))
        .column("Unit", |p| quantity_unit(p.key));
    for one in evaluated.iter().filter(|e| e.found.is_ok()) {
        table = table.column(&one.equation.spec().name, |p| value(one, p));
    }
    table.table()
}

/// Many states of one equation: a row for each state, a column for each property.
#[must_use]
pub fn curve(evaluated: &[Evaluated], properties: &[&Property]) -> Table {
    let density = |e: &Evaluated| Some(e.found.as_ref().ok()?.state.rho);
    let mut table = Table::rows_of("curve", evaluated)
        .column("T [ε/k_B]", |e| Cell::rounded(e.temperature, DIGITS))
        .column("ρ [σ⁻³]", |e| Cell::rounded(density(e), DIGITS));
    for property in properties {
        let heading = match quantity_unit(property.key) {
            "" => property.key.to_owned(),
            unit => format!("{} [{unit}]", property.key),
        };
        table = table.column(&heading, |e| value(e, property));
    }
    let phase = |e: &Evaluated| match &e.found {
        Ok(found) => Cell::from(found.phase.describe()),
        Err(outside) => Cell::from(outside.as_str()),
    };
    table.column("phase", phase).table()
}

/// Vapor and liquid side by side, a row for each temperature.
#[must_use]
pub fn coexistence(equation: &dyn EquationOfState, rows: &[Coexistence]) -> Table {
    let critical = equation.spec().critical;
    let caption = format!(
        "{}: critical point T = {:.4}, ρ = {:.4}, P = {:.5}",
        equation.spec().name,
        critical.temperature,
        critical.density,
        equation.pressure(critical.density, critical.temperature)
    );
    let spinodal =
        |side: usize| move |c: &Coexistence| Cell::rounded(c.spinodal.map(|s| s[side]), DIGITS);
    Table::rows_of("coexistence", rows)
        .caption(caption)
        .column("T [ε/k_B]", |c| Cell::rounded(c.saturation.temperature, DIGITS))
        .column("P [ε/σ³]", |c| Cell::rounded(c.saturation.pressure, DIGITS))
        .column("ρ vapor [σ⁻³]", |c| Cell::rounded(c.saturation.vapor_density, DIGITS))
        .column("ρ liquid [σ⁻³]", |c| Cell::rounded(c.saturation.liquid_density, DIGITS))
        .column("heat of vaporization [ε]", |c| Cell::rounded(c.heat_of_vaporization, DIGITS))
        .column("spinodal, vapor [σ⁻³]", spinodal(0))
        .column("spinodal, liquid [σ⁻³]", spinodal(1))
        .table()
}

/// Liquid and crystal side by side, a row for each temperature and line.
#[must_use]
pub fn freezing(equation: &dyn EquationOfState, rows: &[Freezing]) -> Table {
    let triple = |line: &lennard_literature::FreezingLine| {
        let point = line.triple_point(equation)?;
        Some(format!(
            "{}: triple point T = {:.4}, P = {:.5}, ρ of the liquid {:.4}",
            line.name, point.temperature, point.pressure, point.liquid_density
        ))
    };
    let lines = freezing_lines_of(equation).into_iter();
    let triple: Vec<String> = lines.filter_map(triple).collect();
    Table::rows_of("freezing", rows)
        .caption(triple.join("; "))
        .column("T [ε/k_B]", |f| Cell::rounded(f.temperature, DIGITS))
        .column("P [ε/σ³]", |f| Cell::rounded(f.pressure, DIGITS))
        .column("ρ liquid [σ⁻³]", |f| Cell::rounded(f.liquid_density, DIGITS))
        .column("ρ crystal [σ⁻³]", |f| Cell::rounded(f.crystal_density, DIGITS))
        .column("line", |f| f.line)
        .table()
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
