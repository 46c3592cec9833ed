//! The soft sphere, an inverse power.

use super::{LARGEST_EXPONENT, Potential, PotentialSpec, SMALLEST_EXPONENT};
use crate::pair::{Pair, PairPotential, Shape, Side, TwoPowers};

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

impl SoftSphere {
    /// The power, and another one that costs nothing and has no strength.
    fn one_power(&self) -> TwoPowers {
        TwoPowers { n: self.exponent, m: 0 }
    }
}

impl PairPotential for SoftSphere {
    fn on(&self, _side: Side, r2: f64) -> Pair<f64> {
        self.one_power().values([1.0, 0.0], r2.recip())
    }

    fn shape(&self) -> Option<Shape> {
        Some(Shape::TwoPowers { form: self.one_power(), strengths: [1.0, 0.0] })
    }

    fn tail_energy(&self, r_cut: f64) -> f64 {
        let n = f64::from(self.exponent);
        r_cut.powf(3.0 - n) / (n - 3.0)
    }

    fn tail_virial(&self, r_cut: f64) -> f64 {
        -f64::from(self.exponent) * self.tail_energy(r_cut)
    }
}
