//! One truncated potential for all pairs.

use super::Interaction;
use crate::pair::{Pair, PairForm};
use crate::real::Number;
use crate::simd::Lanes;

/// One truncated potential for all pairs.
#[derive(Clone, Copy)]
pub struct OneSpecies<F>(pub F);

/// The cutoff and the units of a loop.
pub struct Cutoff {
    /// r_cut², in units of the loop.
    r_cut2: f64,
    /// The square of the length unit, σ².
    unit2: f64,
    /// The inverse of `unit2`, σ⁻².
    inv_unit2: f64,
}

/// A [`Cutoff`] in registers.
#[derive(Clone, Copy)]
pub struct OwnCutoff<L> {
    r_cut2: L,
    unit2: L,
    inv_unit2: L,
}

impl<F: PairForm> Interaction for OneSpecies<F> {
    const RARE: bool = F::RARE;
    const SHARES_LOOPS_OF_PARTS: bool = F::RARE;
    const UNIT: f64 = F::UNIT;
    type Numbers<T: Number> = Cutoff;
    type Own<L: Lanes> = OwnCutoff<L>;

    #[inline(always)]
    fn between(&self, _i: usize, _j: usize, r2: f64) -> Option<Pair<f64>> {
        Some(self.0.eval(r2, 1.0 / r2))
    }

    #[inline(always)]
    fn energy_at_cutoff(&self, _i: usize, _j: usize) -> f64 {
        0.0
    }

    fn numbers<T: Number>(&self, r_cut: f64, length: f64) -> Cutoff {
        let unit2 = length * length;
        Cutoff { r_cut2: r_cut * r_cut / unit2, unit2, inv_unit2: 1.0 / unit2 }
    }

    #[inline(always)]
    fn own<L: Lanes>(isa: L::Isa, numbers: &Cutoff, _row: &L::Row) -> OwnCutoff<L> {
        OwnCutoff {
            r_cut2: L::constant(isa, numbers.r_cut2),
            unit2: L::constant(isa, numbers.unit2),
            inv_unit2: L::constant(isa, numbers.inv_unit2),
        }
    }

    #[inline(always)]
    fn r_cut2<L: Lanes>(own: &OwnCutoff<L>, _neighbors: L::Species) -> L {
        own.r_cut2
    }

    #[inline(always)]
    fn eval<L: Lanes, const IN_SIGMA: bool>(
        &self,
        own: &OwnCutoff<L>,
        _neighbors: L::Species,
        r2: L,
    ) -> Pair<L> {
        if IN_SIGMA {
            self.0.eval(r2, r2.recip())
        } else {
            self.0.eval(r2 * own.unit2, own.inv_unit2 / r2)
        }
    }

    #[inline(always)]
    fn add_up<L: Lanes, const IN_SIGMA: bool>(
        &self,
        own: &OwnCutoff<L>,
        neighbors: L::Species,
        r2: L,
        inside: L::Mask,
        sums: [L; 3],
    ) -> (L, [L; 3]) {
        if !F::VANISHES {
            let pair = self.eval::<L, IN_SIGMA>(own, neighbors, r2);
            return pair.keep(inside).add_up(r2, sums);
        }
        let inv_r2 = if IN_SIGMA { r2.recip() } else { own.inv_unit2 / r2 };
        let r2 = Self::in_sigma::<L, IN_SIGMA>(own, r2);
        self.0.add_up(r2, inv_r2.keep(inside), sums)
    }

    fn totals(&self, sums: [f64; 3], pairs: u64, length: f64) -> [f64; 3] {
        if F::VANISHES {
            return self.0.totals(sums, pairs);
        }
        let [energy, virial, laplacian] = sums;
        [energy, length * length * virial, laplacian]
    }

    #[inline(always)]
    fn at_cutoff<L: Lanes>(_own: &OwnCutoff<L>, _neighbors: L::Species) -> Option<L> {
        None
    }

    #[inline(always)]
    fn in_sigma<L: Lanes, const IN_SIGMA: bool>(own: &OwnCutoff<L>, r2: L) -> L {
        if IN_SIGMA { r2 } else { r2 * own.unit2 }
    }
}
