//! `lennard eos`: any property of any equation of state at any state, without a run.

use lennard_literature::units::{SUBSTANCES, Units};
use lennard_literature::{
    BOND_LENGTHS, EquationOfState, Mie, ModelKind, PROPERTIES, Property, equations_for,
    freezing_lines_of, list, pohl_2023, property, two_center, virial_series,
};
use lennard_studies::eos::{self, Coexistence, Evaluated, Freezing, Given};
use lennard_studies::report::{Section, in_units, physical};
use serde_json::{Value, json};

use crate::program::args::{EosArgs, Values};
use crate::program::commands::answer;
use crate::program::failure::{Failure, INPUT};
use crate::program::show::{self, Style};

type Equation = &'static dyn EquationOfState;

/// The columns of a curve where none are named.
const OF_A_CURVE: [&str; 5] =
    ["pressure", "potential_energy", "heat_capacity", "heat_capacity_pressure", "speed_of_sound"];

/// Temperatures of a coexistence table where none are named, in parts of the critical one.
const LOWEST_OF_CRITICAL: f64 = 0.5;
const TEMPERATURE_STEPS: u32 = 16;
/// Temperatures of freezing where none are named: up to this many critical ones.
const HIGHEST_OF_CRITICAL: f64 = 2.0;

/// Prints states, curves, coexistence, or freezing.
pub fn eos(args: &EosArgs) -> Result<u8, Failure> {
    let equations = equations(args)?;
    let chosen = properties(&args.properties)?;
    let units = args.substance.as_deref().map(units_of).transpose()?;
    let units = units.as_ref();
    let temperatures = reduced("temperature", args.temperature.as_ref(), units, "ε/k_B")?;
    // A temperature alone asks for what stands side by side there.
    let given = args.density.as_ref().or(args.pressure.as_ref());
    let alone = temperatures.is_some() && given.is_none() && chosen.is_none();
    if args.saturation || alone && !args.freezing {
        let of = |equation| saturation(equation, temperatures.as_ref());
        let nothing = match args.saturation {
            true => "nothing coexists there",
            false => {
                "a state needs --density VALUES or --pressure VALUES too, and nothing coexists there"
            }
        };
        return two_phases(args, &equations, units, of, nothing, limit_of_saturation);
    }
    if args.freezing {
        let of = |equation| freezing(equation, temperatures.as_ref());
        let nothing = "nothing freezes there";
        return two_phases(args, &equations, units, of, nothing, limit_of_freezing);
    }
    let Some(temperatures) = temperatures else {
        return Err(refused(
            "a state needs a temperature: --temperature VALUES, or --saturation or --freezing for two phases",
        ));
    };
    let densities = reduced("density", args.density.as_ref(), units, "σ⁻³")?;
    let pressures = reduced("pressure", args.pressure.as_ref(), units, "ε/σ³")?;
    let given: Vec<Given> = match (densities, pressures) {
        (Some(densities), _) => densities.into_iter().map(Given::Density).collect(),
        (_, Some(pressures)) => pressures.into_iter().map(Given::Pressure).collect(),
        (None, None) => {
            return Err(refused(
                "a state needs a density or a pressure: --density VALUES or --pressure VALUES",
            ));
        }
    };
    let states: Vec<(f64, Given)> =
        temperatures.iter().flat_map(|t| given.iter().map(move |g| (*t, *g))).collect();
    let evaluated = |equation: Equation| -> Vec<Evaluated> {
        let one = |(t, given): &(f64, Given)| eos::evaluate(equation, *t, *given);
        states.iter().map(one).collect()
    };
    let all: Vec<Vec<Evaluated>> = equations.iter().map(|e| evaluated(*e)).collect();
    // One state that is asked of equations by name is refused where none of them covers it.
    if let Some(nothing) = covered_by_none(&all) {
        return Err(refused(nothing));
    }
    let curve = states.len() > 1;
    let properties: Vec<&Property> = match chosen {
        Some(chosen) => chosen,
        None if curve => OF_A_CURVE.iter().filter_map(|key| property(key)).collect(),
        None => PROPERTIES.iter().collect(),
    };
    let json = eos::states_json(&all.concat(), &properties);
    let curves: Vec<Section> = all.iter().map(|one| shown_curve(one, &properties)).collect();
    match curve {
        true => told(args.json, units, json, &curves, &curves),
        false => {
            let state = shown_state(&all.concat(), &properties, units);
            told(args.json, units, json, &curves, &[state])
        }
    }
}

/// Prints sections, or a document with the tables in units of a substance where there is one.
fn told(
    as_json: bool,
    units: Option<&Units>,
    mut json: Value,
    tables: &[Section],
    shown: &[Section],
) -> Result<u8, Failure> {
    if let Some(units) = units {
        let tables = tables.iter().flat_map(Section::tables);
        let physical: Vec<_> = tables.map(|table| in_units(table.clone(), units)).collect();
        json["units"] = json!(units);
        json["physical"] = json!(physical);
    }
    answer(as_json, false, &json, || {
        for section in shown {
            show::print(&section.clone().in_both(units), Style::Open);
        }
    })
}

