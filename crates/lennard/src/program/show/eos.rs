//! Equations of state for people.

use lennard_literature::{EquationOfState, Property, freezing_lines_of};
use lennard_studies::eos::{self, Coexistence, Evaluated, Freezing};

use super::{note, table};
use crate::program::out;

/// One state by every equation that covers it.
pub fn state(evaluated: &[Evaluated], properties: &[&Property]) {
    println!("{}", table(&eos::single(evaluated, properties)));
    for one in evaluated {
        let name = &one.equation.spec().name;
        match &one.found {
            Ok(found) => println!(
                "  {name}: ρ = {:.6}, T = {}: {}",
                found.state.rho, one.temperature, found.phase
            ),
            Err(outside) => println!("  left out: {outside}"),
        }
        if let Some(why) = &one.equation.spec().superseded {
            println!("    {why}");
        }
    }
    println!(
        "  reduced units (ε = σ = m = k_B = 1), per particle; names for --properties: {}",
        names(properties)
    );
}

fn names(properties: &[&Property]) -> String {
    let names: Vec<&str> = properties.iter().map(|p| p.key).collect();
    names.join(", ")
}

/// Many states of one equation.
pub fn curve(evaluated: &[Evaluated], properties: &[&Property]) {
    let Some(first) = evaluated.first() else {
        return;
    };
    out::heading(first.equation.spec().citation());
    println!("{}", table(&eos::curve(evaluated, properties)));
}

/// Vapor and liquid side by side.
pub fn coexistence(equation: &dyn EquationOfState, rows: &[Coexistence]) {
    let shown = eos::coexistence(equation, rows);
    out::heading(equation.spec().citation());
    println!("  {}", shown.caption);
    println!("{}", table(&shown));
}

/// Liquid and crystal side by side.
pub fn freezing(equation: &dyn EquationOfState, rows: &[Freezing]) {
    let shown = eos::freezing(equation, rows);
    out::heading(format!("P of {}", equation.spec().citation()));
    println!("{}", table(&shown));
    note(&shown.caption);
    for line in freezing_lines_of(equation) {
        let doi = line.doi.as_ref();
        note(&format!(
            "{}: {}{} ({})",
            line.name,
            line.citation,
            doi.map_or(String::new(), |doi| format!(", doi:{doi}")),
            line.status
        ));
    }
}
