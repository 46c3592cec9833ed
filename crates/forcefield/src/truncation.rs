//! Truncations: each wraps any potential into what the kernels sum.

use crate::potential::{Pair, PairPotential};
use crate::real::Real;

/// A truncated potential, as a kernel sees it: valid for r ≤ r_cut, and zero beyond by the kernel's
/// own comparison.
pub trait PairForm: Copy + Send + Sync + 'static {
    /// Whether it runs so seldom that an instance of the loop without energetics is not worth compiling.
    const RARE: bool = false;
    /// The unit of energy that it counts in, ε: kernels multiply their sums by it.
    const UNIT: f64;
    /// U, −U′/r and U″ at r² = `r2` σ², for r ≤ r_cut, in [`PairForm::UNIT`]; `inv_r2` is 1/r².
    fn eval<R: Real>(&self, r2: R, inv_r2: R) -> Pair<R>;
    /// The same in ε.
    #[inline(always)]
    fn eval_in_epsilon<R: Real>(&self, r2: R) -> Pair<R> {
        self.eval(r2, r2.recip()).in_epsilon(Self::UNIT)
    }
}

/// Plain or shifted cutoff: U − `shift`.
#[derive(Clone, Copy, Debug)]
pub struct Plain<P> {
    /// The potential.
    pub potential: P,
    /// What is subtracted from the energy: 0, or U(r_cut), in units of the potential.
    pub shift: f64,
}

impl<P: PairPotential> PairForm for Plain<P> {
    const UNIT: f64 = P::UNIT;
    #[inline(always)]
    fn eval<R: Real>(&self, _r2: R, inv_r2: R) -> Pair<R> {
        let pair = self.potential.eval(inv_r2);
        Pair {
            energy: pair.energy - R::splat(self.shift),
            ..pair
        }
    }
}

/// Linear force shift: U − U(r_cut) − U′(r_cut)·(r − r_cut), so that −U′/r becomes −U′/r + U′(r_cut)/r.
///
/// S. D. Stoddard and J. Ford, "Numerical experiments on the stochastic behavior of a Lennard-Jones
/// gas system", Phys. Rev. A 8 (1973) 1504; Allen and Tildesley, eq. 5.10.
#[derive(Clone, Copy, Debug)]
pub struct ForceShift<P> {
    potential: P,
    /// U′(r_cut), in units of the potential and σ.
    slope: f64,
    /// U(r_cut) − U′(r_cut)·r_cut, in units of the potential.
    constant: f64,
}

impl<P: PairPotential> ForceShift<P> {
    /// Shifts energy and force to zero at `r_cut` σ.
    pub fn new(potential: P, r_cut: f64) -> Self {
        let end = potential.eval((r_cut * r_cut).recip());
        let slope = -end.force * r_cut;
        Self {
            potential,
            slope,
            constant: end.energy - slope * r_cut,
        }
    }
}

impl<P: PairPotential> PairForm for ForceShift<P> {
    const UNIT: f64 = P::UNIT;
    #[inline(always)]
    fn eval<R: Real>(&self, r2: R, inv_r2: R) -> Pair<R> {
        let pair = self.potential.eval(inv_r2);
        let r = r2.sqrt();
        Pair {
            energy: pair.energy - r.mul_add(R::splat(self.slope), R::splat(self.constant)),
            force: inv_r2.sqrt().mul_add(R::splat(self.slope), pair.force),
            curvature: pair.curvature,
        }
    }
}

/// The quintic smoothstep in s = r², falling from 1 at s_on to 0 at s_off with two continuous
/// derivatives: S = 1 − x³·(10 − 15x + 6x²), x = (s − s_on)/(s_off − s_on) held to [0, 1].
///
/// Allen and Tildesley describe such switches in section 5.2; taking r² for r spares a square root.
#[derive(Clone, Copy, Debug)]
pub struct Smoothstep {
    on: f64,
    inv_width: f64,
}

/// The value of a smoothstep and its first two derivatives by s = r².
#[derive(Clone, Copy)]
pub struct Step<R> {
    value: R,
    first: R,
    second: R,
}

impl Smoothstep {
    /// Falls from 1 at r = `from` to 0 at r = `to`, both in σ.
    pub fn new(from: f64, to: f64) -> Self {
        Self {
            on: from * from,
            inv_width: 1.0 / (to * to - from * from),
        }
    }

    /// The value and its derivatives at r² = `r2`.
    #[inline(always)]
    pub fn eval<R: Real>(&self, r2: R) -> Step<R> {
        let inv_width = R::splat(self.inv_width);
        let x = ((r2 - R::splat(self.on)) * inv_width)
            .max(R::splat(0.0))
            .min(R::splat(1.0));
        let x2 = x * x;
        let polynomial = x.mul_add(x.mul_add(R::splat(6.0), R::splat(-15.0)), R::splat(10.0));
        // 1 − x, exact to the last bit near x = 1, keeps the derivatives' double zero there.
        let rest = R::splat(1.0) - x;
        Step {
            value: -(x2 * x).mul_add(polynomial, R::splat(-1.0)),
            first: x2 * (rest * rest) * (R::splat(-30.0) * inv_width),
            second: x
                * rest
                * x.mul_add(R::splat(2.0), R::splat(-1.0))
                * (R::splat(60.0) * inv_width * inv_width),
        }
    }
}

/// `pair` times a weight w(r²): (wU), −(wU)′/r = w·f − 2w₁U and (wU)″ = w·U″ − 4r²·w₁·f + (2w₁ + 4r²w₂)·U,
/// where w₁ and w₂ are the derivatives of w by r² and f = −U′/r.
#[inline(always)]
fn weighted<R: Real>(pair: Pair<R>, step: Step<R>, r2: R) -> Pair<R> {
    let two_first = step.first + step.first;
    let four_r2 = r2 * R::splat(4.0);
    Pair {
        energy: step.value * pair.energy,
        force: step.value.mul_add(pair.force, -(two_first * pair.energy)),
        curvature: step.value.mul_add(
            pair.curvature,
            four_r2
                .mul_add(step.second, two_first)
                .mul_add(pair.energy, -(four_r2 * step.first * pair.force)),
        ),
    }
}

/// U·S(r²) with a [`Smoothstep`] that ends at r_cut: energy, force and curvature are continuous.
#[derive(Clone, Copy, Debug)]
pub struct Switch<P> {
    /// The potential.
    pub potential: P,
    /// The switch.
    pub step: Smoothstep,
}

impl<P: PairPotential> PairForm for Switch<P> {
    const UNIT: f64 = P::UNIT;
    #[inline(always)]
    fn eval<R: Real>(&self, r2: R, inv_r2: R) -> Pair<R> {
        weighted(self.potential.eval(inv_r2), self.step.eval(r2), r2)
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
    fn eval<R: Real>(&self, r2: R, inv_r2: R) -> Pair<R> {
        let pair = self.form.eval(r2, inv_r2);
        let step = self.step.eval(r2);
        let weight = step
            .value
            .mul_add(R::splat(self.sign), R::splat(self.offset));
        Pair {
            energy: weight * pair.energy,
            force: weight * pair.force,
            curvature: weight * pair.curvature,
        }
    }
}
