//! One truncated potential for all pairs.

use super::Interaction;
use crate::number::Number;
use crate::pair::{Constants, Pair, PairForm};
use crate::simd::Lanes;

/// One truncated potential for all pairs.
#[derive(Clone, Copy)]
pub struct OneSpecies<F> {
    /// The form.
    pub form: F,
    /// Its constants.
    pub constants: Constants<f64>,
}

/// The cutoff, the units of a loop, and the constants of the form.
pub struct Cutoff {
    /// r_cut², in units of the loop.
    r_cut2: f64,
    /// The square of the length unit, σ².
    unit2: f64,
    /// The inverse of `unit2`, σ⁻².
    inv_unit2: f64,
    constants: Constants<f64>,
}

/// A [`Cutoff`] in registers.
#[derive(Clone, Copy)]
pub struct OwnCutoff<L> {
    r_cut2: L,
    unit2: L,
    inv_unit2: L,
    constants: Constants<L>,
}

impl<F: PairForm> Interaction for OneSpecies<F> {
    const UNIT: f64 = F::UNIT;
    type Numbers<T: Number> = Cutoff;
    type Own<L: Lanes> = OwnCutoff<L>;

    fn numbers<T: Number>(&self, r_cut: f64, length: f64) -> Cutoff {
        let unit2 = length * length;
        Cutoff {
            r_cut2: r_cut * r_cut / unit2,
            unit2,
            inv_unit2: 1.0 / unit2,
            constants: self.form.constants::<T>(self.constants),
        }
    }

    #[inline(always)]
    fn own<L: Lanes>(isa: L::Isa, numbers: &Cutoff, _row: &L::Row) -> OwnCutoff<L> {
        OwnCutoff {
            r_cut2: L::constant(isa, numbers.r_cut2),
            unit2: L::constant(isa, numbers.unit2),
            inv_unit2: L::constant(isa, numbers.inv_unit2),
            constants: [
                L::constant(isa, numbers.constants[0]),
                L::constant(isa, numbers.constants[1]),
                L::constant(isa, numbers.constants[2]),
            ],
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
            self.form.eval(own.constants, r2, r2.recip())
        } else {
            self.form.eval(own.constants, r2 * own.unit2, own.inv_unit2 / r2)
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
        self.form.add_up(own.constants, r2, inv_r2.keep(inside), sums)
    }

    fn totals(&self, sums: [f64; 3], pairs: u64, length: f64) -> [f64; 3] {
        if F::VANISHES {
            return self.form.totals(self.constants, sums, pairs);
        }
        let [energy, virial, laplacian] = sums;
        [energy, length * length * virial, laplacian]
    }

    #[inline(always)]
    fn at_cutoff<L: Lanes>(_own: &OwnCutoff<L>, _neighbors: L::Species) -> Option<L> {
        None
    }
}
