//! The forms that loops compile in: 12-6 with its frequent truncations, and rows for nearly all others.
//!
//! Some forms of one species have a loop too, since rows would slow them down by more than a fifth (benches/NOTES.md).

use super::shape::{Constants, TwoPowers, sum};
use super::smoothstep::switched;
use super::{LennardJones, LjSpline, Pair};
use crate::number::{Number, PairRows};
use crate::simd::Lanes;

/// A truncated potential, as a loop compiles it in: valid for r ≤ r_cut. The loop's own comparison makes it zero beyond.
pub trait PairForm: Copy + Send + Sync {
    /// Whether U, −U′/r and U″ are 0 where 1/r² is 0, but for a constant that each pair adds to U. Loops of sums then mask
    /// 1/r² alone.
    const VANISHES: bool = false;
    /// The unit of energy of the form, ε: loops multiply their sums by it.
    const UNIT: f64;
    /// The constants of a pair of species as registers of `T` take them.
    fn constants<T: Number>(&self, of_pair: Constants<f64>) -> Constants<f64> {
        of_pair
    }
    /// U, −U′/r and U″ at r² = `r2` σ², for r ≤ r_cut, in [`PairForm::UNIT`]; `inv_r2` is 1/r².
    fn eval<L: Lanes>(&self, constants: Constants<L>, r2: L, inv_r2: L) -> Pair<L>;
    /// Returns −U′/r with the bits of [`PairForm::eval`], and adds the pair to three sums that [`PairForm::totals`] understands.
    ///
    /// A potential of two powers sums the powers, which takes the fewest operations.
    #[inline(always)]
    fn add_up<L: Lanes>(
        &self,
        constants: Constants<L>,
        r2: L,
        inv_r2: L,
        sums: [L; 3],
    ) -> (L, [L; 3]) {
        self.eval(constants, r2, inv_r2).add_up(r2, sums)
    }
    /// Σ U, Σ −r·U′ and Σ (U″ + 2U′/r) from the sums of [`PairForm::add_up`] over so many pairs.
    fn totals(&self, _constants: Constants<f64>, sums: [f64; 3], _pairs: u64) -> [f64; 3] {
        sums
    }
}

impl<L: Lanes> Pair<L> {
    /// The values where the mask holds, zero elsewhere.
    #[inline(always)]
    pub(crate) fn keep(self, inside: L::Mask) -> Self {
        Self {
            energy: self.energy.keep(inside),
            force: self.force.keep(inside),
            curvature: self.curvature.keep(inside),
        }
    }
}

/// 12-6 with U less a constant, which is 0 at a plain cutoff.
#[derive(Clone, Copy, Debug)]
pub struct TwelveSix;

impl PairForm for TwelveSix {
    const VANISHES: bool = true;
    const UNIT: f64 = LennardJones::UNIT;

    #[inline(always)]
    fn eval<L: Lanes>(&self, [shift, ..]: Constants<L>, _r2: L, inv_r2: L) -> Pair<L> {
        let pair = LennardJones::values(inv_r2);
        Pair { energy: pair.energy - shift, ..pair }
    }

    #[inline(always)]
    fn add_up<L: Lanes>(
        &self,
        _constants: Constants<L>,
        _r2: L,
        inv_r2: L,
        sums: [L; 3],
    ) -> (L, [L; 3]) {
        LennardJones::add_up(inv_r2, sums)
    }

    fn totals(&self, [shift, ..]: Constants<f64>, sums: [f64; 3], pairs: u64) -> [f64; 3] {
        let [energy, virial, laplacian] = LennardJones::totals(sums);
        [energy - pairs as f64 * shift, virial, laplacian]
    }
}

/// 12-6 with a linear force shift; [`super::Truncation::ForceShift`] gives the constants.
#[derive(Clone, Copy, Debug)]
pub struct ForceShifted;

impl PairForm for ForceShifted {
    const UNIT: f64 = LennardJones::UNIT;

    #[inline(always)]
    fn eval<L: Lanes>(&self, [slope, constant, _]: Constants<L>, r2: L, inv_r2: L) -> Pair<L> {
        let pair = LennardJones::values(inv_r2);
        let r = r2.sqrt();
        Pair {
            energy: pair.energy - r.mul_add(slope, constant),
            force: inv_r2.sqrt().mul_add(slope, pair.force),
            curvature: pair.curvature,
        }
    }
}

