//! The state card of a run: every measured property beside every equation that applies.

use crate::report::significant;
use lennard_literature::{EquationOfState, ModelKind, PROPERTIES, Property, equations_for};
use lennard_observables::quantities::{
    Mark, QUANTITIES, has_mark, quantity_name, quantity_of, quantity_unit,
};
use lennard_observables::{Allowed, Cell, Reference, Table, Tone, Verdict, judge};
use serde::Serialize;

use super::{Row, RunFolder, StateOfMatter};

/// Whether a row of a card is a part of the property that it stands beside: no equation is judged by it.
pub(crate) fn is_a_part(property: &str) -> bool {
    quantity_of(property).is_some_and(|quantity| quantity.part_of.is_some())
}

/// A property that the comparison holds against nothing may be so many errors off.
const ERRORS: f64 = 3.0;

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
        self.rows.iter().any(|row| row.error.is_finite())
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
    /// Standard error of a difference from an equation: U, P and T fluctuate together. Not a number where the run gives none, or no equation applies.
    pub error: f64,
    /// The difference that a known bias of the run makes, where it can be predicted.
    pub predicted_bias: Option<f64>,
    /// By each equation, in their order; U and P for as many particles as the run has.
    pub values: Vec<f64>,
    /// The smallest and the largest value of the equations that count; absent with fewer than two of them.
    pub band: Option<[f64; 2]>,
    /// What can be said beside the band.
    pub verdict: Verdict,
}

impl CardRow {
    /// Measured − each equation, without the known bias of the cutoff, which is no fault of an equation.
    pub(crate) fn differences(&self) -> impl Iterator<Item = f64> {
        let measured = self.measured - self.predicted_bias.unwrap_or(0.0);
        self.values.iter().map(move |value| measured - value)
    }
}

