//! Near and far parts of a force, for multiple time steps.

use super::Interaction;
use crate::options::SplitOptions;
use crate::pair::{Pair, Smoothstep, Step};
use crate::real::{Number, Real};
use crate::simd::Lanes;

/// The weights of a split: w(r²) for the near part, and 1 − w for the far one.
#[derive(Clone, Copy, Debug)]
pub struct SplitWeights {
    /// w, from 1 to 0.
    step: Smoothstep,
    /// The weight is `offset + sign·w`: (0, 1) for the near part, (1, −1) for the far one.
    offset: f64,
    /// See `offset`.
    sign: f64,
}

impl SplitWeights {
    /// The weight 1: the whole force, in an instance of the loops that parts need anyway.
    pub const WHOLE: Self = Self { step: Smoothstep::NOWHERE, offset: 1.0, sign: 0.0 };

    /// The weights of the near part, or of the far one.
    pub fn new(split: &SplitOptions, near: bool) -> Self {
        Self {
            step: Smoothstep::new(split.r_split - split.width, split.r_split),
            offset: if near { 0.0 } else { 1.0 },
            sign: if near { 1.0 } else { -1.0 },
        }
    }

    /// An interaction times these weights.
    pub fn of<I: Interaction>(&self, whole: I) -> Part<I> {
        Part { whole, weights: *self }
    }

    /// The values times the weight at `r2` σ².
    #[inline(always)]
    fn apply<R: Real>(&self, pair: Pair<R>, r2: R) -> Pair<R> {
        let Step { value, .. } = self.step.eval(r2);
        let weight = value.mul_add(r2.splat(self.sign), r2.splat(self.offset));
        Pair {
            energy: weight * pair.energy,
            force: weight * pair.force,
            curvature: weight * pair.curvature,
        }
    }
}

/// One part of a split force: every value of an interaction times w or 1 − w.
///
/// The force is split, not the potential, so that near and far forces add up to the whole force.
/// Energy, virial and curvature are split by the same weight, and only their sums have a meaning.
#[derive(Clone, Copy, Debug)]
pub struct Part<I> {
    whole: I,
    weights: SplitWeights,
}

impl<I: Interaction> Interaction for Part<I> {
    const RARE: bool = true;
    const UNIT: f64 = I::UNIT;
    type Numbers<T: Number> = I::Numbers<T>;
    type Own<L: Lanes> = I::Own<L>;

    #[inline(always)]
    fn between(&self, i: usize, j: usize, r2: f64) -> Option<Pair<f64>> {
        let pair = self.whole.between(i, j, r2)?;
        Some(self.weights.apply(pair, r2))
    }

    #[inline(always)]
    fn energy_at_cutoff(&self, i: usize, j: usize) -> f64 {
        self.whole.energy_at_cutoff(i, j)
    }

    fn numbers<T: Number>(&self, r_cut: f64, length: f64) -> I::Numbers<T> {
        self.whole.numbers(r_cut, length)
    }

    #[inline(always)]
    fn own<L: Lanes>(isa: L::Isa, numbers: &I::Numbers<L::Number>, row: &L::Row) -> I::Own<L> {
        I::own(isa, numbers, row)
    }

    #[inline(always)]
    fn r_cut2<L: Lanes>(own: &I::Own<L>, neighbors: L::Species) -> L {
        I::r_cut2(own, neighbors)
    }

    #[inline(always)]
    fn eval<L: Lanes, const IN_SIGMA: bool>(
        &self,
        own: &I::Own<L>,
        neighbors: L::Species,
        r2: L,
    ) -> Pair<L> {
        let pair = self.whole.eval::<L, IN_SIGMA>(own, neighbors, r2);
        self.weights.apply(pair, I::in_sigma::<L, IN_SIGMA>(own, r2))
    }

    #[inline(always)]
    fn at_cutoff<L: Lanes>(own: &I::Own<L>, neighbors: L::Species) -> Option<L> {
        I::at_cutoff(own, neighbors)
    }

    #[inline(always)]
    fn in_sigma<L: Lanes, const IN_SIGMA: bool>(own: &I::Own<L>, r2: L) -> L {
        I::in_sigma::<L, IN_SIGMA>(own, r2)
    }
}