/// 12-6 with the quintic switch; the step gives the constants.
#[derive(Clone, Copy, Debug)]
pub struct Switched;

impl PairForm for Switched {
    const UNIT: f64 = LennardJones::UNIT;

    #[inline(always)]
    fn eval<L: Lanes>(&self, [on, inv_width, _]: Constants<L>, r2: L, inv_r2: L) -> Pair<L> {
        switched(LennardJones::values(inv_r2), [on, inv_width], r2)
    }
}

/// Lennard-Jones/spline, which has no constants.
#[derive(Clone, Copy, Debug)]
pub struct Spline;

impl PairForm for Spline {
    const UNIT: f64 = LennardJones::UNIT;

    #[inline(always)]
    fn eval<L: Lanes>(&self, _constants: Constants<L>, r2: L, inv_r2: L) -> Pair<L> {
        LjSpline::values(r2, inv_r2)
    }
}

impl PairForm for TwoPowers {
    const VANISHES: bool = true;
    const UNIT: f64 = 1.0;

    #[inline(always)]
    fn eval<L: Lanes>(&self, [shift, of_n, of_m]: Constants<L>, _r2: L, inv_r2: L) -> Pair<L> {
        let pair = self.values([of_n, of_m], inv_r2);
        Pair { energy: pair.energy - shift, ..pair }
    }

    /// Sums Σ C_n·r⁻ⁿ, Σ C_m·r⁻ᵐ and Σ (n(n−1)·C_n·r⁻ⁿ − m(m−1)·C_m·r⁻ᵐ)/r².
    #[inline(always)]
    fn add_up<L: Lanes>(
        &self,
        [_, c_n, c_m]: Constants<L>,
        _r2: L,
        inv_r2: L,
        [of_n, of_m, laplacian]: [L; 3],
    ) -> (L, [L; 3]) {
        let (n, m) = (f64::from(self.n), f64::from(self.m));
        let powers = self.powers([c_n, c_m], inv_r2);
        let of_laplacian = sum(powers, n * (n - 1.0), m * (m - 1.0));
        let sums = [of_n + powers.0, of_m + powers.1, inv_r2.mul_add(of_laplacian, laplacian)];
        (inv_r2 * sum(powers, n, m), sums)
    }

    fn totals(
        &self,
        [shift, ..]: Constants<f64>,
        [of_n, of_m, laplacian]: [f64; 3],
        pairs: u64,
    ) -> [f64; 3] {
        let (n, m) = (f64::from(self.n), f64::from(self.m));
        [of_n - of_m - pairs as f64 * shift, n * of_n - m * of_m, laplacian]
    }
}

/// Any form by its rows; [`PairRows::constants`] gives the constants.
#[derive(Clone, Copy, Debug)]
pub struct ByRows<'a>(pub &'a PairRows);

impl PairForm for ByRows<'_> {
    const UNIT: f64 = 1.0;

    fn constants<T: Number>(&self, [scale, rows, half]: Constants<f64>) -> Constants<f64> {
        [scale, T::rows(self.0).first_of(rows), half]
    }

    /// −U′/r = g₀ + d·(g₁ + d·(g₂ + d·g₃)) at a distance d from the begin of a row, U = u − ½∫ −U′/r ds and U″ = U′/r − 2s·d(−U′/r)/ds.
    #[inline(always)]
    fn eval<L: Lanes>(&self, [scale, first, half]: Constants<L>, r2: L, _inv_r2: L) -> Pair<L> {
        let s = r2 * scale;
        let (d, [u, g0, g1, g2, g3]) = s.look_up(L::Number::rows(self.0), first);
        let number = |value: f64| r2.splat(value);
        let force = d.mul_add(d.mul_add(d.mul_add(g3, g2), g1), g0);
        let integral = d.mul_add(g3 * number(0.25), g2 * number(1.0 / 3.0));
        let integral = d.mul_add(d.mul_add(integral, g1 * number(0.5)), g0);
        let change = d.mul_add(d.mul_add(g3 * number(3.0), g2 + g2), g1);
        Pair {
            energy: u - d * half * integral,
            force,
            curvature: (s * number(-2.0)).mul_add(change, -force),
        }
    }
}
