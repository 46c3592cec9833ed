//! The smoothstep, and potentials weighted by it.

use super::{Pair, Side};
use crate::real::Real;

/// A step in s = r² from 1 at s_on to 0 at s_off, with x = (s − s_on)/(s_off − s_on) between them.
///
/// Allen and Tildesley describe such switches in section 5.2; taking r² for r spares a square root.
#[derive(Clone, Copy, Debug)]
pub struct Smoothstep {
    on: f64,
    inv_width: f64,
}

/// The value of a smoothstep and its first two derivatives by s = r².
#[derive(Clone, Copy)]
pub struct Step<R = f64> {
    /// S.
    pub value: R,
    /// dS/ds.
    pub first: R,
    second: R,
}

impl Step {
    /// The step before its begin.
    const ONE: Self = Self { value: 1.0, first: 0.0, second: 0.0 };
}

impl Smoothstep {
    /// Falls from 1 at r = `from` to 0 at r = `to`, both in σ.
    pub fn new(from: f64, to: f64) -> Self {
        Self { on: from * from, inv_width: 1.0 / (to * to - from * from) }
    }

    /// s_on and 1/(s_off − s_on).
    pub fn constants(&self) -> [f64; 2] {
        [self.on, self.inv_width]
    }

    /// s_on, σ².
    pub fn begin2(&self) -> f64 {
        self.on
    }

    /// The step in lengths of `sigma` σ.
    pub fn in_lengths(&self, sigma: f64) -> Self {
        let sigma2 = sigma * sigma;
        Self { on: self.on / sigma2, inv_width: self.inv_width * sigma2 }
    }

    /// x, with the last digit held to 1 at the end.
    fn x(&self, r2: f64) -> f64 {
        let x = (r2 - self.on) * self.inv_width;
        if (x - 1.0).abs() < 4.0 * f64::EPSILON { 1.0 } else { x }
    }

    /// S = 1 − x³·(10 − 15x + 6x²), with two continuous derivatives, at r² = `r2` on a side of s_on; the polynomial goes on
    /// beyond s_off.
    pub fn quintic(&self, side: Side, r2: f64) -> Step {
        if side == Side::Inside {
            return Step::ONE;
        }
        quintic(self.x(r2), self.inv_width)
    }

    /// S = (1 − x)²·(1 + 2x), with one continuous derivative, likewise.
    pub fn cubic(&self, side: Side, r2: f64) -> Step {
        if side == Side::Inside {
            return Step::ONE;
        }
        let x = self.x(r2);
        let rest = 1.0 - x;
        Step {
            value: rest * rest * (2.0 * x + 1.0),
            first: x * rest * (-6.0 * self.inv_width),
            second: (12.0 * x - 6.0) * (self.inv_width * self.inv_width),
        }
    }
}

/// The quintic step at x, where 1/(s_off − s_on) is `inv_width`.
#[inline(always)]
fn quintic<R: Real>(x: R, inv_width: R) -> Step<R> {
    let x2 = x * x;
    let polynomial = x.mul_add(x.mul_add(x.splat(6.0), x.splat(-15.0)), x.splat(10.0));
    // 1 − x, exact to the last bit near x = 1, keeps the derivatives' double zero there.
    let rest = x.splat(1.0) - x;
    Step {
        value: -(x2 * x).mul_add(polynomial, x.splat(-1.0)),
        first: x2 * (rest * rest) * (x.splat(-30.0) * inv_width),
        second: x
            * rest
            * x.mul_add(x.splat(2.0), x.splat(-1.0))
            * (x.splat(60.0) * inv_width * inv_width),
    }
}

/// The values of a pair times the quintic step with these s_on and 1/(s_off − s_on), held to 1 before it and to 0 beyond it.
#[inline(always)]
pub(super) fn switched<R: Real>(pair: Pair<R>, [on, inv_width]: [R; 2], r2: R) -> Pair<R> {
    let x = ((r2 - on) * inv_width).max(r2.splat(0.0)).min(r2.splat(1.0));
    weighted(pair, quintic(x, inv_width), r2)
}

/// `pair` times a weight w(r²): (wU), −(wU)′/r = w·f − 2w₁U and (wU)″ = w·U″ − 4r²·w₁·f + (2w₁ + 4r²w₂)·U,
/// where w₁ and w₂ are the derivatives of w by r² and f = −U′/r.
#[inline(always)]
pub(super) fn weighted<R: Real>(pair: Pair<R>, step: Step<R>, r2: R) -> Pair<R> {
    let two_first = step.first + step.first;
    let four_r2 = r2 * r2.splat(4.0);
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
