//! Finished runs beside the literature: every quantity with its difference in standard errors and a verdict.

mod beside;
mod beside_page;
mod card;
pub mod own_literature;
mod phase;
mod read;
mod rows;
mod runs_of_others;
mod table;
mod tail_bias;
mod transport;
mod two_phases;
mod verdict;

pub use beside::{Beside, beside};
pub use beside_page::meanings;
pub(crate) use card::is_a_part;
pub use card::{CardEquation, CardRow, StateCard, card_table};
pub use lennard_observables::Verdict;
pub use lennard_observables::quantities::quantity_words;
pub use phase::{StateOfMatter, state_of};
pub use read::{ReadError, RunFolder};
pub use table::{physical, table};
pub use verdict::Row;

use lennard_literature::units::Units;
use lennard_literature::{equation_of_state_for, remark_for};
use lennard_observables::Remark;
use read::is_of_few_bodies;
use rows::Compared;
pub(crate) use rows::HANSEN_VERLET;
use runs_of_others::RunsOfOthers;
use serde::{Serialize, Serializer};

/// A run beside the literature.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedRun {
    /// The folder of the run.
    pub run: String,
    /// The model in words.
    pub model: String,
    /// Particles.
    pub atoms: u64,
    /// Molecules; particles where there are none.
    pub molecules: u64,
    /// Steps of the measured stages.
    pub measured_steps: u64,
    /// Where the run lies.
    pub state: StateOfMatter,
    /// The equation of state that it is judged by; absent where none describes its model, and `remarks` say so.
    pub equation: Option<String>,
    /// Quantity by quantity.
    pub rows: Vec<Row>,
    /// Every measured property beside every equation that applies; absent where none covers the state.
    pub card: Option<StateCard>,
    /// The means in units of a substance, where the scene names one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<Units>,
    /// What the rows say together, in a sentence or two.
    pub headline: String,
    /// The reason that most of the primary rows share; the headline says it.
    pub shared_reason: Option<String>,
    /// What belongs beside the numbers.
    #[serde(serialize_with = "in_words")]
    pub remarks: Vec<Remark>,
}

/// Remarks in words, as a reader of the document wants them.
fn in_words<S: Serializer>(remarks: &[Remark], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(remarks.iter().map(Remark::to_string))
}

impl ComparedRun {
    /// Whether it is of so few bodies that its means say nothing of a fluid.
    #[must_use]
    pub fn is_of_few_bodies(&self) -> bool {
        is_of_few_bodies(self.molecules)
    }
}

/// Compares a finished run.
#[must_use]
pub fn compare(run: &RunFolder) -> ComparedRun {
    let model = lennard_scene::model_kind(&run.scene);
    let equation = equation_of_state_for(model);
    let mut state = state_of(run, equation.as_ref().ok().copied());
    let not_homogeneous = run.scene.not_homogeneous();
    if let Some(confined) = run.scene.confined_by() {
        let what = match is_of_few_bodies(run.molecules()) {
            true => "a few bodies with",
            false => "a fluid that has",
        };
        state = state.of_no_phase(format!("{what} {confined}"));
    } else if let Some(why) = &not_homogeneous {
        state = state.of_no_phase(why.clone());
    }
    let mut remarks = Vec::new();
    let no_reference = match &equation {
        _ if not_homogeneous.is_some() => not_homogeneous,
        _ if run.has_separated().is_some() => {
            let why = "the fluid has separated into two phases".to_owned();
            state = state.of_no_phase(why.clone());
            Some(why)
        }
        _ if run.has_two_phases() => Some("vapor and liquid side by side".to_owned()),
        Err(none) => {
            remarks.push(format!("not compared with any equation of state: {none}").into());
            Some(format!("no equation of state for {}", none.model))
        }
        Ok(equation) if !state.is_single_stable_phase() => {
            remarks.push(Remark::NotJudged {
                equation: equation.spec().name.clone(),
                state: state.in_numbers(),
                phase: state.words.clone(),
            });
            Some(state.words.clone())
        }
        Ok(_) => None,
    };
    if !run.has_two_phases() {
        remarks.extend(remark_for(model).map(Remark::from));
    }
    let others = RunsOfOthers::beside(run, model);
    remarks.extend(others.remark().map(Remark::from));
    // A run beside runs of others has references, whatever the equations say.
    let missing = no_reference.clone().filter(|_| !others.are_there());
    let mut rows = rows::all(&Compared {
        run,
        state: &state,
        model,
        no_reference: no_reference.clone(),
        others,
    });
    let card = no_reference
        .is_none()
        .then(|| card::card(run, &state, model, &rows))
        .flatten()
        .filter(StateCard::has_a_result);
    // A run that tells the equations apart is not too coarse, and another equation may be nearer than the one that judges.
    for beside in card.iter().flat_map(|card| &card.rows) {
        let is_settled = |row: &Row| !matches!(row.verdict, Verdict::Differs | Verdict::TooCoarse);
        let mut rows = rows.iter_mut().filter(|row| row.quantity == beside.property);
        if let Some(row) = rows.next().filter(|row| !is_settled(row))
            && beside.verdict == Verdict::Sharper
        {
            row.verdict = Verdict::Sharper;
            row.reason.clear();
        }
    }
    ComparedRun {
        card,
        run: run.folder.display().to_string(),
        units: run.scene.units,
        model: run.record.model.clone(),
        atoms: run.record.atoms,
        molecules: run.molecules(),
        measured_steps: run.scene.measured_steps(),
        equation: equation
            .as_ref()
            .ok()
            .filter(|_| no_reference.is_none())
            .map(|e| e.spec().citation()),
        headline: if is_of_few_bodies(run.molecules()) {
            "So few bodies have no thermodynamic state: positions and velocities are the result."
                .into()
        } else {
            which_phase_grows(run)
                .or_else(|| has_separated(run))
                .unwrap_or_else(|| headline(&rows, missing.as_deref()))
        },
        shared_reason: shared_reason(&rows).map(|row| row.reason.clone()),
        rows,
        state,
        remarks,
    }
}

