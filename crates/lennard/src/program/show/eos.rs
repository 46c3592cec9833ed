//! Equations of state for people.

use lennard_literature::units::Units;
use lennard_literature::{EquationOfState, Property, freezing_lines_of};
use lennard_studies::eos::{self, Coexistence, Evaluated, Freezing};
use lennard_studies::report::{Section, physical};

/// One state by every equation that covers it.
pub fn state(evaluated: &[Evaluated], properties: &[&Property], units: Option<&Units>) -> Section {
    let of_equation = |one: &Evaluated| {
        let spec = one.equation.spec();
        let said = match &one.found {
            Ok(found) => {
                let rho = found.state.rho;
                let in_units = units.map_or_else(String::new, |units| {
                    let temperature = physical(units, one.temperature, "ε/k_B");
                    format!(" ({}, {temperature})", physical(units, rho, "σ⁻³"))
                });
                let (name, t, phase) = (&spec.name, one.temperature, found.phase);
                format!("{name}: ρ = {rho:.6}, T = {t}{in_units}: {phase}")
            }
            Err(outside) => format!("left out: {outside}"),
        };
        [Some(said), spec.superseded.as_ref().map(|why| format!("  {why}"))]
    };
    let names: Vec<&str> = properties.iter().map(|p| p.key).collect();
    Section::new("")
        .table(eos::single(evaluated, properties))
        .texts(evaluated.iter().flat_map(of_equation).flatten())
        .text(format!(
            "reduced units (ε = σ = m = k_B = 1), per particle; names for --properties: {}",
            names.join(", ")
        ))
}

/// Many states of one equation.
pub fn curve(evaluated: &[Evaluated], properties: &[&Property]) -> Section {
    let citation = evaluated.first().map(|first| first.equation.spec().citation());
    let table = eos::curve(evaluated, properties);
    Section::new(citation.unwrap_or_default()).table(table)
}

/// Vapor and liquid side by side.
pub fn coexistence(equation: &dyn EquationOfState, rows: &[Coexistence]) -> Section {
    let shown = eos::coexistence(equation, rows);
    Section::new(equation.spec().citation()).text(&shown.caption).table(shown)
}

/// Liquid and crystal side by side.
pub fn freezing(equation: &dyn EquationOfState, rows: &[Freezing]) -> Section {
    let shown = eos::freezing(equation, rows);
    let caption = shown.caption.clone();
    let lines = freezing_lines_of(equation).into_iter().map(|line| {
        let doi = line.doi.as_ref().map_or(String::new(), |doi| format!(", doi:{doi}"));
        format!("{}: {}{doi} ({})", line.name, line.citation, line.status)
    });
    Section::new(format!("P of {}", equation.spec().citation()))
        .table(shown)
        .text(caption)
        .texts(lines)
}
