//! Forces at some positions: one pass over a list, whose chunks write what they sum.

use glam::{DMat3, DVec3};

use super::by_slot::to_particles;
use super::fused::NextRows;
use super::list_in_use::{ListInUse, ListStatus, Ordered};
use super::output::Output;
use super::packed::{PackedCopies, Pass, Request};
use super::packed_list::PackedList;
use crate::share::Share;
use crate::sums::{PerParticle, Totals};

impl<P: PackedList> ListInUse<'_, P> {
    /// Packs rows, judges the list, and writes forces (and `each`) where it is complete. Each rank gets the forces of all.
    pub fn evaluate(
        &self,
        copies: &mut PackedCopies<P::Row>,
        positions: &[DVec3],
        request: Request,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> (ListStatus, Totals) {
        let order = self.list.particles();
        let over_list = self.pairwise.over(self.list, self.cell);
        let at = || Ordered::of(positions, order);
        let mut pass = |output: Output<'_>| {
            // SAFETY: a pass runs each chunk once.
            let run = |rows: &[P::Row], _: Option<&NextRows<'_, P::Row>>, chunk: usize| unsafe {
                over_list.run(self.level, rows, chunk, request.detail, &output)
            };
            copies.run(&Pass { used: self, request, at: &at, run: &run, fetch: None })
        };
        let Some(share) = self.share else {
            return pass(Output::new(forces, each, order, 0)).summed(request.detail, None);
        };
        let n = forces.len();
        let mut by_slot = std::mem::take(&mut share.buffers().forces);
        by_slot.resize(n, DVec3::ZERO);
        let mut each_by_slot = vec![(0.0, DMat3::ZERO); each.as_ref().map_or(0, |each| each.len())];
        let entries = each.is_some().then_some(&mut each_by_slot[..]);
        let mut outcome = pass(Output::new(&mut by_slot, entries, share.numbers(), 0));
        if outcome.status == ListStatus::Complete {
            let team = share.team();
            team.gather(&mut by_slot, share.slots());
            to_particles(self.list, &by_slot, forces);
            if let Some(each) = each {
                gather_entries(share, &mut each_by_slot);
                to_particles(self.list, &each_by_slot, each);
            }
            outcome.broken = team.any(outcome.broken);
        }
        share.buffers().forces = by_slot;
        outcome.summed(request.detail, Some(share.team()))
    }
}

/// Makes the entries of all slots whole: an energy and nine components in four vectors.
fn gather_entries(share: &Share, entries: &mut [PerParticle]) {
    let mut vectors = vec![DVec3::ZERO; 4 * entries.len()];
    let own = share.own();
    let (to, _) = vectors.as_chunks_mut::<4>();
    for (to, (energy, virial)) in to[own.clone()].iter_mut().zip(&entries[own]) {
        *to = [DVec3::X * *energy, virial.x_axis, virial.y_axis, virial.z_axis];
    }
    let of_four = |slots: &std::ops::Range<usize>| 4 * slots.start..4 * slots.end;
    let ranges: Vec<_> = share.slots().iter().map(of_four).collect();
    share.team().gather(&mut vectors, &ranges);
    let (from, _) = vectors.as_chunks::<4>();
    for (entry, [energy, x, y, z]) in entries.iter_mut().zip(from) {
        *entry = (energy.x, DMat3::from_cols(*x, *y, *z));
    }
}
