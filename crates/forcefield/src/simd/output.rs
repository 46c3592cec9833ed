//! What a loop over lists writes for each particle.

use glam::DVec3;

use super::Scatter;
use super::lanes::Lanes;
use super::pair_loop::{ChunkTotals, PerParticle};
use super::pair_sums::Besides;

/// Forces, and the entries of each particle where they are wanted.
pub struct Output<'a> {
    forces: Scatter<'a, DVec3>,
    each: Option<Scatter<'a, PerParticle>>,
}

impl<'a> Output<'a> {
    /// Arrays with one element for each of `n` particles.
    ///
    /// # Panics
    /// Where that is not so: that is a bug of the caller.
    pub fn new(n: usize, forces: &'a mut [DVec3], each: Option<&'a mut [PerParticle]>) -> Self {
        assert_eq!(forces.len(), n, "a force for each particle");
        if let Some(each) = &each {
            assert_eq!(each.len(), n, "an entry for each particle");
        }
        Self {
            forces: Scatter::new(forces),
            each: each.map(Scatter::new),
        }
    }

    /// Says that forces of these particles will soon be written.
    #[inline(always)]
    pub fn prefetch(&self, particles: &[u32]) {
        for particle in particles {
            self.forces.prefetch(*particle as usize);
        }
    }

    /// Writes what was found for one particle and adds it to the totals of its chunk.
    ///
    /// # Safety
    /// No other thread writes what belongs to this particle.
    #[inline(always)]
    pub unsafe fn write<L: Lanes, B: Besides<L>>(
        &self,
        particle: usize,
        force: DVec3,
        besides: &B,
        totals: &mut ChunkTotals,
    ) {
        // SAFETY: the contract is passed on.
        unsafe { self.forces.write(particle, force) };
        if B::ANYTHING {
            let found = besides.totals();
            totals.add(&found);
            if let Some(each) = &self.each {
                // SAFETY: as above.
                unsafe { each.write(particle, (0.5 * found.energy, 0.5 * found.virial)) };
            }
        }
    }
}
