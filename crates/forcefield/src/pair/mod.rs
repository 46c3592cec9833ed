//! Pair potentials, their truncations, and the forms and rows that the loops sum.
//!
//! A potential is one file in `potentials/` and one line in its list; a truncation likewise in `truncations/`, and a
//! combining rule in `combining/`. Options, scene keys, tails, names and tests follow from the lists.
//!
//! ```text
//!   form         formula and truncation, in double precision, for one pair: what the reference loop sums
//!   compiled     the forms that loops compile in, since rows would take too long
//!   rows         any form as cubics of −U′/r in r², made when a run is built and judged by the formula
//! ```

mod combining;
mod compiled;
mod form;
mod laws;
mod mixture;
mod model;
pub mod potentials;
mod rows;
mod shape;
mod smoothstep;
pub(crate) mod tabulated;
mod tail;
mod truncations;
mod values;

pub use combining::{CombiningOptions, CombiningSpec, Deviation, Size, combining_rules};
pub(crate) use compiled::{ByRows, ForceShifted, PairForm, Spline, Switched, TwelveSix};
pub(crate) use form::Compiled;
pub use form::Form;
pub(crate) use laws::{Laws, PairLaw, as_one_fluid};
pub use mixture::{Mixture, SpeciesPair};
pub use model::{Model, model_name};
pub use potentials::*;
pub(crate) use rows::LawOfRows;
pub(crate) use shape::{Constants, Shape, TwoPowers};
pub(crate) use smoothstep::Smoothstep;
pub use tabulated::TablePath;
pub use tail::{Tail, tail_correction, tail_in, tail_of_mixture};
pub(crate) use truncations::Truncation;
pub use truncations::{
    CutoffUnit, LONGEST_CUTOFF, SHORTEST_CUTOFF, TruncationKind, TruncationOptions, TruncationSpec,
    truncations,
};
pub(crate) use values::Side;
pub use values::{Pair, Tolerance};

/// U(r) without any cutoff, in double precision: what the reference loop and the rows of loops are made of.
pub trait PairPotential: std::fmt::Debug + Send + Sync {
    /// The unit of energy of the formula, ε.
    fn unit(&self) -> f64 {
        1.0
    }
    /// r² where one formula gives way to another, σ²; none where there is one formula.
    fn joint2(&self) -> Option<f64> {
        None
    }
    /// U, −U′/r and U″ at r² = `r2` σ², in its unit; the formula of one side of the joint goes on beyond it.
    fn on(&self, side: Side, r2: f64) -> Pair<f64>;
    /// The same by the formula that holds at `r2`.
    fn eval(&self, r2: f64) -> Pair<f64> {
        self.on(Side::of(r2, self.joint2()), r2)
    }
    /// The shape that loops compile in; none where they take rows.
    fn shape(&self) -> Option<Shape> {
        None
    }
    /// r² where values of the potential begin, σ²: below, U is a straight line in r². None where it is a formula.
    fn begin2(&self) -> Option<f64> {
        None
    }
    /// How far a loop may be from the formula.
    fn tolerance(&self) -> Tolerance {
        Tolerance::FORMULA
    }
    /// ∫ r² U dr from `r_cut` to ∞, ε·σ³.
    fn tail_energy(&self, r_cut: f64) -> f64;
    /// ∫ r³ U′ dr from `r_cut` to ∞, ε·σ³.
    fn tail_virial(&self, r_cut: f64) -> f64;
}
