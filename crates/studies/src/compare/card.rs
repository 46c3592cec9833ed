//! The state card of a run: every measured property beside every equation that applies.

use lennard_core::{Cell, Column, Table, Tone};
use lennard_literature::{EquationOfState, ModelKind, PROPERTIES, Property, equations_for};
use lennard_report::significant;
use serde::Serialize;

use super::{RunFolder, StateOfMatter};

/// Means that are compared at the number of particles of the run, and stand in the comparison for that reason.
const OF_THE_WHOLE_SYSTEM: [&str; 2] = ["total_energy", "enthalpy"];

/// Means that are a part of a property: the mean, the property, and the name in tables. They stand beside it, and judge nothing.
const PARTS: [(&str, &str, &str); 1] = [(
    "two_body_entropy",
    "residual_entropy",
    "two-body entropy s₂, beside s_res",
)];

/// Whether a row of a card is a part of the property that it stands beside: no equation is judged by it.
pub(crate) fn is_a_part(property: &str) -> bool {
    PARTS.iter().any(|(mean, ..)| *mean == property)
}

/// Means that belong to the temperature of the bath, and not to the measured one: trial particles have weights of that.
const AT_THE_BATH: [&str; 1] = ["residual_chemical_potential"];

/// A run is sharper than the literature where its error is below this part of the band.
const SHARPER: f64 = 0.5;
/// Errors by which a value must leave the band to be said to lie outside.
const OUTSIDE: f64 = 3.0;

/// Every measured property beside every equation that applies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateCard {
    /// The equations, in the order of the columns.
    pub equations: Vec<CardEquation>,
    /// Property by property.
    pub rows: Vec<CardRow>,
    /// What follows, in a sentence or two.
    pub sentence: String,
}

impl StateCard {
    /// Whether any property has a result: a run that was not in equilibrium has none.
    pub(super) fn has_a_result(&self) -> bool {
        let results = |row: &CardRow| row.standing != Standing::NoResult;
        self.rows.iter().any(results)
    }
}

/// An equation on a card.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CardEquation {
    /// Its key.
    pub key: String,
    /// Its name.
    pub name: String,
    /// Whether it counts for the band of the literature.
    pub counts: bool,
}

/// A measured property beside the equations. Numbers that are not finite are `null` in JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CardRow {
    /// Name in the run record.
    pub property: String,
    /// Name in tables.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// The mean.
    pub measured: f64,
    /// Its standard error; not a number where the run gives none.
    pub standard_error: f64,
    /// By each equation, in their order.
    pub values: Vec<f64>,
    /// The smallest and the largest value of the equations that count; absent with fewer than two of them.
    pub band: Option<[f64; 2]>,
    /// What can be said.
    pub standing: Standing,
}

/// How a measured property stands to the band of the literature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Standing {
    /// The run gives no error for it.
    NoResult,
    /// There are fewer than two equations to make a band.
    NoBand,
    /// Its error is at most as large as half the band: the run tells the equations apart.
    Sharper,
    /// It lies within three errors of the band.
    Within,
    /// It lies outside the band by more than three errors.
    Outside,
}

impl Standing {
    fn words(self) -> &'static str {
        match self {
            Self::NoResult => "no result",
            Self::NoBand => "",
            Self::Sharper => "sharper than the band",
            Self::Within => "within the band",
            Self::Outside => "outside the band",
        }
    }

    fn tone(self) -> Tone {
        match self {
            Self::Outside => Tone::Careful,
            Self::NoResult => Tone::Faint,
            _ => Tone::Plain,
        }
    }
}

/// The card of a run in a single stable phase; `None` where no equation covers its state.
#[must_use]
pub fn card(run: &RunFolder, state: &StateOfMatter, model: ModelKind) -> Option<StateCard> {
    if !state.is_single_stable_phase() {
        return None;
    }
    let (rho, t) = (state.density, state.temperature);
    let equations: Vec<&'static dyn EquationOfState> = equations_for(model)
        .into_iter()
        .filter(|e| e.check(rho, t).is_ok())
        .collect();
    let states_at = |t| equations.iter().map(|e| e.at(rho, t)).collect();
    let states: Vec<_> = states_at(t);
    let at_the_bath: Vec<_> = states_at(run.bath_temperature().unwrap_or(t));
    let counts: Vec<bool> = equations.iter().map(|e| counts(*e)).collect();
    let row = |mean: &str, name: &str, property: &Property, judged: bool| -> Option<CardRow> {
        let average = run.average(mean)?;
        let states = if AT_THE_BATH.contains(&mean) {
            &at_the_bath
        } else {
            &states
        };
        let values: Vec<f64> = states.iter().map(property.of).collect();
        let counted = values.iter().zip(&counts).filter(|(_, counts)| **counts);
        let counted = counted.filter(|_| judged);
        let band = band(counted.map(|(value, _)| *value));
        let error = if average.is_sound() {
            average.standard_error
        } else {
            f64::NAN
        };
        Some(CardRow {
            property: mean.to_owned(),
            name: name.to_owned(),
            unit: property.unit.to_owned(),
            measured: average.mean,
            standard_error: error,
            standing: standing(average.mean, error, band),
            values,
            band,
        })
    };
    let mut rows: Vec<CardRow> = PROPERTIES
        .iter()
        .filter(|p| !OF_THE_WHOLE_SYSTEM.contains(&p.key))
        .filter_map(|p| row(p.key, p.name, p, true))
        .collect();
    rows.extend(PARTS.iter().filter_map(|(mean, whole, name)| {
        row(mean, name, lennard_literature::property(whole)?, false)
    }));
    if equations.is_empty() || rows.is_empty() {
        return None;
    }
    Some(StateCard {
        sentence: sentence(&rows),
        equations: equations
            .iter()
            .zip(&counts)
            .map(|(equation, counts)| CardEquation {
                key: equation.spec().key.clone(),
                name: equation.spec().name.clone(),
                counts: *counts,
            })
            .collect(),
        rows,
    })
}

