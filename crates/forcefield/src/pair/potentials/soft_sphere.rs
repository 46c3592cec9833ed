//! The soft sphere, an inverse power.

use super::{LARGEST_EXPONENT, Potential, PotentialSpec, SMALLEST_EXPONENT, inverse_power};
use crate::pair::{Pair, PairPotential};
use crate::real::Real;

lennard_core::options! {
    /// Soft sphere, the inverse power: U = r⁻ⁿ, −U′/r = n·r⁻ⁿ/r², U″ = n(n+1)·r⁻ⁿ/r².
    ///
    /// W. G. Hoover, M. Ross, K. W. Johnson, D. Henderson, J. A. Barker and B. C. Brown, "Soft-sphere
    /// equation of state", J. Chem. Phys. 52 (1970) 4931, eq. 1.
    #[derive(Copy)]
    pub struct SoftSphere {
        /// The exponent n of U = r⁻ⁿ.
        exponent: u32 = 12, Whole(SMALLEST_EXPONENT, LARGEST_EXPONENT);
    }
}

impl Potential for SoftSphere {
    const SPEC: PotentialSpec = PotentialSpec {
        name: "soft-sphere",
        title: "soft sphere",
        summary: "An inverse power, purely repulsive.",
        equation: "U = r^-n",
        source: "W. G. Hoover et al., Soft-sphere equation of state, J. Chem. Phys. 52 (1970) 4931, eq. 1",
        is_lennard_jones: false,
    };
    /// Even and odd exponents, and the longest tail.
    const EXAMPLES: &'static [Self] =
        &[Self { exponent: 12 }, Self { exponent: 9 }, Self { exponent: 4 }];
    type Formula = Self;

    fn formula(&self) -> Self {
        *self
    }

    fn in_words(&self) -> String {
        format!("soft sphere r^-{}", self.exponent)
    }
}

impl PairPotential for SoftSphere {
    const VANISHES: bool = true;

    #[inline(always)]
    fn eval<R: Real>(&self, _r2: R, inv_r2: R) -> Pair<R> {
        let energy = inverse_power(inv_r2, self.exponent);
        let n = f64::from(self.exponent);
        let scaled = energy * inv_r2;
        Pair {
            energy,
            force: scaled * inv_r2.splat(n),
            curvature: scaled * inv_r2.splat(n * (n + 1.0)),
        }
    }

    fn tail_energy(&self, r_cut: f64) -> f64 {
        let n = f64::from(self.exponent);
        r_cut.powf(3.0 - n) / (n - 3.0)
    }

    fn tail_virial(&self, r_cut: f64) -> f64 {
        -f64::from(self.exponent) * self.tail_energy(r_cut)
    }
}
