//! What a loop over lists writes for each particle.

use glam::DVec3;
use lennard_neighbor::ATOMS_PER_CHUNK;

use super::Scatter;
use super::lanes::Lanes;
use super::pair_loop::{ChunkTotals, PerParticle};
use super::pair_sums::Besides;

/// Forces, and the entries of each particle where they are wanted.
pub struct Output<'a> {
    forces: Scatter<'a, DVec3>,
    each: Option<Scatter<'a, PerParticle>>,
    /// The element that belongs to each place from `first` on.
    order: &'a [u32],
    first: usize,
    soon: Soon<'a>,
}

/// What is asked for while forces are summed, since it will soon be written.
enum Soon<'a> {
    /// Forces, which lie anywhere in memory.
    Forces,
    /// Positions and velocities by place, as many as those whose forces are summed, for the next chunk. At once, they would
    /// keep all else from coming.
    State([&'a Scatter<'a, DVec3>; 2]),
    /// All is near.
    Nothing,
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
            soon: Soon::Forces,
        }
    }

    /// Forces of particles on their way, from the place `first` on; their positions and velocities, all of them by place, are
    /// written after those, and asked for where they are given.
    ///
    /// # Panics
    /// As [`Output::new`].
    pub fn on_the_way(
        forces: &'a mut [DVec3],
        order: &'a [u32],
        first: usize,
        state: Option<[&'a Scatter<'a, DVec3>; 2]>,
    ) -> Self {
        Self {
            soon: state.map_or(Soon::Nothing, Soon::State),
            ..Self::new(forces, None, order, first)
        }
    }

    /// Says that so many places from one on come next.
    #[inline(always)]
    pub fn prefetch(&self, place: usize, count: usize) {
        match self.soon {
            Soon::Forces => {
                let begin = place - self.first;
                if let Some(order) = self.order.get(begin..begin + count) {
                    for at in order {
                        self.forces.prefetch(*at as usize);
                    }
                }
            }
            Soon::State(state) => {
                let later = place + ATOMS_PER_CHUNK;
                for array in state {
                    array.prefetch(later);
                    array.prefetch(later + count - 1);
                }
            }
            Soon::Nothing => {}
        }
    }

    /// Writes what was found for the particle at a place and adds it to the totals of its chunk.
    ///
    /// # Safety
    /// No other thread writes what belongs to this place.
    #[inline(always)]
    pub unsafe fn write<L: Lanes, B: Besides<L>>(
        &self,
        place: usize,
        force: DVec3,
        besides: &B,
        totals: &mut ChunkTotals,
    ) {
        let at = self.order[place - self.first] as usize;
        // SAFETY: the contract is passed on.
        unsafe { self.forces.write(at, force) };
        if B::ANYTHING {
            let found = besides.totals();
            totals.add(&found);
            if let Some(each) = &self.each {
                // SAFETY: as above.
                unsafe { each.write(at, (0.5 * found.energy, 0.5 * found.virial)) };
            }
        }
    }
}
