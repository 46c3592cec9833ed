//! The values of a pair at a distance, and how far loops may be from them.

use crate::real::Real;

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

impl Pair<f64> {
    /// The values in ε, of a formula that counts in `unit` ε.
    pub(crate) fn in_epsilon(self, unit: f64) -> Self {
        Self {
            energy: self.energy * unit,
            force: self.force * unit,
            curvature: self.curvature * unit,
        }
    }
}

impl<R: Real> Pair<R> {
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

/// The side of a joint of two formulas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// r² up to the joint.
    Inside,
    /// r² beyond the joint.
    Outside,
}

impl Side {
    /// The side of r² = `r2` where the joint is at `joint2`; inside where there is none.
    pub fn of(r2: f64, joint2: Option<f64>) -> Self {
        if joint2.is_some_and(|joint2| r2 > joint2) { Self::Outside } else { Self::Inside }
    }
}

/// How far rows may be from a formula: |ΔU| as a share of max(|U|, ε), and |ΔF| as a share of max(|F|, ε/σ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Of U.
    pub energy: f64,
    /// Of F.
    pub force: f64,
}

impl Tolerance {
    /// For a formula in double precision.
    pub const FORMULA: Self = Self { energy: 1e-10, force: 1e-9 };
    /// For registers in single precision: less than a formula loses in them.
    pub(super) const SINGLE: Self = Self { energy: 2.5e-7, force: 2.5e-7 };

    /// Whether U and F, of which the exact ones come first, agree.
    pub(super) fn holds(self, energy: [f64; 2], force: [f64; 2]) -> bool {
        let within = |[exact, found]: [f64; 2], share: f64| {
            (found - exact).abs() <= share * exact.abs().max(1.0)
        };
        within(energy, self.energy) && within(force, self.force)
    }
}
