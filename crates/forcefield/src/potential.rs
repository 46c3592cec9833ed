//! Pair potentials without any cutoff, each written once over the number type.

use crate::real::Real;

/// The smallest soft-sphere exponent: below it the tail integrals diverge.
pub const SMALLEST_EXPONENT: u32 = 4;
/// The largest soft-sphere exponent: above it an overlap of 1e-4 σ overflows.
pub const LARGEST_EXPONENT: u32 = 72;

/// 2^{1/6} σ, the minimum of the Lennard-Jones potential and the end of the WCA potential.
pub const LENNARD_JONES_MINIMUM: f64 = 1.122_462_048_309_373;

/// What a pair formula gives at a distance r, in ε or in another unit of energy that it says.
#[derive(Clone, Copy, Debug)]
pub struct Pair<R> {
    /// U(r), ε.
    pub energy: R,
    /// −U′(r)/r, ε/σ²: the force on i is this times r_ij = r_i − r_j.
    pub force: R,
    /// U″(r), ε/σ².
    pub curvature: R,
}

impl<R: Real> Pair<R> {
    /// The same in ε, where it counts in units of so many ε.
    #[inline(always)]
    pub(crate) fn in_epsilon(self, unit: f64) -> Self {
        let unit = R::splat(unit);
        Self {
            energy: self.energy * unit,
            force: self.force * unit,
            curvature: self.curvature * unit,
        }
    }
}

/// U(r) without any cutoff. Not object-safe, on purpose: it is compiled into each kernel.
pub trait PairPotential: Copy + Send + Sync + 'static {
    /// The unit of energy that the formula counts in, ε: what is a factor of every pair is a factor of the sums, where it
    /// costs nothing.
    const UNIT: f64 = 1.0;
    /// U, −U′/r and U″ where 1/r² is `inv_r2` σ⁻², in [`PairPotential::UNIT`].
    fn eval<R: Real>(&self, inv_r2: R) -> Pair<R>;
    /// ∫ r² U dr from `r_cut` to ∞, ε·σ³.
    fn tail_energy(&self, r_cut: f64) -> f64;
    /// ∫ r³ U′ dr from `r_cut` to ∞, ε·σ³.
    fn tail_virial(&self, r_cut: f64) -> f64;
}

/// Lennard-Jones 12-6: U = 4·(r⁻¹² − r⁻⁶), −U′/r = 24·(2r⁻¹² − r⁻⁶)/r², U″ = (624r⁻¹² − 168r⁻⁶)/r².
///
/// J. E. Lennard-Jones, "On the determination of molecular fields. II", Proc. R. Soc. A 106 (1924) 463,
/// in the form of M. P. Allen and D. J. Tildesley, "Computer Simulation of Liquids", eq. 1.6.
#[derive(Clone, Copy, Debug)]
pub struct LennardJones;

impl PairPotential for LennardJones {
    const UNIT: f64 = 48.0;

    #[inline(always)]
    fn eval<R: Real>(&self, inv_r2: R) -> Pair<R> {
        let inv_r4 = inv_r2 * inv_r2;
        let inv_r6 = inv_r4 * inv_r2;
        let inv_r8 = inv_r4 * inv_r4;
        Pair {
            energy: inv_r6 * inv_r6.mul_add(R::splat(1.0 / 12.0), R::splat(-1.0 / 12.0)),
            // r⁻⁸·(r⁻⁶ − 1/2): one multiplication less than with r⁻⁶ times a factor.
            force: inv_r8 * inv_r4.mul_add(inv_r2, R::splat(-0.5)),
            curvature: inv_r8 * inv_r6.mul_add(R::splat(13.0), R::splat(-3.5)),
        }
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

/// Weeks–Chandler–Andersen: U = 4·(r⁻¹² − r⁻⁶) + 1 inside 2^{1/6} σ, where the cutoff ends it.
///
/// J. D. Weeks, D. Chandler and H. C. Andersen, "Role of repulsive forces in determining the
/// equilibrium structure of simple liquids", J. Chem. Phys. 54 (1971) 5237, eq. 4.
#[derive(Clone, Copy, Debug)]
pub struct Wca;

impl PairPotential for Wca {
    const UNIT: f64 = LennardJones::UNIT;

    #[inline(always)]
    fn eval<R: Real>(&self, inv_r2: R) -> Pair<R> {
        let pair = LennardJones.eval(inv_r2);
        Pair {
            energy: pair.energy + R::splat(1.0 / Self::UNIT),
            ..pair
        }
    }

    fn tail_energy(&self, _r_cut: f64) -> f64 {
        0.0
    }

    fn tail_virial(&self, _r_cut: f64) -> f64 {
        0.0
    }
}

/// Soft sphere, the inverse power: U = r⁻ⁿ, −U′/r = n·r⁻ⁿ/r², U″ = n(n+1)·r⁻ⁿ/r².
///
/// W. G. Hoover, M. Ross, K. W. Johnson, D. Henderson, J. A. Barker and B. C. Brown, "Soft-sphere
/// equation of state", J. Chem. Phys. 52 (1970) 4931, eq. 1.
#[derive(Clone, Copy, Debug)]
pub struct SoftSphere {
    /// The exponent n.
    pub exponent: u32,
}

impl PairPotential for SoftSphere {
    #[inline(always)]
    fn eval<R: Real>(&self, inv_r2: R) -> Pair<R> {
        let mut energy = if self.exponent % 2 == 1 {
            inv_r2.sqrt()
        } else {
            R::splat(1.0)
        };
        // r⁻ⁿ by squaring: the exponent is the same for all lanes.
        let mut bits = self.exponent / 2;
        let mut power = inv_r2;
        while bits > 0 {
            if bits % 2 == 1 {
                energy = energy * power;
            }
            power = power * power;
            bits /= 2;
        }
        let n = f64::from(self.exponent);
        let scaled = energy * inv_r2;
        Pair {
            energy,
            force: scaled * R::splat(n),
            curvature: scaled * R::splat(n * (n + 1.0)),
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