/// The card of a run in a single stable phase, from the rows of its comparison; `None` where no equation covers its state.
#[must_use]
pub fn card(
    run: &RunFolder,
    state: &StateOfMatter,
    model: ModelKind,
    compared: &[Row],
) -> Option<StateCard> {
    if !state.is_single_stable_phase() {
        return None;
    }
    let (rho, t) = (state.density, state.temperature);
    let equations: Vec<&'static dyn EquationOfState> =
        equations_for(model).into_iter().filter(|e| e.check(rho, t).is_ok()).collect();
    let states_at = |t| equations.iter().map(|e| e.at(rho, t)).collect();
    let states: Vec<_> = states_at(t);
    let at_the_bath: Vec<_> = states_at(run.bath_temperature().unwrap_or(t));
    let counts: Vec<bool> = equations.iter().map(|e| counts(*e)).collect();
    let at_pressure = run.scene.measured_stages().any(|s| s.barostat.is_some());
    let row = |mean: &str, name: &str, property: &Property, judged: bool| -> Option<CardRow> {
        let row = compared.iter().find(|r| r.quantity == mean)?;
        let states = if has_mark(mean, Mark::AtBath) { &at_the_bath } else { &states };
        let mut values: Vec<f64> = states.iter().map(property.of).collect();
        // The first equation judges the run. Its value and the reference differ by the finite-size term of U and P.
        let finite_size = row.reference.zip(values.first()).map_or(0.0, |(r, v)| r - v);
        values.iter_mut().for_each(|value| *value += finite_size);
        let counted = values.iter().zip(&counts).filter(|(_, counts)| **counts);
        let band = band(counted.filter(|_| judged).map(|(value, _)| *value));
        let or_none = |holds: bool, error: f64| if holds { error } else { f64::NAN };
        Some(CardRow {
            property: mean.to_owned(),
            name: name.to_owned(),
            unit: quantity_unit(property.key).to_owned(),
            measured: row.measured,
            standard_error: or_none(row.is_sound(), row.standard_error),
            error: or_none(applies(row), row.combined_error.unwrap_or(row.standard_error)),
            predicted_bias: row.predicted_bias,
            verdict: beside_band(row, band),
            values,
            band,
        })
    };
    let mut rows: Vec<CardRow> = PROPERTIES
        .iter()
        .filter(|p| !has_mark(p.key, Mark::WholeSystem))
        .filter(|p| !(at_pressure && has_mark(p.key, Mark::AtVolume)))
        .filter_map(|p| row(p.key, &quantity_name(p.key), p, true))
        .collect();
    rows.extend(QUANTITIES.iter().filter_map(|part| {
        let whole = quantity_of(part.part_of?)?;
        let name = format!("{} {}, beside {}", part.words, part.symbol, whole.symbol);
        row(part.key, &name, lennard_literature::property(whole.key)?, false)
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

/// Whether a row may stand beside equations. A reason without a reference says why none applies.
fn applies(row: &Row) -> bool {
    row.is_sound() && (row.reference.is_some() || row.reason.is_empty())
}

/// The verdict on a row of the comparison beside the band, with the tolerance of the comparison.
fn beside_band(row: &Row, band: Option<[f64; 2]>) -> Verdict {
    // The bias of the cutoff explains a difference from the whole band, or from none of it.
    if !row.is_sound() || row.verdict == Verdict::PredictedBias {
        return row.verdict;
    }
    let Some([low, high]) = band.filter(|_| applies(row)) else {
        return Verdict::NoReference;
    };
    let allowed = Allowed {
        tolerance: row.tolerance.unwrap_or(ERRORS * row.standard_error),
        error: row.standard_error.hypot(row.finite_size_uncertainty.unwrap_or(0.0)),
        scale: row.scale.unwrap_or(0.5 * (low + high).abs()),
        bias: None,
    };
    judge(row.measured, Reference::band(low, high), allowed)
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
        values.iter().fold(bounds, |[low, high], v| [low.min(*v), high.max(*v)])
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

/// What the rows say together.
fn sentence(rows: &[CardRow]) -> String {
    let with = |(verdict, lead): &(Verdict, &str)| {
        let rows = rows.iter().filter(|r| r.verdict == *verdict);
        let names: Vec<&str> = rows.map(|r| r.name.as_str()).collect();
        (!names.is_empty()).then(|| format!("{lead}: {}.", names.join(", ")))
    };
    let said = [
        (Verdict::Differs, "Outside the band of the equations"),
        (Verdict::PredictedBias, "Outside the band by the predicted bias of the cutoff"),
        (Verdict::Sharper, "This run is sharper than the literature here in"),
        (Verdict::Agrees, "Within the band"),
        (Verdict::TooCoarse, "Too coarse to tell"),
    ];
    said.iter().filter_map(with).collect::<Vec<_>>().join(" ")
}

/// The card for a reader.
#[must_use]
pub fn card_table(card: &StateCard) -> Table {
    let caption = "Every measured property beside every equation at the measured density and temperature; a chemical potential is at the temperature of the bath. U and P are for \
                   as many particles as the run has, other properties for an infinite system. The band reaches from the smallest to the largest value of the equations that count; what is \
                   greyed does not count. A value is outside the band where it is further off than the tolerance of the comparison.";
    let mut table = Table::rows_of("state_card", &card.rows)
        .caption(caption)
        .column("Property", |r| {
            if r.unit.is_empty() { r.name.clone() } else { format!("{}, {}", r.name, r.unit) }
        })
        .measured("Measured", |r| Some((r.measured, r.standard_error)));
    for (at, equation) in card.equations.iter().enumerate() {
        let tone = if equation.counts { Tone::Plain } else { Tone::Faint };
        table = table.column(&equation.name, |r| Cell::rounded(r.values[at], 5).toned(tone));
    }
    let width = |r: &CardRow| r.band.map(|[low, high]| significant(high - low, 2));
    table = table.column("Band", |r| width(r).map(Cell::figures));
    let verdict = |r: &CardRow| Cell::words(r.verdict.words_beside_band());
    table.column("Verdict", |r| verdict(r).toned(r.verdict.tone())).table()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::average;

    fn row(measured: f64, standard_error: f64) -> Row {
        Row::measured("heat_capacity_pressure", &average(measured, standard_error))
    }

    #[test]
    fn a_value_stands_to_the_band_as_its_error_allows() {
        let band = Some([4.802, 4.818]);
        for (measured, error, expected) in [
            // An error of a sixth of the value sees no band.
            (4.10, 0.70, Verdict::TooCoarse),
            (4.78, 0.09, Verdict::TooCoarse),
            (4.78, 0.07, Verdict::Agrees),
            (4.81, 0.007, Verdict::Sharper),
            (4.79, 0.007, Verdict::Sharper),
            (4.85, 0.007, Verdict::Differs),
            (3.0, 0.5, Verdict::Differs),
        ] {
            let found = beside_band(&row(measured, error), band);
            assert_eq!(found, expected, "{measured} {error}");
        }
        assert_eq!(beside_band(&row(4.8, 0.1), None), Verdict::NoReference);
        // A wide band makes a run that tells its equations apart, though its error is a tenth of the value.
        assert_eq!(beside_band(&row(4.8, 0.5), Some([3.5, 5.5])), Verdict::Sharper);
    }

    /// What the comparison says of a number is not said otherwise beside the band.
    #[test]
    fn the_band_has_the_tolerance_and_the_bias_of_the_comparison() {
        let band = Some([4.802, 4.818]);
        let compared = Row { tolerance: Some(0.1), reference: Some(4.81), ..row(4.75, 0.01) };
        assert_eq!(beside_band(&compared, band), Verdict::Agrees);
        assert_eq!(beside_band(&row(4.75, 0.01), band), Verdict::Differs);
        let biased = Row { verdict: Verdict::PredictedBias, ..compared.clone() };
        assert_eq!(beside_band(&biased, band), Verdict::PredictedBias);
        // A run tells no equations apart by a term that is not trusted.
        let few = Row { finite_size_uncertainty: Some(0.05), ..row(4.81, 0.001) };
        assert_eq!(beside_band(&row(4.81, 0.001), band), Verdict::Sharper);
        assert_eq!(beside_band(&few, band), Verdict::Agrees);
        // A crystal beside the equation of a fluid.
        let frozen = Row { reference: None, reason: "hardly diffuses".into(), ..compared };
        assert_eq!(beside_band(&frozen, band), Verdict::NoReference);
    }

    #[test]
    fn every_property_of_an_equation_is_a_quantity() {
        for property in PROPERTIES {
            assert!(quantity_of(property.key).is_some(), "{}", property.key);
        }
    }

    #[test]
    fn the_band_is_made_of_the_equations_that_count() {
        let model = ModelKind::CutWithTail { r_cut: 4.0 };
        let c_v = lennard_literature::property("heat_capacity").unwrap();
        // Near the triple point Johnson 1993 has 2.0 where the others have 2.62 to 2.67.
        let width = spread(model, 0.8442, 0.722, c_v).unwrap();
        assert!((0.01..0.1).contains(&width), "{width}");
        let pressure = lennard_literature::property("pressure").unwrap();
        assert_eq!(spread(ModelKind::Shifted { r_cut: 2.5 }, 0.8, 1.0, pressure), None);
    }
}
