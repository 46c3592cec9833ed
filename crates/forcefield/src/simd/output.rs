//! What a loop over lists writes for each particle.

use glam::DVec3;
use lennard_neighbor::ATOMS_PER_CHUNK;

use super::Scatter;
use super::lanes::Lanes;
use super::pair_loop::{ChunkTotals, PerParticle};
use super::pair_sums::{Besides, Units};
use super::prefetch::Later;

/// Forces, and the entries of each particle where they are wanted.
pub struct Output<'a> {
    forces: Scatter<'a, DVec3>,
    each: Option<Scatter<'a, PerParticle>>,
    /// The element that belongs to each place from `first` on.
    order: &'a [u32],
    first: usize,
    /// Arrays by place of which the next chunk needs its part.
    later: Option<Later>,
}

impl<'a> Output<'a> {
    /// Arrays with one element for each place from `first` on, in an order: that of the particles, each of which stands at
    /// one place.
    ///
    /// # Panics
    /// Where that is not so: that is a bug of the caller.
    pub fn new(
        forces: &'a mut [DVec3],
        each: Option<&'a mut [PerParticle]>,
        order: &'a [u32],
        first: usize,
    ) -> Self {
        assert_eq!(forces.len(), order.len(), "a force for each particle");
        if let Some(each) = &each {
            assert_eq!(each.len(), order.len(), "an entry for each particle");
        }
        Self {
            forces: Scatter::new(forces),
            each: each.map(Scatter::new),
            order,
            first,
            later: None,
        }
    }

    /// Forces of particles on their way, from the place `first` on; of arrays by place the part of the next chunk is asked for.
    ///
    /// # Panics
    /// As [`Output::new`].
    pub fn on_the_way(
        forces: &'a mut [DVec3],
        order: &'a [u32],
        first: usize,
        later: Option<Later>,
    ) -> Self {
        Self {
            later,
            ..Self::new(forces, None, order, first)
        }
    }

    /// Says that the forces of so many places from one on, which lie anywhere in memory, will soon be written.
    #[inline(always)]
    pub fn prefetch(&self, place: usize, count: usize) {
        let begin = place - self.first;
        if let Some(order) = self.order.get(begin..begin + count) {
            for at in order {
                self.forces.prefetch(*at as usize);
            }
        }
    }

    /// Says that the loop has come to so many places from one on: as much is asked for of what the next chunk needs, which
    /// would keep all else from coming if it were asked for at once.
    #[inline(always)]
    pub fn ask_for_later(&self, place: usize, count: usize) {
        if let Some(later) = &self.later {
            let place = place + ATOMS_PER_CHUNK;
            later.ask(place..place + count);
        }
    }

    /// Writes what was found for the particle at a place, its force in ε/σ and the rest in these units, and adds it to the
    /// totals of its chunk.
    ///
    /// # Safety
    /// No other thread writes what belongs to this place.
    #[inline(always)]
    pub unsafe fn write<L: Lanes, B: Besides<L>>(
        &self,
        place: usize,
        force: DVec3,
        besides: &B,
        units: Units,
        totals: &mut ChunkTotals,
    ) {
        let at = self.order[place - self.first] as usize;
        // SAFETY: the contract is passed on.
        unsafe { self.forces.write(at, force) };
        if B::ANYTHING {
            let found = besides.totals(units);
            totals.add(&found);
            if let Some(each) = &self.each {
                // SAFETY: as above.
                unsafe { each.write(at, (0.5 * found.energy, 0.5 * found.virial)) };
            }
        }
    }
}
