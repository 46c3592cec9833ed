//! The shapes of potentials that loops compile in, with the constants of each pair of species.

use super::Pair;
use crate::real::{Real, inverse_power};

/// The numbers of a form that depend on its cutoff; 0 where a form has fewer.
pub type Constants<R> = [R; 3];

/// A shape of potentials that loops compile in.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// 12-6 less a constant, in the unit of Lennard-Jones.
    TwelveSix {
        /// The constant.
        below: f64,
    },
    /// Two inverse powers with their strengths; of one species, at a plain or a shifted cutoff.
    TwoPowers {
        /// The powers.
        form: TwoPowers,
        /// C of each.
        strengths: [f64; 2],
    },
    /// Lennard-Jones/spline; of one species.
    Spline,
}

/// C_n·r⁻ⁿ − C_m·r⁻ᵐ less a constant; the constants are that one, C_n and C_m.
#[derive(Clone, Copy, Debug)]
pub struct TwoPowers {
    /// n.
    pub n: u32,
    /// m.
    pub m: u32,
}

impl TwoPowers {
    /// −U′/r = (n·C_n·r⁻ⁿ − m·C_m·r⁻ᵐ)/r² and U″ = (n(n+1)·C_n·r⁻ⁿ − m(m+1)·C_m·r⁻ᵐ)/r², with U.
    #[inline(always)]
    pub(super) fn values<R: Real>(&self, strengths: [R; 2], inv_r2: R) -> Pair<R> {
        let (n, m) = (f64::from(self.n), f64::from(self.m));
        let powers = self.powers(strengths, inv_r2);
        Pair {
            energy: powers.0 - powers.1,
            force: inv_r2 * sum(powers, n, m),
            curvature: inv_r2 * sum(powers, n * (n + 1.0), m * (m + 1.0)),
        }
    }

    /// C_n·r⁻ⁿ and C_m·r⁻ᵐ.
    #[inline(always)]
    pub(super) fn powers<R: Real>(&self, [of_n, of_m]: [R; 2], inv_r2: R) -> (R, R) {
        (of_n * inverse_power(inv_r2, self.n), of_m * inverse_power(inv_r2, self.m))
    }
}

/// a·`repulsion` − b·`attraction`.
#[inline(always)]
pub(super) fn sum<R: Real>((repulsion, attraction): (R, R), a: f64, b: f64) -> R {
    repulsion.mul_add(repulsion.splat(a), attraction * repulsion.splat(-b))
}
