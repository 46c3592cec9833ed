//! Near and far parts of a force, for multiple time steps.

use super::smoothstep::Smoothstep;
use super::{Constants, Pair, PairForm};
use crate::options::SplitOptions;
use crate::real::Real;

/// The weights of a split, as forms want them.
#[derive(Clone, Copy, Debug)]
pub struct SplitWeights {
    /// w(r²).
    pub step: Smoothstep,
    /// See [`Part`].
    pub offset: f64,
    /// See [`Part`].
    pub sign: f64,
}

impl SplitWeights {
    /// The weights of the near part, or of the far one.
    pub fn new(split: &SplitOptions, near: bool) -> Self {
        Self {
            step: Smoothstep::new(split.r_split - split.width, split.r_split),
            offset: if near { 0.0 } else { 1.0 },
            sign: if near { 1.0 } else { -1.0 },
        }
    }

    /// A form times these weights.
    pub fn of<F: PairForm>(&self, form: F) -> Part<F> {
        Part {
            form,
            step: self.step,
            offset: self.offset,
            sign: self.sign,
        }
    }
}

/// One part of a split force: every entry of a form times w or 1 − w.
///
/// It is the force that is split, not the potential, so that near and far forces add up to the
/// whole force; energy, virial and curvature are shared out by the same weight, and only their
/// sums have a meaning.
#[derive(Clone, Copy, Debug)]
pub struct Part<F> {
    /// The whole.
    pub form: F,
    /// w, from 1 to 0.
    pub step: Smoothstep,
    /// The weight is `offset + sign·w`: (0, 1) for the near part, (1, −1) for the far one.
    pub offset: f64,
    /// See `offset`.
    pub sign: f64,
}

impl<F: PairForm> PairForm for Part<F> {
    const RARE: bool = true;
    const UNIT: f64 = F::UNIT;
    #[inline(always)]
    fn constants(&self) -> Constants<f64> {
        self.form.constants()
    }
    #[inline(always)]
    fn eval_with<R: Real>(&self, constants: Constants<R>, r2: R, inv_r2: R) -> Pair<R> {
        let pair = self.form.eval_with(constants, r2, inv_r2);
        let step = self.step.eval(r2);
        let weight = step
            .value
            .mul_add(r2.splat(self.sign), r2.splat(self.offset));
        Pair {
            energy: weight * pair.energy,
            force: weight * pair.force,
            curvature: weight * pair.curvature,
        }
    }
}
