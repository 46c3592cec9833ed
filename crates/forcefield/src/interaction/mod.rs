//! What particles do to each other.
//!
//! ```text
//!   Pairwise       the whole force or its near part: the formula for one pair, and the loops over lists
//!   NearPart       the weight of the near part
//!   OneSpecies     one form and its cutoff; species are never looked at
//!   ManySpecies    one form, and a table of numbers for each pair of species
//! ```
//!
//! A loop in lanes takes the numbers of one particle first (`own`), and with each register of neighbors their species.

mod many_species;
mod near_part;
mod one_species;
mod pairwise;

pub use many_species::ManySpecies;
pub use near_part::NearPart;
pub use one_species::OneSpecies;
pub use pairwise::{NoRows, Pairwise};

use crate::number::Number;
use crate::pair::Pair;
use crate::simd::Lanes;

/// The interaction of particles. A loop compiles it in.
pub trait Interaction: Copy + Send + Sync {
    /// The unit of energy of all values, ε: loops multiply their sums by it.
    const UNIT: f64;
    /// The numbers of the interaction for registers of `T`, in the units of a loop.
    type Numbers<T: Number>: Send + Sync;
    /// The numbers of the interaction with one particle, in registers.
    type Own<L: Lanes>: Copy;

    /// The numbers for a loop whose unit of length is `length` σ, and whose list ends at `r_cut` σ.
    fn numbers<T: Number>(&self, r_cut: f64, length: f64) -> Self::Numbers<T>;

    /// The numbers of a particle with this row.
    fn own<L: Lanes>(isa: L::Isa, numbers: &Self::Numbers<L::Number>, row: &L::Row)
    -> Self::Own<L>;

    /// r_cut² with each neighbor, in units of the loop.
    fn r_cut2<L: Lanes>(own: &Self::Own<L>, neighbors: L::Species) -> L;

    /// The values with each neighbor at `r2` in units of the loop, which are `IN_SIGMA` or not.
    fn eval<L: Lanes, const IN_SIGMA: bool>(
        &self,
        own: &Self::Own<L>,
        neighbors: L::Species,
        r2: L,
    ) -> Pair<L>;

    /// Returns −U′/r of the pairs `inside`, zero elsewhere, with the bits of [`Interaction::eval`]; adds these pairs to three
    /// sums that [`Interaction::totals`] understands.
    #[inline(always)]
    fn add_up<L: Lanes, const IN_SIGMA: bool>(
        &self,
        own: &Self::Own<L>,
        neighbors: L::Species,
        r2: L,
        inside: L::Mask,
        sums: [L; 3],
    ) -> (L, [L; 3]) {
        let pair = self.eval::<L, IN_SIGMA>(own, neighbors, r2);
        pair.keep(inside).add_up(r2, sums)
    }

    /// Σ U, Σ −r·U′ and Σ (U″ + 2U′/r) in [`Interaction::UNIT`], from the sums over so many pairs in a loop whose unit of length
    /// is `length` σ.
    fn totals(&self, [energy, virial, laplacian]: [f64; 3], _pairs: u64, length: f64) -> [f64; 3] {
        [energy, length * length * virial, laplacian]
    }

    /// U(r_cut) with each neighbor; none where pairs are counted instead.
    fn at_cutoff<L: Lanes>(own: &Self::Own<L>, neighbors: L::Species) -> Option<L>;
}
