//! Lennard-Jones 12-6, the potential of a simple liquid.

use super::{Potential, PotentialSpec};
use crate::pair::{Pair, PairPotential, Shape, Side};
use crate::real::Real;

lennard_core::options! {
    /// Lennard-Jones 12-6: U = 4·(r⁻¹² − r⁻⁶), −U′/r = 24·(2r⁻¹² − r⁻⁶)/r², U″ = (624r⁻¹² − 168r⁻⁶)/r².
    ///
    /// J. E. Lennard-Jones, "On the determination of molecular fields. II", Proc. R. Soc. A 106 (1924) 463,
    /// in the form of M. P. Allen and D. J. Tildesley, "Computer Simulation of Liquids", eq. 1.6.
    #[derive(Copy)]
    pub struct LennardJones {}
}

impl Potential for LennardJones {
    const SPEC: PotentialSpec = PotentialSpec {
        name: "lennard-jones",
        title: "Lennard-Jones",
        summary: "The 12-6 potential of a simple liquid.",
        equation: "U = 4 (r^-12 - r^-6)",
        source: "J. E. Lennard-Jones, On the determination of molecular fields. II, Proc. R. Soc. A 106 (1924) 463",
        is_lennard_jones: true,
    };
    const EXAMPLES: &'static [Self] = &[Self {}];
    type Formula = Self;

    fn formula(&self) -> Self {
        *self
    }
}

impl LennardJones {
    /// The unit of energy of the formula, ε: a common factor of every pair becomes a factor of the sums, where it costs nothing.
    pub(crate) const UNIT: f64 = 48.0;

    /// U, −U′/r and U″ in [`PairPotential::UNIT`], from 1/r².
    #[inline(always)]
    pub(crate) fn values<R: Real>(inv_r2: R) -> Pair<R> {
        let inv_r4 = inv_r2 * inv_r2;
        let inv_r6 = inv_r4 * inv_r2;
        let inv_r8 = inv_r4 * inv_r4;
        Pair {
            energy: inv_r6 * inv_r6.mul_add(inv_r2.splat(1.0 / 12.0), inv_r2.splat(-1.0 / 12.0)),
            // r⁻⁸·(r⁻⁶ − 1/2): one multiplication less than with r⁻⁶ times a factor.
            force: inv_r8 * inv_r4.mul_add(inv_r2, inv_r2.splat(-0.5)),
            curvature: inv_r8 * inv_r6.mul_add(inv_r2.splat(13.0), inv_r2.splat(-3.5)),
        }
    }

    /// Returns −U′/r, and adds to Σ r⁻⁶, Σ r⁻¹² and Σ (f + 3/11·r⁻⁸), where f = r⁻⁸·(r⁻⁶ − 1/2) is at hand: r⁻⁸·(11r⁻⁶ − 5/2) = 11f + 3r⁻⁸.
    #[inline(always)]
    pub(crate) fn add_up<R: Real>(inv_r2: R, [of_6, of_12, laplacian]: [R; 3]) -> (R, [R; 3]) {
        let inv_r4 = inv_r2 * inv_r2;
        let inv_r6 = inv_r4 * inv_r2;
        let inv_r8 = inv_r4 * inv_r4;
        let force = inv_r8 * inv_r4.mul_add(inv_r2, inv_r2.splat(-0.5));
        let sums = [
            of_6 + inv_r6,
            inv_r6.mul_add(inv_r6, of_12),
            inv_r8.mul_add(inv_r2.splat(3.0 / 11.0), laplacian + force),
        ];
        (force, sums)
    }

    /// Σ U, Σ −r·U′ and Σ (U″ + 2U′/r) from the sums of [`LennardJones::add_up`].
    pub(crate) fn totals([of_6, of_12, laplacian]: [f64; 3]) -> [f64; 3] {
        let virial = of_12 - 0.5 * of_6;
        [(of_12 - of_6) / 12.0, virial, 11.0 * laplacian]
    }
}

impl PairPotential for LennardJones {
    fn unit(&self) -> f64 {
        Self::UNIT
    }

    fn on(&self, _side: Side, r2: f64) -> Pair<f64> {
        Self::values(r2.recip())
    }

    fn shape(&self) -> Option<Shape> {
        Some(Shape::TwelveSix { below: 0.0 })
    }

    fn tail_energy(&self, r_cut: f64) -> f64 {
        let inv_r3 = r_cut.powi(-3);
        4.0 * (inv_r3.powi(3) / 9.0 - inv_r3 / 3.0)
    }

    fn tail_virial(&self, r_cut: f64) -> f64 {
        let inv_r3 = r_cut.powi(-3);
        4.0 * (-12.0 * inv_r3.powi(3) / 9.0 + 6.0 * inv_r3 / 3.0)
    }
}
