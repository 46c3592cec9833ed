//! What equations of state give, for a reader.

use lennard_literature::{EquationOfState, Property, freezing_lines_of};
use lennard_observables::quantities::{quantity_name, quantity_unit};
use lennard_observables::{Cell, Table, Tone};

use super::{Coexistence, Evaluated, Freezing};

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
