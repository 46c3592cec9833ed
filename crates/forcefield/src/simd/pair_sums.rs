//! Sums over pairs besides the forces, the same for every loop.

use glam::DMat3;

use super::lanes::Lanes;
use super::pair_loop::ChunkTotals;
use crate::potential::Pair;

/// Running sums, a lane each.
#[derive(Clone, Copy)]
pub struct PairSums<L> {
    energy: L,
    laplacian: L,
    /// xx, yy, zz, xy, xz, yz.
    virial: [L; 6],
    pairs: u32,
}

/// What a loop counts in.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    /// Energies, also those in −U′/r and U″, ε.
    pub energy: f64,
    /// Distances, σ.
    pub length: f64,
}

impl Units {
    /// Those of sums of −U′/r times a distance, ε/σ.
    #[inline(always)]
    pub fn force(self) -> f64 {
        self.energy * self.length
    }

    /// Those of sums of −U′/r times two distances, ε.
    #[inline(always)]
    fn virial(self) -> f64 {
        self.energy * self.length * self.length
    }
}

/// What a loop sums besides the forces.
pub trait Besides<L: Lanes>: Copy {
    /// Whether that is anything.
    const ANYTHING: bool;

    /// No pair yet.
    fn nothing() -> Self;

    /// Adds the pairs `inside`, a distance `r_ij` apart, whose −U′/r is `f`, zero in all other lanes, in any units.
    fn add(&mut self, r_ij: [L; 3], f: L, pair: &Pair<L>, inside: L::Mask);

    /// The sums over all lanes.
    fn totals(&self, units: Units) -> ChunkTotals;
}

/// Nothing: it takes no room, which a compiler would otherwise clear for every particle.
#[derive(Clone, Copy)]
pub struct ForcesAlone;

impl<L: Lanes> Besides<L> for ForcesAlone {
    const ANYTHING: bool = false;

    #[inline(always)]
    fn nothing() -> Self {
        Self
    }

    #[inline(always)]
    fn add(&mut self, _r_ij: [L; 3], _f: L, _pair: &Pair<L>, _inside: L::Mask) {}

    #[inline(always)]
    fn totals(&self, _units: Units) -> ChunkTotals {
        ChunkTotals::NOTHING
    }
}

impl<L: Lanes> Besides<L> for PairSums<L> {
    const ANYTHING: bool = true;

    #[inline(always)]
    fn nothing() -> Self {
        let zero = L::splat(0.0);
        Self {
            energy: zero,
            laplacian: zero,
            virial: [zero; 6],
            pairs: 0,
        }
    }

    #[inline(always)]
    fn add(&mut self, r_ij: [L; 3], f: L, pair: &Pair<L>, inside: L::Mask) {
        let [dx, dy, dz] = r_ij;
        self.pairs += L::count(inside);
        self.energy = self.energy + pair.energy.keep(inside);
        let curvature = pair.curvature.keep(inside);
        self.laplacian = self.laplacian + f.mul_add(L::splat(-2.0), curvature);
        let [xx, yy, zz, xy, xz, yz] = &mut self.virial;
        let (fx, fy, fz) = (dx * f, dy * f, dz * f);
        *xx = dx.mul_add(fx, *xx);
        *yy = dy.mul_add(fy, *yy);
        *zz = dz.mul_add(fz, *zz);
        *xy = dx.mul_add(fy, *xy);
        *xz = dx.mul_add(fz, *xz);
        *yz = dy.mul_add(fz, *yz);
    }

    #[inline(always)]
    fn totals(&self, units: Units) -> ChunkTotals {
        let [xx, yy, zz, xy, xz, yz] = self.virial;
        let (xy, xz, yz) = (xy.sum(), xz.sum(), yz.sum());
        let virial = [xx.sum(), xy, xz, xy, yy.sum(), yz, xz, yz, zz.sum()];
        ChunkTotals {
            energy: units.energy * self.energy.sum(),
            virial: units.virial() * DMat3::from_cols_array(&virial),
            laplacian: units.energy * self.laplacian.sum(),
            pairs: u64::from(self.pairs),
            broken: false,
        }
    }
}
