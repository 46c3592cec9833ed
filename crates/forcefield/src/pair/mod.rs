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
mod smoothstep;
pub(crate) mod tabulated;
mod tail;
mod truncations;

pub use combining::{CombiningOptions, CombiningSpec, Deviation, Size, combining_rules};
pub(crate) use compiled::{
    ByRows, Constants, ForceShifted, PairForm, Shape, Spline, Switched, TwelveSix, TwoPowers,
};
pub use form::Form;
pub(crate) use form::{Compiled, Side};
pub(crate) use laws::{Laws, PairLaw, as_one_fluid};
pub use mixture::{Mixture, SpeciesPair};
pub use model::{Model, model_name};
pub use potentials::*;
pub use rows::Tolerance;
pub(crate) use rows::{LawOfRows, NarrowRow, PairRows, RowsOf, WideRow};
pub(crate) use smoothstep::Smoothstep;
pub use tabulated::TablePath;
pub use tail::{Tail, tail_correction, tail_in, tail_of_mixture};
pub(crate) use truncations::Truncation;
pub use truncations::{TruncationKind, TruncationSpec, truncations};

use crate::options::TruncationOptions;
use crate::real::Real;
use crate::simd::Lanes;

/// The values of a pair formula at a distance r, in ε or in a unit of energy that the formula names.
#[derive(Clone, Copy, Debug)]
pub struct Pair<R> {
    /// U(r), ε.
    pub energy: R,
    /// −U′(r)/r, ε/σ²: the force on i is this times r_ij = r_i − r_j.
    pub force: R,
    /// U″(r), ε/σ².
    pub curvature: R,
}

impl Pair<f64> {
    /// The values in ε, of a formula that counts in `unit` ε.
    pub(crate) fn in_epsilon(self, unit: f64) -> Self {
        Self {
            energy: self.energy * unit,
            force: self.force * unit,
            curvature: self.curvature * unit,
        }
    }
}

impl<R: Real> Pair<R> {
    /// The values where the mask holds, zero elsewhere.
    #[inline(always)]
    pub(crate) fn keep(self, inside: R::Mask) -> Self
    where
        R: Lanes,
    {
        Self {
            energy: self.energy.keep(inside),
            force: self.force.keep(inside),
            curvature: self.curvature.keep(inside),
        }
    }

    /// −U′/r, and the sums Σ U, Σ −r·U′ and Σ (U″ + 2U′/r) with this pair, whose r² is `r2`.
    #[inline(always)]
    pub(crate) fn add_up(self, r2: R, [energy, virial, laplacian]: [R; 3]) -> (R, [R; 3]) {
        let f = self.force;
        let sums = [
            energy + self.energy,
            f.mul_add(r2, virial),
            laplacian + f.mul_add(f.splat(-2.0), self.curvature),
        ];
        (f, sums)
    }
}

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
