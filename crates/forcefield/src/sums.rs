//! Totals over pairs, and their conversion to energetics.

use glam::{DMat3, DVec3};
use lennard_core::exact::exact_sum_over;
use lennard_core::{Energetics, Team, Want};

use crate::pair::Pair;

/// Energy (half of each pair), ε, and virial tensor (half of each pair), ε, of one particle.
pub type PerParticle = (f64, DMat3);

/// The quantities that a loop sums.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// Forces.
    Forces,
    /// Forces and the totals, without the tensor of the virial.
    Totals,
    /// Forces, totals with the tensor, and energy and virial of each particle.
    Everything,
}

/// The matrix a ⊗ b.
pub fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Totals over pairs. A loop over full lists counts every pair from both of its ends: [`Totals::of_both_ends`] counts them once.
#[derive(Debug, Clone, Copy)]
pub struct Totals {
    /// Σ U, ε.
    pub energy: f64,
    /// Σ r_ij·F_ij, ε.
    pub virial_trace: f64,
    /// Σ r_ij ⊗ F_ij, ε; it has no meaning where only totals were asked for.
    pub virial: DMat3,
    /// Σ (U″ + 2U′/r) of each end, ε/σ²: over both ends it is Σ_i ∇_i²U.
    pub laplacian: f64,
    /// Σ U(r_cut) of each pair where pairs of species differ, ε; 0 where the pairs are counted instead.
    pub at_cutoff: f64,
    /// Pairs with r ≤ r_cut.
    pub pairs: u64,
    /// Whether a force was not finite.
    pub broken: bool,
}

impl Totals {
    /// The totals over no pair. (The default of a matrix is the identity, so there is no derived default.)
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
        let pairs = self.pairs as f64;
        let [u, w] = [self.energy, self.virial_trace];
        [u, w, self.laplacian, self.at_cutoff, pairs, a, b, c, d, e, f, g, h, i]
    }

    /// Adds one end of a pair, whose vector to the other end is −`r_ij`.
    #[inline(always)]
    pub fn add_end(&mut self, pair: &Pair<f64>, r_ij: DVec3) {
        self.energy += pair.energy;
        self.virial_trace += pair.force * r_ij.length_squared();
        self.virial += outer(r_ij, pair.force * r_ij);
        // ∇²U = U″ + 2U′/r.
        self.laplacian += pair.curvature - 2.0 * pair.force;
        self.pairs += 1;
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

    /// The totals of what some of these pairs leave of the whole: all pairs, and the whole energy at the cutoff.
    pub fn without(self, part: &Self) -> Self {
        Self {
            energy: self.energy - part.energy,
            virial_trace: self.virial_trace - part.virial_trace,
            virial: self.virial - part.virial,
            laplacian: self.laplacian - part.laplacian,
            ..self
        }
    }

    /// The exact totals of chunks, which contain every pair from both of its ends.
    ///
    /// The sum over a chunk has the order of its list, which no cut into tasks changes. The exact sum begins here.
    /// With a team, each rank has some of the chunks.
    pub fn of_chunks(chunks: &[Self], team: Option<&Team>) -> Self {
        Self::of_both_ends(exact_sum_over(team, chunks.len(), |c| chunks[c].numbers()))
    }

    /// The totals where [`Totals::numbers`] are summed over both ends of every pair.
    pub fn of_both_ends(sums: [f64; Self::NUMBERS]) -> Self {
        let [energy, virial_trace, laplacian, at_cutoff, pairs, virial @ ..] = sums;
        Self {
            energy: 0.5 * energy,
            virial_trace: 0.5 * virial_trace,
            virial: 0.5 * DMat3::from_cols_array(&virial),
            laplacian,
            at_cutoff: 0.5 * at_cutoff,
            pairs: pairs as u64 / 2,
            broken: false,
        }
    }

    /// The energetics that `want` asks for; `jump` is U(r_cut), which the conserved energy subtracts per pair where all pairs
    /// are alike.
    pub fn deliver(&self, want: Want, jump: f64, each: Option<Vec<PerParticle>>) -> Energetics {
        Energetics {
            potential_energy: want.energy.then_some(self.energy),
            conserved_potential: want
                .energy
                .then_some(self.energy - (self.pairs as f64 * jump + self.at_cutoff)),
            virial: want.virial_tensor.then_some(self.virial),
            virial_trace: want.virial.then_some(self.virial_trace),
            laplacian: want.laplacian.then_some(self.laplacian),
            pairs: want.energy.then_some(self.pairs),
            per_particle: each,
        }
    }
}
