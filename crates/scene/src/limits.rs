//! Limits of scenes: beyond them, numbers overflow, vanish or mean nothing.

/// The most particles that a scene may ask for; their numbers must fit in 32 bits with room to spare.
pub(crate) const MOST_ATOMS: i64 = 1_000_000_000;
/// The longest box side in σ: beyond it, image flags and the last digits of positions get scarce.
pub(crate) const LONGEST_SIDE: f64 = 1e6;
/// The shortest length of a slab, σ: below it there is no liquid.
pub(crate) const SHORTEST_SIDE: f64 = 1.0;
/// The lowest and the highest temperature of a heat bath, ε/k_B: far outside, numbers overflow or vanish on the way.
pub(crate) const COLDEST: f64 = 1e-9;
pub(crate) const HOTTEST: f64 = 1e6;
/// The lowest and the highest number density, σ⁻³: one particle in the longest box, and far beyond any solid.
pub(crate) const THINNEST: f64 = 1e-18;
pub(crate) const DENSEST: f64 = 1e3;
/// The lowest and the highest pressure of a barostat, ε/σ³: far outside, numbers vanish or overflow on the way.
pub(crate) const LEAST_PRESSURE: f64 = 1e-12;
pub(crate) const LARGEST_PRESSURE: f64 = 1e6;
/// The shortest and the longest time step, τ: far below, the time of a run no longer moves.
pub(crate) const SHORTEST_STEP: f64 = 1e-9;
pub(crate) const LONGEST_STEP: f64 = 1e3;
/// The most stages, and the most observables.
pub(crate) const MOST_ENTRIES: usize = 1000;
