//! `lennard list`: the methods that a scene can name.

use clap::ValueEnum;
use lennard_core::number::significant;
use lennard_io::TrajectoryFormat;
use lennard_literature::EquationOfState;
use lennard_literature::units::{SUBSTANCES, Units};
use lennard_observables::quantities::QUANTITIES;
use lennard_scene::{RemovedKind, removed};
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
        Listed::Barostats => each(lennard_integrators::barostats(), |s| Entry {
            properties: properties! {
                "thermostat beside it": s.thermostat.unwrap_or("any that is canonical"),
            },
            ..described([s.name, s.summary, s.equation, s.source])
        }),
        Listed::Exchanges => each(lennard_integrators::exchanges(), |s| {
            described([s.name, s.summary, s.equation, s.source])
        }),
        Listed::Potentials => each(lennard_forcefield::potentials(), |s| {
            described([s.name, s.summary, s.equation, s.source])
        }),
        Listed::Truncations => each(lennard_forcefield::truncations(), |s| {
            described([s.name, s.summary, s.equation, s.source])
        }),
        Listed::CombiningRules => each(lennard_forcefield::combining_rules(), |s| {
            described([s.name, s.summary, s.equation, s.source])
        }),
        Listed::Bonds => each(lennard_integrators::bond_methods(), |s| {
            described([s.name, s.summary, s.equations, s.source])
        }),
        Listed::Walls => each(lennard_forcefield::walls(), |s| {
            described([s.name, s.summary, s.equation, s.source])
        }),
        Listed::Contacts => each(lennard_integrators::contacts(), |s| {
            described([s.name, s.summary, s.equation, s.source])
        }),
        Listed::Observables => each(lennard_observables::observables(), |s| Entry {
            properties: properties! {
                "on several ranks": s.alone.map_or("yes".to_owned(), |why| format!("no: it {why}")),
            },
            ..described([s.name, s.summary, s.equation, s.source])
        }),
        Listed::Quantities => each(QUANTITIES, |q| Entry {
            properties: properties! { "unit": q.unit },
            ..without_equation([q.key, &q.name(), ""])
        }),
        Listed::Formats => formats(),
        Listed::EquationsOfState => equations_of_state(),
        Listed::ReferenceTables => reference_tables(),
        Listed::Substances => each(&SUBSTANCES, |s| {
            let one = |reduced: &str| {
                let (one, unit) = Units::of(s.name)?.one(reduced)?;
                Some((reduced.to_owned(), json!(format!("{} {unit}", significant(one, 6)))))
            };
            Entry {
                properties: ONE_OF_EACH.into_iter().filter_map(one).collect(),
                ..without_equation([s.name, &s.to_string(), s.source])
            }
        }),
    };
    if let Some(name) = &args.name {
        let known: Vec<String> = entries.iter().map(|e| e.name.clone()).collect();
        entries.retain(|entry| entry.name == *name);
        if entries.is_empty() {
            return Err(unknown(what, name, &known));
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
    answer(json, false, &json!({ "schema": schema, "entries": entries }), show)
}

/// What can be listed.
fn kinds(json: bool) -> Result<u8, Failure> {
    let kinds: Vec<_> =
        Listed::value_variants().iter().filter_map(ValueEnum::to_possible_value).collect();
    let kinds = each(&kinds, |kind| {
        let (name, help) = (kind.get_name(), kind.get_help().map(ToString::to_string));
        Entry {
            properties: properties! { "command": format!("lennard list {name}") },
            ..without_equation([name, &help.unwrap_or_default(), ""])
        }
    });
    told(json, &kinds, || {
        show::print(&show::list(&kinds), Style::Names);
        println!("\none of these: lennard list scenes");
    })
}

fn unknown(kind: Listed, name: &str, known: &[String]) -> Failure {
    let instead = match kind {
        Listed::Integrators => removed(RemovedKind::Method, &format!("integrator.{name}")),
        Listed::Observables => removed(RemovedKind::Observable, name),
        _ => None,
    };
    if let Some(instead) = instead {
        let message = format!("`{name}` was removed\n  allowed: {instead}");
        return Failure::new("reading a list", message, INPUT);
    }
    let nearest = lennard_scene::nearest(name, known.iter().map(String::as_str))
        .map_or_else(String::new, |nearest| format!("\n  nearest: {nearest}"));
    let message = format!(
        "nothing in the list has this name\n  found:   {name}\n  allowed: {}{nearest}",
        known.join(", ")
    );
    Failure::new("reading a list", message, INPUT)
}

fn scenes() -> Vec<Entry> {
    each(lennard_scene::shipped::scenes(), |scene| {
        let source = format!("lennard {} {}", scene.command(), scene.name);
        without_equation([scene.name, &scene.subject(), &source])
    })
}

/// The reduced units that `lennard list substances` tells the size of.
const ONE_OF_EACH: [&str; 9] = ["σ", "τ", "ε", "ε/k_B", "σ⁻³", "ε/σ³", "σ²/τ", "ετ/σ³", "k_B/(στ)"];

/// An entry for each item of a list.
fn each<S>(all: &[S], entry: impl Fn(&S) -> Entry) -> Vec<Entry> {
    all.iter().map(entry).collect()
}

/// An entry with a name, a summary, an equation and a source.
fn described([name, summary, equation, source]: [&str; 4]) -> Entry {
    Entry { equation: Some(equation.into()), ..without_equation([name, summary, source]) }
}

fn without_equation([name, summary, source]: [&str; 3]) -> Entry {
    Entry {
        name: name.into(),
        summary: summary.into(),
        equation: None,
        properties: serde_json::Map::new(),
        source: source.into(),
    }
}

/// The integrators, with the default first: what a scene should take unless it has a reason.
fn integrators() -> Vec<Entry> {
    let default = lennard_integrators::IntegratorOptions::default();
    let mut entries = each(lennard_integrators::integrators(), |entry| {
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
            ..described([s.name, s.summary, s.equations, s.source])
        }
    });
    entries.sort_by_key(|entry| entry.name != default.name());
    entries
}

fn formats() -> Vec<Entry> {
    each(TrajectoryFormat::ALL, |format| {
        let s = format.spec();
        Entry {
            properties: properties! {
                "file": s.file,
                "velocities and forces": s.holds_vectors,
                "rounds positions": s.limits.is_some(),
            },
            ..without_equation([format.name(), s.summary, s.readers])
        }
    })
}

fn reference_tables() -> Vec<Entry> {
    each(lennard_literature::reference_tables(), |table| {
        let doi = table.doi.map_or(String::new(), |doi| format!(", doi:{doi}"));
        Entry {
            properties: properties! {
                "status": table.status.describe(),
                "licence": table.licence,
            },
            ..without_equation([table.name, table.summary, &format!("{}{doi}", table.source)])
        }
    })
}

fn thermostats() -> Vec<Entry> {
    each(lennard_integrators::thermostats(), |s| Entry {
        properties: properties! { "samples the canonical ensemble": s.canonical },
        ..without_equation([s.name, s.summary, s.source])
    })
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
                properties: properties! {
                    "T": [s.range.t_min, s.range.t_max],
                    "largest p": s.range.p_max,
                    "largest ρ": s.range.rho_max,
                    "doi": s.doi,
                    "status": s.status,
                },
                ..without_equation([&s.key, &format!("{}: {}", s.name, s.model), &s.citation])
            }
        })
        .collect()
}