/// The units of a substance by its name.
fn units_of(name: &str) -> Result<Units, Failure> {
    let known: Vec<String> = SUBSTANCES.iter().map(|s| s.name.to_owned()).collect();
    Units::of(name).ok_or_else(|| match lennard_scene::why_no_substance(name) {
        Some(why) => refused(format!(
            "the substance cannot be `{name}`: {why}\n  allowed: {}",
            known.join(", ")
        )),
        None => unknown("substance", name, &known),
    })
}

/// Numbers as typed for an option, in a reduced unit.
fn reduced(
    option: &str,
    typed: Option<&Values>,
    units: Option<&Units>,
    reduced: &str,
) -> Result<Option<Vec<f64>>, Failure> {
    let Some(Values { numbers, unit }) = typed.filter(|typed| !typed.unit.is_empty()) else {
        return Ok(typed.map(|typed| typed.numbers.clone()));
    };
    let each = numbers.iter().map(|number| Units::reduce(units, *number, unit, reduced));
    let found = each.collect::<Result<_, _>>().map_err(|error| {
        let (allowed, nearest) = lennard_scene::unit_in_words(unit, reduced, &error);
        let nearest = nearest.map_or(String::new(), |nearest| format!("\n  nearest: {nearest}"));
        refused(format!(
            "`--{option}` {error}\n  found:   {} {unit}\n  allowed: {allowed}{nearest}",
            numbers[0]
        ))
    });
    found.map(Some)
}

/// What an equation has of two phases: its document and its table; nothing where it has none.
type OfTwo = Option<(Value, Section)>;

/// Prints two phases side by side. Where no equation has them, `limit` says of each why not.
fn two_phases(
    args: &EosArgs,
    equations: &[Equation],
    units: Option<&Units>,
    of: impl Fn(Equation) -> OfTwo,
    nothing: &str,
    limit: fn(Equation) -> String,
) -> Result<u8, Failure> {
    let (all, shown): (Vec<Value>, Vec<Section>) = equations.iter().filter_map(|e| of(*e)).unzip();
    if all.is_empty() {
        let limits: Vec<String> = equations.iter().map(|e| limit(*e)).collect();
        return Err(refused(format!("{nothing}: {}", limits.join("; "))));
    }
    told(args.json, units, json!({ "schema": eos::SCHEMA, "equations": all }), &shown, &shown)
}

/// Vapor and liquid by an equation, by default from half the critical temperature on.
fn saturation(equation: Equation, named: Option<&Vec<f64>>) -> OfTwo {
    let spec = equation.spec();
    let critical = spec.critical.temperature;
    let usual = || {
        let mut all = evenly(spec.range.t_min.max(LOWEST_OF_CRITICAL * critical), critical);
        all.pop();
        all
    };
    let temperatures = named.cloned().unwrap_or_else(usual).into_iter();
    let covered = temperatures.filter(|t| *t >= spec.range.t_min);
    let rows: Vec<_> = covered.filter_map(|t| eos::coexistence_at(equation, t)).collect();
    let found = || (eos::coexistence_json(equation, &rows), shown_coexistence(equation, &rows));
    (!rows.is_empty()).then(found)
}

fn limit_of_saturation(equation: Equation) -> String {
    let spec = equation.spec();
    let (name, range, critical) = (&spec.name, &spec.range, spec.critical.temperature);
    match range.rho_max {
        Some(_) => format!("{name} is for a gas alone"),
        None => format!("{name} has vapor and liquid from T = {} to {critical:.4}", range.t_min),
    }
}

/// Liquid and crystal by an equation with freezing lines.
fn freezing(equation: Equation, named: Option<&Vec<f64>>) -> OfTwo {
    let spec = equation.spec();
    let lines = freezing_lines_of(equation);
    let lowest = lines.iter().map(|line| line.t_triple).reduce(f64::max)?;
    let highest = (HIGHEST_OF_CRITICAL * spec.critical.temperature).min(spec.range.t_max);
    let temperatures = named.cloned().unwrap_or_else(|| evenly(lowest, highest));
    let rows: Vec<_> = temperatures.iter().flat_map(|t| eos::freezing_at(equation, *t)).collect();
    let found = || (eos::freezing_json(equation, &rows), shown_freezing(equation, &rows));
    (!rows.is_empty()).then(found)
}

fn limit_of_freezing(equation: Equation) -> String {
    let name = &equation.spec().name;
    let lines = freezing_lines_of(equation);
    match lines.iter().map(|line| line.t_triple).reduce(f64::min) {
        Some(t) => format!("the lines beside {name} begin at the triple point, T = {t}"),
        None => format!("no freezing line is known for the model of {name}"),
    }
}

