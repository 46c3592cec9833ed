//! `lennard list`: the methods that a scene can name.

use clap::ValueEnum;
use lennard_io::TrajectoryFormat;
use lennard_literature::EquationOfState;
use serde_json::json;

use crate::program::args::{ListArgs, Listed};
use crate::program::commands::answer;
use crate::program::failure::{Failure, INPUT};
use crate::program::list_entry::Entry;
use crate::program::show::{self, Style};

/// A JSON object of properties.
macro_rules! properties {
    ($($key:literal: $value:expr),* $(,)?) => {
        [$(($key.to_owned(), json!($value))),*].into_iter().collect()
    };
}

/// Prints a list.
pub fn list(args: &ListArgs) -> Result<u8, Failure> {
    let Some(what) = args.what else {
        return kinds(args.json);
    };
    let mut entries = match what {
        Listed::Scenes => scenes(),
        Listed::Integrators => integrators(),
        Listed::Thermostats => thermostats(),
        Listed::Barostats => lennard_integrators::barostats()
            .iter()
            .map(|s| Entry {
                properties: properties! {
                    "thermostat beside it": s.thermostat.unwrap_or("any that is canonical"),
                },
                ..plain(s.name, s.summary, s.equation, s.source)
            })
            .collect(),
        Listed::Exchanges => lennard_integrators::exchanges()
            .iter()
            .map(|s| plain(s.name, s.summary, s.equation, s.source))
            .collect(),
        Listed::Potentials => lennard_forcefield::potentials()
            .iter()
            .map(|s| plain(s.name, s.summary, s.equation, s.source))
            .collect(),
        Listed::Truncations => lennard_forcefield::truncations()
            .iter()
            .map(|s| plain(s.name, s.summary, s.equation, s.source))
            .collect(),
        Listed::CombiningRules => lennard_forcefield::combining_rules()
            .iter()
            .map(|s| plain(s.name, s.summary, s.equation, s.source))
            .collect(),
        Listed::Bonds => lennard_integrators::bond_methods()
            .iter()
            .map(|s| plain(s.name, s.summary, s.equations, s.source))
            .collect(),
        Listed::Walls => lennard_forcefield::walls()
            .iter()
            .map(|s| plain(s.name, s.summary, s.equation, s.source))
            .collect(),
        Listed::Contacts => lennard_contacts::contacts()
            .iter()
            .map(|s| plain(s.name, s.summary, s.equation, s.source))
            .collect(),
        Listed::Observables => lennard_observables::observables()
            .iter()
            .map(|s| plain(s.name, s.summary, s.equation, s.source))
            .collect(),
        Listed::Formats => formats(),
        Listed::EquationsOfState => equations_of_state(),
        Listed::ReferenceTables => reference_tables(),
    };
    if let Some(name) = &args.name {
        let known: Vec<String> = entries.iter().map(|e| e.name.clone()).collect();
        entries.retain(|entry| entry.name == *name);
        if entries.is_empty() {
            return Err(unknown(name, &known));
        }
    }
    told(args.json, &entries, || match args.verbose || args.name.is_some() {
        true => entries.iter().for_each(|e| show::print(&show::entry(e), Style::Ruled)),
        false => show::print(&show::list(&entries), Style::Names),
    })
}

/// Prints entries as JSON, or as `show` does.
fn told(json: bool, entries: &[Entry], show: impl FnOnce()) -> Result<u8, Failure> {
    let schema = lennard_io::schema!("list", 1);
    answer(json, &json!({ "schema": schema, "entries": entries }), show)
}

/// What can be listed.
fn kinds(json: bool) -> Result<u8, Failure> {
    let kinds: Vec<Entry> = Listed::value_variants()
        .iter()
        .filter_map(ValueEnum::to_possible_value)
        .map(|kind| Entry {
            name: kind.get_name().into(),
            summary: kind.get_help().map(ToString::to_string).unwrap_or_default(),
            equation: None,
            properties: properties! {
                "command": format!("lennard list {}", kind.get_name()),
            },
            source: String::new(),
        })
        .collect();
    told(json, &kinds, || {
        show::print(&show::list(&kinds), Style::Names);
        println!("\none of these: lennard list scenes");
    })
}

