//! The smoothstep, and potentials weighted by it.

use super::{Constants, Pair};
use crate::real::Real;

/// The quintic smoothstep in s = r², falling from 1 at s_on to 0 at s_off with two continuous
/// derivatives: S = 1 − x³·(10 − 15x + 6x²), x = (s − s_on)/(s_off − s_on) held to [0, 1].
///
/// Allen and Tildesley describe such switches in section 5.2; taking r² for r spares a square root.
#[derive(Clone, Copy, Debug)]
pub struct Smoothstep {
    on: f64,
    inv_width: f64,
}

/// Makes a distance of one rounding from the ends of a step larger than 1; its square stays finite in single precision.
const BEYOND: f64 = 1e9;

/// The value of a smoothstep and its first two derivatives by s = r².
#[derive(Clone, Copy)]
pub struct Step<R> {
    /// S.
    pub value: R,
    first: R,
    second: R,
}

impl Smoothstep {
    /// A step at no distance.
    pub const NOWHERE: Self = Self { on: 0.0, inv_width: 0.0 };

    /// Falls from 1 at r = `from` to 0 at r = `to`, both in σ.
    pub fn new(from: f64, to: f64) -> Self {
        Self { on: from * from, inv_width: 1.0 / (to * to - from * from) }
    }

    /// s_on and 1/(s_off − s_on).
    #[inline(always)]
    pub fn constants(&self) -> Constants<f64> {
        [self.on, self.inv_width]
    }

    /// The value and its derivatives at r² = `r2`.
    #[inline(always)]
    pub fn eval<R: Real>(&self, r2: R) -> Step<R> {
        Self::with([r2.splat(self.on), r2.splat(self.inv_width)], r2)
    }

    /// The value and its derivatives at r² = `r2` with [`Smoothstep::constants`] of any step.
    #[inline(always)]
    pub fn with<R: Real>([on, inv_width]: Constants<R>, r2: R) -> Step<R> {
        let x = ((r2 - on) * inv_width).max(r2.splat(0.0)).min(r2.splat(1.0));
        let x2 = x * x;
        let polynomial = x.mul_add(x.mul_add(r2.splat(6.0), r2.splat(-15.0)), r2.splat(10.0));
        // 1 − x, exact to the last bit near x = 1, keeps the derivatives' double zero there.
        let rest = r2.splat(1.0) - x;
        Step {
            value: -(x2 * x).mul_add(polynomial, r2.splat(-1.0)),
            first: x2 * (rest * rest) * (r2.splat(-30.0) * inv_width),
            second: x
                * rest
                * x.mul_add(r2.splat(2.0), r2.splat(-1.0))
                * (r2.splat(60.0) * inv_width * inv_width),
        }
    }

    /// The cubic step S = (1 − x)²·(1 + 2x) with the same ends, and its derivatives at r² = `r2`: one continuous derivative.
    #[inline(always)]
    pub fn cubic_with<R: Real>([on, inv_width]: Constants<R>, r2: R) -> Step<R> {
        let free = (r2 - on) * inv_width;
        let x = free.max(r2.splat(0.0)).min(r2.splat(1.0));
        let rest = r2.splat(1.0) - x;
        // S″ jumps at both ends: 1 inside, and 0 where x is held.
        let beyond = (free - x) * r2.splat(BEYOND);
        let inside = (r2.splat(1.0) - beyond * beyond).max(r2.splat(0.0));
        Step {
            value: rest * rest * x.mul_add(r2.splat(2.0), r2.splat(1.0)),
            first: x * rest * (r2.splat(-6.0) * inv_width),
            second: inside * x.mul_add(r2.splat(12.0), r2.splat(-6.0)) * (inv_width * inv_width),
        }
    }
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
