//! Sums over pairs in addition to the forces, the same for every loop.
//!
//! ```text
//!   PairSums     sums of one particle: energy, Laplacian, six components of the virial, pairs    many registers
//!   CommonSums   sums of several particles: three sums that give energy, virial and Laplacian, pairs    few registers
//! ```
//!
//! A loop has an array of one or of none of each. The length is known to the compiler, so that no sums take no time.

use glam::DMat3;

use super::lanes::Lanes;
use crate::interaction::Interaction;
use crate::pair::Pair;
use crate::sums::Totals;

/// The units that a loop computes in.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    /// Unit of energies, also in −U′/r and U″, ε.
    pub energy: f64,
    /// Unit of distances, σ.
    pub length: f64,
}

impl Units {
    /// Unit of −U′/r times a distance, ε/σ.
    #[inline(always)]
    pub fn force(self) -> f64 {
        self.energy * self.length
    }

    /// Unit of −U′/r times two distances, ε.
    #[inline(always)]
    fn virial(self) -> f64 {
        self.energy * self.length * self.length
    }
}

/// Energy, virial and Laplacian as three sums that the interaction understands; energy at the cutoff, and number of pairs.
#[derive(Clone, Copy)]
pub struct CommonSums<L: Lanes> {
    sums: [L; 3],
    /// Stays zero where pairs are counted instead.
    at_cutoff: L,
    pairs: u32,
}

/// −U′/r of the pairs `inside` at `r2`, zero in all other lanes, with the same bits for any sums. Adds these pairs to the sums.
#[inline(always)]
pub fn force<L: Lanes, I: Interaction, const IN_SIGMA: bool, const COMMON: usize>(
    interaction: &I,
    own: &I::Own<L>,
    neighbors: L::Species,
    (r2, inside): (L, L::Mask),
    sums: &mut [CommonSums<L>; COMMON],
) -> L {
    if COMMON == 0 {
        return interaction.eval::<L, IN_SIGMA>(own, neighbors, r2).force.keep(inside);
    }
    sums[0].force::<I, IN_SIGMA>(interaction, own, neighbors, r2, inside)
}

impl<L: Lanes> CommonSums<L> {
    /// The sums over no pair.
    #[inline(always)]
    pub fn nothing(isa: L::Isa) -> Self {
        let zero = L::constant(isa, 0.0);
        Self { sums: [zero; 3], at_cutoff: zero, pairs: 0 }
    }

    #[inline(always)]
    fn force<I: Interaction, const IN_SIGMA: bool>(
        &mut self,
        interaction: &I,
        own: &I::Own<L>,
        neighbors: L::Species,
        r2: L,
        inside: L::Mask,
    ) -> L {
        self.pairs += L::bits(inside).count_ones();
        if let Some(at_cutoff) = I::at_cutoff::<L>(own, neighbors) {
            self.at_cutoff = self.at_cutoff + at_cutoff.keep(inside);
        }
        let (force, sums) =
            interaction.add_up::<L, IN_SIGMA>(own, neighbors, r2, inside, self.sums);
        self.sums = sums;
        force
    }

    /// The sums over all lanes.
    #[inline(always)]
    pub fn totals<I: Interaction>(&self, interaction: &I, units: Units) -> Totals {
        let [a, b, c] = self.sums;
        let pairs = u64::from(self.pairs);
        let sums = [a.sum(), b.sum(), c.sum()];
        let [energy, virial_trace, laplacian] = interaction.totals(sums, pairs, units.length);
        Totals {
            energy: units.energy * energy,
            virial_trace: units.energy * virial_trace,
            virial: DMat3::ZERO,
            laplacian: units.energy * laplacian,
            at_cutoff: units.energy * self.at_cutoff.sum(),
            pairs,
            broken: false,
        }
    }
}

/// Energy, Laplacian, energy at the cutoff, virial and number of pairs, one sum per lane.
#[derive(Clone, Copy)]
pub struct PairSums<L: Lanes> {
    energy: L,
    laplacian: L,
    /// Stays zero where pairs are counted instead.
    at_cutoff: L,
    /// xx, yy, zz, xy, xz, yz.
    virial: [L; 6],
    pairs: u32,
}

impl<L: Lanes> PairSums<L> {
    /// The sums over no pair.
    #[inline(always)]
    pub fn nothing(isa: L::Isa) -> Self {
        let zero = L::constant(isa, 0.0);
        Self { energy: zero, laplacian: zero, at_cutoff: zero, virial: [zero; 6], pairs: 0 }
    }

    /// Adds the pairs `inside`, with distance vectors `r_ij` and −U′/r = `f`, which is zero in all other lanes.
    ///
    /// `at_cutoff` has U(r_cut) of each pair, where pairs of species differ.
    #[inline(always)]
    pub fn add(
        &mut self,
        r_ij: [L; 3],
        f: L,
        pair: &Pair<L>,
        at_cutoff: Option<L>,
        inside: L::Mask,
    ) {
        let [dx, dy, dz] = r_ij;
        self.pairs += L::bits(inside).count_ones();
        self.energy = self.energy + pair.energy.keep(inside);
        if let Some(at_cutoff) = at_cutoff {
            self.at_cutoff = self.at_cutoff + at_cutoff.keep(inside);
        }
        let curvature = pair.curvature.keep(inside);
        self.laplacian = self.laplacian + f.mul_add(f.splat(-2.0), curvature);
        let [xx, yy, zz, xy, xz, yz] = &mut self.virial;
        let (fx, fy, fz) = (dx * f, dy * f, dz * f);
        *xx = dx.mul_add(fx, *xx);
        *yy = dy.mul_add(fy, *yy);
        *zz = dz.mul_add(fz, *zz);
        *xy = dx.mul_add(fy, *xy);
        *xz = dx.mul_add(fz, *xz);
        *yz = dy.mul_add(fz, *yz);
    }

    /// The sums over all lanes.
    #[inline(always)]
    pub fn totals(&self, units: Units) -> Totals {
        let [xx, yy, zz, xy, xz, yz] = self.virial;
        let (xx, yy, zz) = (xx.sum(), yy.sum(), zz.sum());
        let (xy, xz, yz) = (xy.sum(), xz.sum(), yz.sum());
        let virial = [xx, xy, xz, xy, yy, yz, xz, yz, zz];
        Totals {
            energy: units.energy * self.energy.sum(),
            virial_trace: units.virial() * (xx + yy + zz),
            virial: units.virial() * DMat3::from_cols_array(&virial),
            laplacian: units.energy * self.laplacian.sum(),
            at_cutoff: units.energy * self.at_cutoff.sum(),
            pairs: u64::from(self.pairs),
            broken: false,
        }
    }
}