fn unknown(name: &str, known: &[String]) -> Failure {
    let nearest = lennard_scene::nearest(name, known.iter().map(String::as_str))
        .map_or_else(String::new, |nearest| format!("\n  nearest: {nearest}"));
    let message = format!(
        "nothing in the list has this name\n  found:   {name}\n  allowed: {}{nearest}",
        known.join(", ")
    );
    Failure::new("reading a list", message, INPUT)
}

fn scenes() -> Vec<Entry> {
    lennard_scene::shipped::scenes()
        .iter()
        .map(|scene| Entry {
            name: scene.name.into(),
            summary: scene.subject(),
            equation: None,
            properties: serde_json::Map::new(),
            source: format!(
                "lennard {} {}",
                if scene.is_sweep() { "sweep" } else { "run" },
                scene.name
            ),
        })
        .collect()
}

fn plain(name: &str, summary: &str, equation: &str, source: &str) -> Entry {
    Entry {
        name: name.into(),
        summary: summary.into(),
        equation: Some(equation.into()),
        properties: serde_json::Map::new(),
        source: source.into(),
    }
}

fn integrators() -> Vec<Entry> {
    lennard_integrators::integrators()
        .iter()
        .map(|entry| {
            let s = entry.spec;
            Entry {
                properties: properties! {
                    "order of positions": s.position_order,
                    "order of velocities": s.velocity_order,
                    "symplectic": s.symplectic,
                    "reversible": s.reversible,
                    "fixed step only": s.fixed_step_only,
                    "half kicks: has a temperature of half steps": s.half_kicks,
                    "force evaluations per step": s.force_evaluations,
                    "largest stable ωh": s.stability_limit,
                },
                ..plain(s.name, s.summary, s.equations, s.source)
            }
        })
        .collect()
}

fn formats() -> Vec<Entry> {
    TrajectoryFormat::ALL
        .iter()
        .map(|format| {
            let s = format.spec();
            Entry {
                name: format.name().into(),
                summary: s.summary.into(),
                equation: None,
                properties: properties! {
                    "file": s.file,
                    "velocities and forces": s.holds_vectors,
                    "rounds positions": s.limits.is_some(),
                },
                source: s.readers.into(),
            }
        })
        .collect()
}

fn reference_tables() -> Vec<Entry> {
    lennard_literature::reference_tables()
        .iter()
        .map(|table| {
            let doi = table.doi.map_or(String::new(), |doi| format!(", doi:{doi}"));
            Entry {
                name: table.name.into(),
                summary: table.summary.into(),
                equation: None,
                properties: properties! {
                    "status": table.status.describe(),
                    "licence": table.licence,
                },
                source: format!("{}{doi}", table.source),
            }
        })
        .collect()
}

fn thermostats() -> Vec<Entry> {
    lennard_integrators::thermostats()
        .iter()
        .map(|s| Entry {
            name: s.name.into(),
            summary: s.summary.into(),
            equation: None,
            properties: properties! { "samples the canonical ensemble": s.canonical },
            source: s.source.into(),
        })
        .collect()
}

/// The bond length for which two-center equations are listed, σ; scenes may have any from 0.1 to 1 σ.
const EXAMPLE_BOND: f64 = 0.67;

fn equations_of_state() -> Vec<Entry> {
    // Two-center equations depend on the length of the bond: one length stands for all.
    let two_center = lennard_literature::two_center(EXAMPLE_BOND).into_iter().flatten();
    let two_center = two_center.map(|equation| equation as &dyn EquationOfState);
    lennard_literature::list()
        .into_iter()
        .chain(two_center)
        .map(|equation| {
            let s = equation.spec();
            Entry {
                name: s.key.clone(),
                summary: format!("{}: {}", s.name, s.model),
                equation: None,
                properties: properties! {
                    "T": [s.range.t_min, s.range.t_max],
                    "largest p": s.range.p_max,
                    "largest ρ": s.range.rho_max,
                    "doi": s.doi,
                    "status": s.status,
                },
                source: s.citation.clone(),
            }
        })
        .collect()
}
