//! Packing ahead: a chunk prefetches the arrays of the next chunk, and packs its own rows of the next step.
//!
//! ```text
//!   step k      chunk 0: forces, kick, drift, pack | chunk 1: forces, kick, drift, pack | ...
//!                           reads rows of step k, writes rows of step k + 1
//!   step k + 1  rows are packed already: judge the list, then run chunks
//! ```
//!
//! This file is the only place that fused steps hook into for it. Nothing but speed depends on it.

use lennard_neighbor::{ATOMS_PER_CHUNK, PackedDisplacement};

use crate::simd::disjoint::Disjoint;
use crate::simd::level::Level;
use crate::simd::motion::{Motion, MotionSummary};
use crate::simd::pack::pack_displacements;
use crate::simd::packed_list::PackedList;
use crate::simd::prefetch::{NextChunk, Region};

const _: () = assert!(ATOMS_PER_CHUNK <= u64::BITS as usize, "one bit per particle");

/// How far the particles of a chunk have moved since the build of the list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChunkDisplacement {
    /// An upper bound of all |d|, σ.
    bound: f64,
    /// The largest |d|², σ²; 0 where the bound shows that no particle moved far.
    largest2: f64,
    /// The particles that moved far, one bit each.
    far: u64,
}

impl ChunkDisplacement {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { bound: f64::INFINITY, largest2: 0.0, far: 0 };

    /// The displacement after one more step of at most `step` σ.
    fn after(self, step: f64) -> Self {
        Self { bound: self.bound + step, largest2: 0.0, far: 0 }
    }

    /// Classifies particles by |d|²: above `far2` a particle counts as far.
    fn by(squares: &[f64], far2: f64) -> Self {
        let (mut largest2, mut far, mut finite) = (0.0, 0, true);
        for (k, d2) in squares.iter().enumerate() {
            largest2 = if *d2 > largest2 { *d2 } else { largest2 };
            far |= u64::from(*d2 > far2) << k;
            // The comparison is false for NaN.
            finite &= *d2 < f64::INFINITY;
        }
        let largest2 = if finite { largest2 } else { f64::INFINITY };
        Self { bound: f64::sqrt(largest2), largest2, far }
    }

    /// Whether a particle may have moved far. The factor is a margin for rounding.
    fn may_be_far(&self, far2: f64) -> bool {
        // The comparison is false for NaN.
        let all_are_near = self.bound * self.bound * (1.0 + 1e-9) <= far2;
        !all_are_near
    }

    /// The summary of all chunks, where `first_slot` gives the first slot of each.
    pub fn summary(chunks: &[Self], first_slot: impl Fn(usize) -> usize) -> MotionSummary {
        let mut summary = MotionSummary::NOTHING;
        for (c, chunk) in chunks.iter().enumerate() {
            summary.largest2 = summary.largest2.max(chunk.largest2);
            summary.finite &= chunk.largest2.is_finite();
            let mut far = chunk.far;
            while far != 0 {
                let slot = first_slot(c) + far.trailing_zeros() as usize;
                summary.far.push(slot as u32);
                far &= far - 1;
            }
        }
        summary
    }
}

/// The arrays that chunks write for the next step.
pub struct NextRows<'a, Row> {
    /// Rows of the next step.
    pub rows: Disjoint<'a, Row>,
    /// The displacement of each chunk.
    pub displacements: Disjoint<'a, ChunkDisplacement>,
    /// Packed displacements, where they are wanted.
    pub packed: Option<Disjoint<'a, PackedDisplacement>>,
}

/// The hook of a fused step: what a chunk does for the next chunk and for the next step.
pub struct Ahead<'a, P: PackedList> {
    /// The list.
    pub list: &'a P,
    /// The instruction set of the loops.
    pub level: Level,
    /// Positions and velocities by slot, where they are worth a prefetch.
    pub state: Option<[Region; 2]>,
    /// Positions of the build by slot.
    pub built: Region,
    /// The |d|² beyond which a particle moved far, σ².
    pub far2: f64,
}

