//! A truncated potential for one pair, in double precision: what the reference loop sums, and what rows are made of.

use super::potentials::Formula;
use super::shape::{Constants, Shape, TwoPowers};
use super::{Pair, PotentialOptions, Side, Truncation, TruncationOptions};

/// A form that loops compile in.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Compiled {
    /// 12-6, plain or less a constant.
    TwelveSix,
    /// 12-6 with a linear force shift.
    ForceShifted,
    /// 12-6 with the quintic switch.
    Switched,
    /// Two inverse powers less a constant.
    TwoPowers(TwoPowers),
    /// Lennard-Jones/spline.
    Spline,
}

/// A potential with its truncation: valid for r ≤ r_cut.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The potential.
    pub(crate) formula: Formula,
    /// What a truncation makes of it.
    pub(crate) truncation: Truncation,
    /// Joints of both, σ²: sums over all pairs ask for them at each pair.
    joints2: [Option<f64>; 2],
    /// The unit of energy of the potential, ε.
    unit: f64,
}

impl Form {
    /// The truncated potential that the options describe.
    pub(super) fn new(potential: &PotentialOptions, truncation: &TruncationOptions) -> Self {
        let formula = potential.formula();
        let truncation = match potential.own_end() {
            Some(_) => Truncation::Plain { shift: 0.0 },
            None => truncation.kind.of(&formula, truncation),
        };
        let joints2 = [formula.joint2(), truncation.joint2()];
        Self { formula, truncation, joints2, unit: formula.unit() }
    }

    /// r² where one formula gives way to another below the cutoff, σ².
    pub fn joint2(&self) -> Option<f64> {
        let [of_formula, of_truncation] = self.joints2;
        of_truncation.or(of_formula)
    }

    /// U, −U′/r and U″ at r² = `r2` σ² ≤ r_cut², ε.
    #[inline(always)]
    pub fn eval(&self, r2: f64) -> Pair<f64> {
        let [of_formula, of_truncation] = self.joints2.map(|joint2| Side::of(r2, joint2));
        let pair = self.formula.on(of_formula, r2);
        self.truncation.of(pair, of_truncation, r2).in_epsilon(self.unit)
    }

    /// What loops compile in, with the constants of the form; none where they take rows.
    ///
    /// Pairs of several species have fewer forms.
    pub(crate) fn compiled(&self, of_one_species: bool) -> Option<(Compiled, Constants<f64>)> {
        Some(match (self.formula.shape()?, self.truncation) {
            (Shape::TwelveSix { below }, Truncation::Plain { shift }) => {
                (Compiled::TwelveSix, [shift + below, 0.0, 0.0])
            }
            (Shape::TwelveSix { .. }, Truncation::ForceShift { slope, constant }) => {
                (Compiled::ForceShifted, [slope, constant, 0.0])
            }
            _ if !of_one_species => return None,
            (Shape::TwelveSix { .. }, Truncation::Switch(step)) => {
                let [on, inv_width] = step.constants();
                (Compiled::Switched, [on, inv_width, 0.0])
            }
            (Shape::TwoPowers { form, strengths }, Truncation::Plain { shift }) => {
                (Compiled::TwoPowers(form), [shift, strengths[0], strengths[1]])
            }
            (Shape::Spline, Truncation::Plain { .. }) => (Compiled::Spline, [0.0; 3]),
            _ => return None,
        })
    }

    /// The same by the formula of one side of the joint, which goes on beyond the joint and the cutoff.
    pub(crate) fn on(&self, side: Side, r2: f64) -> Pair<f64> {
        let pair = self.formula.on(side, r2);
        self.truncation.of(pair, side, r2).in_epsilon(self.unit)
    }
}