/// The first of the primary rows whose reason most of them share; `None` where there is no such reason.
fn shared_reason(rows: &[Row]) -> Option<&Row> {
    let primary = || rows.iter().filter(|r| r.primary);
    primary().find(|row| {
        let same = primary().filter(|r| r.reason == row.reason).count();
        !row.reason.is_empty() && !row.verdict.is_judged() && 2 * same > primary().count()
    })
}

/// What a run of a crystal beside its liquid is made for: it moves, so that its means are no results of an equilibrium.
fn which_phase_grows(run: &RunFolder) -> Option<String> {
    run.record.typed_remarks.iter().find_map(|remark| match remark {
        Remark::Fronts(fronts) => Some(format!("{}.", capital(&fronts.to_string()))),
        _ => None,
    })
}

/// That a run has separated, which comes before everything else that is said of its means.
fn has_separated(run: &RunFolder) -> Option<String> {
    let why = run.has_separated()?;
    Some(format!(
        "The fluid has separated into two phases: {why}. Means over the box belong to neither."
    ))
}

/// What the primary rows say together.
fn headline(rows: &[Row], no_reference: Option<&str>) -> String {
    // What speaks against all means, and so against most of the primary ones, speaks against the run.
    if let Some(row) = shared_reason(rows).filter(|row| !row.is_sound()) {
        let reason = &row.reason;
        return match row.verdict {
            Verdict::NotInEquilibrium => {
                format!("The run was not in equilibrium: {reason}. Its means are no results.")
            }
            Verdict::TooShort => format!("The run is too short: {reason}."),
            _ => format!("Nothing is judged: {reason}."),
        };
    }
    let primary = |wanted: &dyn Fn(&Row) -> bool| -> Vec<&Row> {
        rows.iter().filter(|r| r.primary && wanted(r)).collect()
    };
    let with = |verdict: Verdict| primary(&|r| r.verdict == verdict);
    let names = |rows: &[&Row]| {
        let names: Vec<String> = rows.iter().map(|r| quantity_words(&r.quantity)).collect();
        names.join(", ")
    };
    let judged = primary(&|r| r.verdict.is_judged());
    let mut text = match (judged.len(), with(Verdict::Agrees).len()) {
        (0, _) if no_reference.is_none() => "Nothing was held against a reference.".into(),
        (0, _) => String::new(),
        (1, 1) => format!("{} agrees with its reference.", capital(&names(&judged))),
        (2, 2) => format!(
            "{} and {} agree with their references.",
            capital(&quantity_words(&judged[0].quantity)),
            quantity_words(&judged[1].quantity)
        ),
        (all, agree) if all == agree => {
            format!("All {all} quantities that have a reference agree with it.")
        }
        (all, agree) => format!("{agree} of {all} quantities that have a reference agree with it."),
    };
    if let Some(why) = no_reference {
        text += &format!(" No reference of a homogeneous fluid applies: {why}.");
    }
    let biased = with(Verdict::PredictedBias);
    if let Some(first) = biased.first() {
        text += &format!(
            " {} differ{} as {} predicts, and what is left is within the tolerance.",
            capital(&names(&biased)),
            if biased.len() == 1 { "s" } else { "" },
            first.reason
        );
    }
    for (verdict, lead) in [
        (Verdict::Differs, "Not explained: the difference in"),
        (Verdict::Sharper, "The run is sharper than the equations in"),
        (Verdict::TooCoarse, "Too coarse to tell:"),
    ] {
        let rows = with(verdict);
        if !rows.is_empty() {
            text += &format!(" {lead} {}.", names(&rows));
        }
    }
    let short = primary(&|r| !r.is_sound());
    if !short.is_empty() {
        text += &format!(" No result yet: {}.", names(&short));
    }
    text.trim_start().to_owned()
}

/// The text with a capital first letter.
pub(crate) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + letters.as_str()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agreeing(quantity: &str) -> Row {
        let average = crate::testing::average(1.0, 0.1);
        Row { verdict: Verdict::Agrees, primary: true, ..Row::measured(quantity, &average) }
    }

    #[test]
    fn few_quantities_that_agree_are_named() {
        let rows = ["potential_energy", "pressure", "heat_capacity"].map(agreeing);
        for (n, words) in [
            (1, "Potential energy agrees with its reference."),
            (2, "Potential energy and pressure agree with their references."),
            (3, "All 3 quantities that have a reference agree with it."),
        ] {
            assert_eq!(headline(&rows[..n], None), words);
        }
    }
}