/// Temperatures from one to another, ends included.
fn evenly(from: f64, to: f64) -> Vec<f64> {
    let part = |i| f64::from(i) / f64::from(TEMPERATURE_STEPS);
    (0..=TEMPERATURE_STEPS).map(|i| from + part(i) * (to - from)).collect()
}

/// Why a single state is nothing; `None` where one of the equations covers one of the states.
fn covered_by_none(all: &[Vec<Evaluated>]) -> Option<String> {
    let reasons: Vec<&str> = all
        .iter()
        .flatten()
        .map(|e| e.found.as_ref().err().map(String::as_str))
        .collect::<Option<_>>()?;
    let mut distinct = reasons;
    distinct.dedup();
    distinct.truncate(6);
    Some(distinct.join("\n  "))
}

fn refused(message: impl std::fmt::Display) -> Failure {
    Failure::new("evaluating an equation of state", message, INPUT)
}

/// The equations that are asked for.
fn equations(args: &EosArgs) -> Result<Vec<Equation>, Failure> {
    let [repulsive, attractive] = args.exponents[..] else {
        return Err(refused("a Mie potential has two exponents: --exponents 14,6"));
    };
    let potential = Mie { repulsive, attractive };
    if !(attractive > 3.0 && repulsive > attractive && repulsive <= 100.0) {
        return Err(refused(format!(
            "exponents must be above 3, the first the larger and at most 100, found {repulsive} and {attractive}"
        )));
    }
    if args.equations.is_empty() {
        let r_cut = f64::INFINITY;
        let model = if potential == Mie::LENNARD_JONES {
            ModelKind::CutWithTail { r_cut }
        } else {
            ModelKind::Mie { repulsive, attractive, r_cut }
        };
        return Ok(equations_for(model));
    }
    let pairs = two_center(args.bond);
    let two_center_keys = two_center(*BOND_LENGTHS.start()).into_iter().flatten();
    let mut known: Vec<String> = list().map(|e| e.spec().key.clone()).to_vec();
    known.extend(two_center_keys.map(|e| e.spec().key.clone()));
    let by_name = |name: &String| -> Result<Equation, Failure> {
        match name.as_str() {
            "virial" => return Ok(virial_series(potential)),
            "pohl-2023" => {
                let pohl =
                    pohl_2023(repulsive).filter(|_| attractive == Mie::LENNARD_JONES.attractive);
                return pohl.map(|e| e as Equation).ok_or_else(|| {
                    refused(format!(
                        "pohl-2023 is for repulsive exponents from 11 to 13 and the attractive exponent 6, found {repulsive} and {attractive}"
                    ))
                });
            }
            _ => {}
        }
        if let Some(equation) = list().into_iter().find(|e| e.spec().key == *name) {
            return Ok(equation);
        }
        if let Some(equation) = pairs.into_iter().flatten().find(|e| e.spec().key == *name) {
            return Ok(equation);
        }
        if known.contains(name) {
            return Err(refused(format!(
                "{name} is for bonds from {} to {} σ, found --bond {}",
                BOND_LENGTHS.start(),
                BOND_LENGTHS.end(),
                args.bond
            )));
        }
        Err(unknown("equation of state", name, &known))
    };
    args.equations.iter().map(by_name).collect()
}

fn properties(names: &[String]) -> Result<Option<Vec<&'static Property>>, Failure> {
    let known: Vec<String> = PROPERTIES.iter().map(|p| p.key.to_owned()).collect();
    let by_name = |name: &String| property(name).ok_or_else(|| unknown("property", name, &known));
    match names {
        [] => Ok(None),
        names => names.iter().map(by_name).collect::<Result<_, _>>().map(Some),
    }
}

fn unknown(what: &str, name: &str, known: &[String]) -> Failure {
    let nearest = lennard_scene::nearest(name, known.iter().map(String::as_str));
    let meant = nearest.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
    refused(format!("there is no {what} `{name}`{meant}\n  allowed: {}", known.join(", ")))
}

/// One state by every equation that covers it.
fn shown_state(
    evaluated: &[Evaluated],
    properties: &[&Property],
    units: Option<&Units>,
) -> Section {
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
fn shown_curve(evaluated: &[Evaluated], properties: &[&Property]) -> Section {
    let citation = evaluated.first().map(|first| first.equation.spec().citation());
    let table = eos::curve(evaluated, properties);
    Section::new(citation.unwrap_or_default()).table(table)
}

/// Vapor and liquid side by side.
fn shown_coexistence(equation: &dyn EquationOfState, rows: &[Coexistence]) -> Section {
    let shown = eos::coexistence(equation, rows);
    Section::new(equation.spec().citation()).text(&shown.caption).table(shown)
}

/// Liquid and crystal side by side.
fn shown_freezing(equation: &dyn EquationOfState, rows: &[Freezing]) -> Section {
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