/// Whether an equation counts for the band.
fn counts(equation: &dyn EquationOfState) -> bool {
    equation.spec().superseded.is_none()
}

/// The smallest and the largest of the values; `None` for fewer than two.
fn band(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    (values.len() > 1).then(|| {
        let bounds = [f64::INFINITY, f64::NEG_INFINITY];
        values
            .iter()
            .fold(bounds, |[low, high], v| [low.min(*v), high.max(*v)])
    })
}

/// By how much the good equations differ in a property at a state; `None` for fewer than two of them.
pub(super) fn spread(model: ModelKind, rho: f64, t: f64, property: &Property) -> Option<f64> {
    let values = equations_for(model)
        .into_iter()
        .filter(|e| counts(*e) && e.check(rho, t).is_ok())
        .map(|e| (property.of)(&e.at(rho, t)));
    band(values).map(|[low, high]| high - low)
}

fn standing(measured: f64, error: f64, band: Option<[f64; 2]>) -> Standing {
    let Some([low, high]) = band else {
        return if error.is_finite() {
            Standing::NoBand
        } else {
            Standing::NoResult
        };
    };
    let beyond = (measured - high).max(low - measured);
    if !error.is_finite() {
        Standing::NoResult
    } else if beyond > OUTSIDE * error {
        Standing::Outside
    } else if error < SHARPER * (high - low) {
        Standing::Sharper
    } else {
        Standing::Within
    }
}

/// What the rows say together.
fn sentence(rows: &[CardRow]) -> String {
    let with = |standing: Standing| -> Vec<&str> {
        let rows = rows.iter().filter(|r| r.standing == standing);
        rows.map(|r| r.name.as_str()).collect()
    };
    let mut text = String::new();
    let outside = with(Standing::Outside);
    if !outside.is_empty() {
        text += &format!(
            "Outside the band of the equations: {}. ",
            outside.join(", ")
        );
    }
    let sharper = with(Standing::Sharper);
    if !sharper.is_empty() {
        text += &format!(
            "This run is sharper than the literature here in: {}. ",
            sharper.join(", ")
        );
    }
    let within = with(Standing::Within);
    if !within.is_empty() {
        text += &format!("Within the band: {}. ", within.join(", "));
    }
    text.trim_end().to_owned()
}

/// The card for a reader.
#[must_use]
pub fn card_table(card: &StateCard) -> Table {
    let caption = "Every measured property beside every equation at the measured density and temperature, for an infinite system; a chemical potential is at the temperature of the bath. The band reaches from the smallest to the \
                   largest value of the equations that count; what is greyed does not count.";
    let mut table = Table::rows_of("state_card", &card.rows)
        .caption(caption)
        .column("Property", |r| {
            if r.unit.is_empty() {
                r.name.clone()
            } else {
                format!("{}, {}", r.name, r.unit)
            }
        })
        .measured("Measured", |r| Some((r.measured, r.standard_error)))
        .table();
    for (at, equation) in card.equations.iter().enumerate() {
        let tone = if equation.counts {
            Tone::Plain
        } else {
            Tone::Faint
        };
        table.columns.push(Column {
            cells: card
                .rows
                .iter()
                .map(|r| Cell::rounded(r.values[at], 5).toned(tone))
                .collect(),
            ..Column::headed(&equation.name)
        });
    }
    let width = |r: &CardRow| r.band.map(|[low, high]| significant(high - low, 2));
    table.columns.push(Column {
        cells: card
            .rows
            .iter()
            .map(|r| Cell::from(width(r).map(Cell::figures)))
            .collect(),
        ..Column::headed("Band")
    });
    table.columns.push(Column {
        cells: card
            .rows
            .iter()
            .map(|r| Cell::words(r.standing.words()).toned(r.standing.tone()))
            .collect(),
        ..Column::headed("Standing")
    });
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_stands_to_the_band_as_its_error_allows() {
        let band = Some([1.0, 1.2]);
        for (measured, error, expected) in [
            (1.1, 0.2, Standing::Within),
            (1.1, 0.05, Standing::Sharper),
            (1.4, 0.05, Standing::Outside),
            (0.9, 0.05, Standing::Sharper),
            (0.9, 0.2, Standing::Within),
            (1.1, f64::NAN, Standing::NoResult),
        ] {
            assert_eq!(
                standing(measured, error, band),
                expected,
                "{measured} {error}"
            );
        }
        assert_eq!(standing(1.1, 0.1, None), Standing::NoBand);
    }

    #[test]
    fn the_band_is_made_of_the_equations_that_count() {
        let model = ModelKind::CutWithTail { r_cut: 4.0 };
        let c_v = lennard_literature::property("heat_capacity").unwrap();
        // Near the triple point Johnson 1993 has 2.0 where the others have 2.62 to 2.67.
        let width = spread(model, 0.8442, 0.722, c_v).unwrap();
        assert!((0.01..0.1).contains(&width), "{width}");
        let pressure = lennard_literature::property("pressure").unwrap();
        assert_eq!(
            spread(ModelKind::Shifted { r_cut: 2.5 }, 0.8, 1.0, pressure),
            None
        );
    }
}
