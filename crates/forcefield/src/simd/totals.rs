//! Sums over one chunk of a list.

use glam::DMat3;

/// Energy (half of each pair), ε, and virial tensor (half of each pair), ε, of one particle.
pub type PerParticle = (f64, DMat3);

/// The quantities that a loop sums.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// Forces.
    Forces,
    /// Forces and the totals of the chunk, without the tensor of the virial.
    Totals,
    /// Forces, totals with the tensor, and energy and virial of each particle.
    Everything,
}

/// Sums over one chunk. A full list contains every pair twice, so that each sum is twice the share of the chunk.
#[derive(Debug, Clone, Copy)]
pub struct ChunkTotals {
    /// Σ U, ε.
    pub energy: f64,
    /// Σ r_ij·F_ij, ε.
    pub virial_trace: f64,
    /// Σ r_ij ⊗ F_ij, ε; it has no meaning where only totals are asked for.
    pub virial: DMat3,
    /// Σ (U″ + 2U′/r), ε/σ².
    pub laplacian: f64,
    /// Σ U(r_cut) of pairs where pairs of species differ, ε; 0 where pairs are counted instead.
    pub at_cutoff: f64,
    /// Number of pairs with r ≤ r_cut.
    pub pairs: u64,
    /// Whether a force was not finite.
    pub broken: bool,
}

impl ChunkTotals {
    /// The sums over no pair. (The default of a matrix is the identity, so there is no derived default.)
    pub const NOTHING: Self = Self {
        energy: 0.0,
        virial_trace: 0.0,
        virial: DMat3::ZERO,
        laplacian: 0.0,
        at_cutoff: 0.0,
        pairs: 0,
        broken: false,
    };

    /// Numbers that are summed.
    pub const NUMBERS: usize = 14;

    /// Energy, trace of the virial, Laplacian, energy at the cutoff, number of pairs, and the components of the virial.
    pub fn numbers(&self) -> [f64; Self::NUMBERS] {
        let [a, b, c, d, e, f, g, h, i] = self.virial.to_cols_array();
        [
            self.energy,
            self.virial_trace,
            self.laplacian,
            self.at_cutoff,
            self.pairs as f64,
            a,
            b,
            c,
            d,
            e,
            f,
            g,
            h,
            i,
        ]
    }

    /// Adds the sums over other pairs.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        self.energy += other.energy;
        self.virial_trace += other.virial_trace;
        self.virial += other.virial;
        self.laplacian += other.laplacian;
        self.at_cutoff += other.at_cutoff;
        self.pairs += other.pairs;
    }
}