impl<P: PackedList> Ahead<'_, P> {
    /// The arrays that a loop over one chunk prefetches for the next chunk.
    ///
    /// # Safety
    /// No other thread runs this chunk.
    pub unsafe fn next_chunk(
        &self,
        chunk: usize,
        next: Option<&NextRows<'_, P::Row>>,
    ) -> Option<NextChunk> {
        let [positions, velocities] = self.state?;
        let rows = next.map_or(positions.first_line(), |next| next.rows.region());
        // SAFETY: the contract is passed on.
        let will_look = next.is_some_and(|next| unsafe { self.will_look(chunk, next) });
        Some(NextChunk {
            to_write: [positions, velocities, rows],
            to_read: if will_look { self.built } else { self.built.first_line() },
        })
    }

    /// Whether the next chunk will probably compute its displacements.
    ///
    /// # Safety
    /// As [`Ahead::next_chunk`].
    unsafe fn will_look(&self, chunk: usize, next: &NextRows<'_, P::Row>) -> bool {
        // Neighboring chunks move alike, and only the own entry may be read here.
        // SAFETY: the contract is passed on.
        let bound = unsafe { next.displacements.read(chunk) }.bound;
        // The factor leaves room for one more step.
        next.packed.is_some() || bound * bound > 0.8 * self.far2
    }

    /// Packs the rows of a chunk whose particles just moved by at most `step` σ.
    ///
    /// # Safety
    /// No other thread runs this chunk.
    pub unsafe fn pack(
        &self,
        chunk: usize,
        next: Option<&NextRows<'_, P::Row>>,
        motion: Motion<'_>,
        step: f64,
    ) {
        let (Some(next), Some(pack)) = (next, P::PACK_AHEAD) else {
            return;
        };
        let slots = self.list.chunk_slots().of(chunk..chunk + 1);
        let first = slots.start;
        // SAFETY: the elements of a chunk belong to this thread by contract.
        let mut displacement = unsafe { next.displacements.read(chunk) }.after(step);
        let mut squares = [0.0; ATOMS_PER_CHUNK];
        let squares = &mut squares[..slots.len()];
        let looks = next.packed.is_some() || displacement.may_be_far(motion.far2);
        let wanted = looks.then_some(&mut *squares);
        // SAFETY: as above.
        unsafe { pack(self.list, self.level, motion, first, wanted, &next.rows) };
        if looks {
            displacement = ChunkDisplacement::by(squares, motion.far2);
        }
        if let Some(packed) = &next.packed {
            // SAFETY: as above.
            pack_displacements(self.level, motion, squares, unsafe { packed.part(slots) });
        }
        // SAFETY: as above.
        unsafe { next.displacements.write(chunk, displacement) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chunk_is_looked_at_once_its_steps_add_up_to_far() {
        let far2 = 0.25;
        assert!(ChunkDisplacement::UNKNOWN.may_be_far(far2));
        assert!(ChunkDisplacement::UNKNOWN.after(0.1).may_be_far(far2));
        let mut displacement = ChunkDisplacement::by(&[0.01, 0.04], far2);
        for _ in 0..2 {
            assert!(!displacement.may_be_far(far2));
            displacement = displacement.after(0.16);
        }
        assert!(displacement.may_be_far(far2), "0.2 and twice 0.16 exceed one half");
        assert!(displacement.after(f64::NAN).may_be_far(far2));
        assert!(displacement.after(f64::INFINITY).may_be_far(far2));
    }

    #[test]
    fn the_summary_of_chunks_is_that_of_all_particles() {
        let squares: Vec<f64> =
            (0..3 * ATOMS_PER_CHUNK + 5).map(|i| f64::from(i as u32 % 7)).collect();
        let together = |squares: &[f64]| {
            let chunks = squares.chunks(ATOMS_PER_CHUNK);
            let chunks: Vec<ChunkDisplacement> =
                chunks.map(|squares| ChunkDisplacement::by(squares, 4.5)).collect();
            let mut at_once = MotionSummary::NOTHING;
            at_once.include(0, squares, 4.5);
            (ChunkDisplacement::summary(&chunks, |c| c * ATOMS_PER_CHUNK), at_once)
        };
        let (found, at_once) = together(&squares);
        assert_eq!(found, at_once);
        assert!(found.finite && found.far.len() > ATOMS_PER_CHUNK / 2);
        for broken in [f64::NAN, f64::INFINITY] {
            let mut squares = squares.clone();
            squares[60] = broken;
            assert!(!together(&squares).0.finite);
        }
    }
}
