//! Pair potentials, their truncations and tail corrections, and the loops that sum them.
//!
//! A formula is written once, over a number type ([`real::Real`]); each loop compiles it in. The
//! reference loop stays for ever, and every other one is compared with it.

mod all_pairs;
mod canonical;
mod clock;
mod contact_law;
mod error;
mod field;
mod fused;
mod interaction;
mod listed;
pub mod measure;
mod non_finite;
mod number;
mod options;
mod pair;
mod part;
mod plan;
mod provider;
mod real;
mod reference;
mod simd;
mod sums;
mod validity;
mod walls;

pub use all_pairs::{AllPairs, CheckedForce};
pub use contact_law::{
    ContactLaw, ForcePoint, SMALLEST_SOFT_RESTITUTION, SpringLaw, damping_ratio_for, restitution_of,
};
pub use error::{ForceFieldError, LARGEST_N};
pub use field::ConstantField;
pub use options::{
    ForceFieldOptions, Kernel, KernelOptions, ListMode, NeighborOptions, Precision, SplitOptions,
};
pub use pair::potentials::*;
pub use pair::{
    CombiningOptions, CombiningSpec, CutoffUnit, Deviation, LONGEST_CUTOFF, Mixture, Model, Pair,
    SHORTEST_CUTOFF, Size, SpeciesPair, TablePath, Tail, Tolerance, TruncationKind,
    TruncationOptions, TruncationSpec, combining_rules, model_name, tail_correction, tail_in,
    tail_of_mixture, truncations,
};
pub use part::{FEWEST_ON_RANKS, LEAST_OF_A_RANK};
pub use plan::{Conditions, ForcePlan, Search, recommended_threads};
pub use provider::{PairForces, build};
pub use real::Real;
pub use simd::Isa;
pub use walls::{
    Hard, Hit, HitRule, KICKS_OF_REST, Rebound, Response, SHALLOWEST_ROOM, SlitPlanes, Soft,
    Surface, WallContext, WallForce, WallOptions, WallPair, WallSpec, Walls, walls,
};

/// Whether a force field can be built for these conditions; nothing is built.
///
/// # Errors
/// [`ForceFieldError`] as from [`build`].
pub fn check(o: &ForceFieldOptions, c: &Conditions<'_>) -> Result<(), ForceFieldError> {
    plan::decide(o, c).map(drop)
}

/// Names of the instruction sets that this processor has, widest first; each can be forced with `kernel.isa`.
#[must_use]
pub fn available_isas() -> Vec<&'static str> {
    simd::Level::available().into_iter().map(simd::Level::name).collect()
}
