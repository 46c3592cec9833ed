//! The arrays that a loop over lists writes.

use glam::DVec3;
use lennard_neighbor::ATOMS_PER_CHUNK;

use super::accumulate::{PairSums, Units};
use super::disjoint::Disjoint;
use super::lanes::Lanes;
use super::prefetch::NextChunk;
use crate::sums::{PerParticle, Totals};

/// Forces, and energy and virial of each particle where they are wanted.
pub struct Output<'a> {
    forces: Disjoint<'a, DVec3>,
    each: Option<Disjoint<'a, PerParticle>>,
    /// The element of each slot from `first` on.
    order: &'a [u32],
    first: usize,
    /// The arrays of the next chunk, in fused steps.
    next_chunk: Option<NextChunk>,
}

impl<'a> Output<'a> {
    /// Arrays with one element per slot from `first` on; `order` has the element of each slot, and no element twice.
    ///
    /// # Panics
    /// Where the arrays differ in length: that is a bug of the caller.
    pub fn new(
        forces: &'a mut [DVec3],
        each: Option<&'a mut [PerParticle]>,
        order: &'a [u32],
        first: usize,
    ) -> Self {
        assert_eq!(forces.len(), order.len(), "a force for each slot");
        if let Some(each) = &each {
            assert_eq!(each.len(), order.len(), "an entry for each slot");
        }
        Self {
            forces: Disjoint::new(forces),
            each: each.map(Disjoint::new),
            order,
            first,
            next_chunk: None,
        }
    }

    /// The forces of one chunk of a fused step, which prefetches the arrays of the next chunk.
    ///
    /// # Panics
    /// As [`Output::new`].
    pub fn of_chunk(
        forces: &'a mut [DVec3],
        order: &'a [u32],
        first: usize,
        next_chunk: Option<NextChunk>,
    ) -> Self {
        Self { next_chunk, ..Self::new(forces, None, order, first) }
    }

    /// Prefetches the forces of `count` slots from `slot` on, which lie anywhere in memory.
    #[inline(always)]
    pub fn prefetch(&self, slot: usize, count: usize) {
        let begin = slot - self.first;
        if let Some(order) = self.order.get(begin..begin + count) {
            for at in order {
                self.forces.prefetch(*at as usize);
            }
        }
    }

    /// Prefetches the part of the next chunk that corresponds to `count` slots from `slot` on.
    ///
    /// Prefetching the whole next chunk at once would delay all other loads.
    #[inline(always)]
    pub fn prefetch_next_chunk(&self, slot: usize, count: usize) {
        if let Some(next_chunk) = &self.next_chunk {
            let slot = slot + ATOMS_PER_CHUNK;
            next_chunk.prefetch(slot..slot + count);
        }
    }

    /// Writes the force of the particle at a slot, ε/σ, and its other sums, and adds these to the totals of the chunk.
    ///
    /// Where the sums have the tensor `alone` to add, the other totals come from common sums.
    ///
    /// # Safety
    /// No other thread writes the elements of this slot.
    #[inline(always)]
    pub unsafe fn write<L: Lanes>(
        &self,
        slot: usize,
        force: DVec3,
        (sums, alone): (Option<&PairSums<L>>, bool),
        units: Units,
        totals: &mut Totals,
    ) {
        let at = self.order[slot - self.first] as usize;
        // SAFETY: the contract is passed on.
        unsafe { self.forces.write(at, force) };
        if let Some(sums) = sums {
            let found = sums.totals(units);
            if alone {
                totals.virial += found.virial;
            } else {
                totals.add(&found);
            }
            if let Some(each) = &self.each {
                // SAFETY: as above.
                unsafe { each.write(at, (0.5 * found.energy, 0.5 * found.virial)) };
            }
        }
    }
}
