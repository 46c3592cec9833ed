//! Pair potentials, their truncations, and the truncated potential that the kernels sum.
//!
//! A potential is one file in `potentials/` and one line in its list; a truncation likewise in `truncations/`, and a
//! combining rule in `combining/`. Options, scene keys, dispatch to the kernels, tails, names and tests follow from the lists.

mod combining;
mod laws;
mod mixture;
mod model;
pub mod potentials;
mod smoothstep;
pub(crate) mod tabulated;
mod tail;
mod truncations;

pub use combining::{CombiningOptions, CombiningSpec, Deviation, Size, combining_rules};
pub(crate) use laws::{Laws, PairLaw, as_one_fluid};
pub use mixture::{Mixture, SpeciesPair};
pub use model::{Model, model_name};
pub(crate) use potentials::with_form;
pub use potentials::*;
pub(crate) use smoothstep::{Smoothstep, Step};
pub use tabulated::TablePath;
pub use tail::{Tail, tail_correction, tail_in, tail_of_mixture};
pub(crate) use truncations::with_truncated;
pub use truncations::{Plain, Truncated, TruncationKind, TruncationSpec, truncations};

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

impl<R: Real> Pair<R> {
    /// The values in ε, of a formula that counts in `unit` ε.
    #[inline(always)]
    pub(crate) fn in_epsilon(self, unit: f64) -> Self {
        let unit = self.energy.splat(unit);
        Self {
            energy: self.energy * unit,
            force: self.force * unit,
            curvature: self.curvature * unit,
        }
    }

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

/// U(r) without any cutoff. The trait is not object-safe, on purpose: each kernel compiles the formula in.
pub trait PairPotential: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// The unit of energy of the formula, ε. A common factor of every pair becomes a factor of the sums, where it costs
    /// nothing.
    const UNIT: f64 = 1.0;
    /// Whether runs bend the end of the potential (force shift, switch) so seldom that their loops have few instances of it,
    /// which are slower.
    const SELDOM_BENT: bool = false;
    /// Whether mixtures use the potential so seldom that their loops have few instances of it, which are slower.
    const RARE_IN_MIXTURES: bool = true;
    /// Whether U, −U′/r and U″ are 0 where 1/r² is 0, as inverse powers are. Loops of sums then mask 1/r² alone.
    const VANISHES: bool = false;
    /// U, −U′/r and U″ at r² = `r2` σ², in [`PairPotential::UNIT`]; `inv_r2` is 1/r².
    fn eval<R: Real>(&self, r2: R, inv_r2: R) -> Pair<R>;
    /// Returns −U′/r with the bits of [`PairPotential::eval`], and adds the pair to three sums that
    /// [`PairPotential::totals`] understands.
    ///
    /// A potential of two powers sums the powers, which takes the fewest operations.
    #[inline(always)]
    fn add_up<R: Real>(&self, r2: R, inv_r2: R, sums: [R; 3]) -> (R, [R; 3]) {
        self.eval(r2, inv_r2).add_up(r2, sums)
    }
    /// Σ U, Σ −r·U′ and Σ (U″ + 2U′/r) from the sums of [`PairPotential::add_up`].
    fn totals(&self, sums: [f64; 3]) -> [f64; 3] {
        sums
    }
    /// ∫ r² U dr from `r_cut` to ∞, ε·σ³.
    fn tail_energy(&self, r_cut: f64) -> f64;
    /// ∫ r³ U′ dr from `r_cut` to ∞, ε·σ³.
    fn tail_virial(&self, r_cut: f64) -> f64;
}

/// A truncated potential, as a kernel sees it: valid for r ≤ r_cut. The kernel's own comparison makes it zero beyond.
pub trait PairForm: Copy + Send + Sync + 'static {
    /// Whether runs use the form so seldom that an instance of the loop without energetics is not worth compiling.
    const RARE: bool = false;
    /// The same in mixtures.
    const RARE_IN_MIXTURES: bool = true;
    /// As [`PairPotential::VANISHES`], but for a constant that each pair adds to U.
    const VANISHES: bool = false;
    /// The unit of energy of the form, ε: kernels multiply their sums by it.
    const UNIT: f64;
    /// The numbers of the form that depend on its cutoff. In a mixture they differ from one pair of species to another.
    fn constants(&self) -> Constants<f64>;
    /// U, −U′/r and U″ at r² = `r2` σ², for r ≤ r_cut, in [`PairForm::UNIT`], with the constants of any cutoff; `inv_r2` is
    /// 1/r².
    fn eval_with<R: Real>(&self, constants: Constants<R>, r2: R, inv_r2: R) -> Pair<R>;
    /// U, −U′/r and U″ at r² = `r2` σ², for r ≤ r_cut, in [`PairForm::UNIT`]; `inv_r2` is 1/r².
    #[inline(always)]
    fn eval<R: Real>(&self, r2: R, inv_r2: R) -> Pair<R> {
        let [a, b] = self.constants();
        self.eval_with([r2.splat(a), r2.splat(b)], r2, inv_r2)
    }
    /// As [`PairPotential::add_up`], where the form [`VANISHES`](PairForm::VANISHES).
    #[inline(always)]
    fn add_up<R: Real>(&self, r2: R, inv_r2: R, sums: [R; 3]) -> (R, [R; 3]) {
        self.eval(r2, inv_r2).add_up(r2, sums)
    }
    /// Σ U, Σ −r·U′ and Σ (U″ + 2U′/r) from the sums of [`PairForm::add_up`] over so many pairs.
    fn totals(&self, sums: [f64; 3], _pairs: u64) -> [f64; 3] {
        sums
    }
    /// U, −U′/r and U″ at r² = `r2` σ², in ε.
    #[inline(always)]
    fn eval_in_epsilon<R: Real>(&self, r2: R) -> Pair<R> {
        self.eval(r2, r2.recip()).in_epsilon(Self::UNIT)
    }
}

/// The numbers of a form that depend on its cutoff; 0 where a form has fewer.
pub type Constants<R> = [R; 2];
