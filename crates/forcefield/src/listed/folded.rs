//! The copies of the canonical loop: folded positions, and sorted neighbors of each particle.

use glam::DVec3;
use lennard_neighbor::PairList;

use crate::canonical::{CanonicalJob, NeighborSource, wrap};
use crate::simd::{ListInUse, ListStatus, MotionSummary, Ordered};
use crate::sums::{Detail, PerParticle, Totals};

/// Folded positions, and the neighbors of each particle in ascending order.
#[derive(Default)]
pub struct Folded {
    wrapped: Vec<DVec3>,
    lists: Vec<Vec<u32>>,
}

impl Folded {
    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        let lists = self.lists.iter().map(|l| 24 + 4 * l.capacity());
        24 * self.wrapped.capacity() + lists.sum::<usize>()
    }

    /// Takes the neighbors of a list that was just built.
    pub fn take_list(&mut self, list: &impl PairList) {
        self.lists = list.neighbors();
        for list in &mut self.lists {
            list.dedup();
        }
    }

    /// Folds positions, judges the list, and writes forces (and `each`) where the list is complete.
    pub(super) fn evaluate(
        &mut self,
        used: &ListInUse<'_, impl PairList>,
        positions: &[DVec3],
        detail: Detail,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> (ListStatus, Totals) {
        wrap(used.cell, positions, &mut self.wrapped);
        let order = used.list.particles();
        let at = Ordered::of(positions, order);
        let motion = used.motion(at);
        let squares: Vec<f64> =
            (0..order.len()).map(|slot| motion.displacement(slot).length_squared()).collect();
        let mut summary = MotionSummary::NOTHING;
        summary.include(0, &squares, motion.far2);
        let status = used.judge(&summary, None, &|| at);
        if status != ListStatus::Complete {
            return (status, Totals::NOTHING);
        }
        let job = CanonicalJob {
            pairwise: used.pairwise,
            cell: used.cell,
            wrapped: &self.wrapped,
            neighbors: NeighborSource::Listed(&self.lists),
        };
        let totals = job.run(detail, forces, each);
        let broken = !forces.iter().all(|f| f.is_finite());
        (status, Totals { broken, ..totals })
    }
}
