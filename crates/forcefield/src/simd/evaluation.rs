//! Forces at some positions: one pass over a list, whose chunks write what they sum.

use glam::{DMat3, DVec3};

use super::fused::NextRows;
use super::list_in_use::{ListInUse, ListStatus, Ordered};
use super::output::Output;
use super::packed::{Outcome, PackedCopies, Pass, Request};
use super::packed_list::PackedList;
use crate::part::Part;
use crate::sums::{PerParticle, Totals};

impl<P: PackedList> ListInUse<'_, P> {
    /// Packs rows, judges the list, and writes forces (and `each`) where it is complete.
    pub fn evaluate(
        &self,
        copies: &mut PackedCopies<P::Row>,
        positions: &[DVec3],
        request: Request,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> (ListStatus, Totals) {
        let order = self.list.particles();
        let at = || Ordered::of(positions, order);
        let outcome = self.pass(copies, request, Output::new(forces, each, order, 0), &at);
        outcome.summed(request.detail, None)
    }

    /// As [`ListInUse::evaluate`], on a rank: `positions` are at own slots, and forces (and `each`) by number.
    pub fn evaluate_part(
        &self,
        part: &Part,
        copies: &mut PackedCopies<P::Row>,
        (positions, request): (&[DVec3], Request),
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> (ListStatus, Totals) {
        let own = self.list.own();
        let numbers: Vec<u32> = (0..own as u32).collect();
        let mut by_slot = vec![DVec3::ZERO; own];
        let mut each_by_slot = vec![(0.0, DMat3::ZERO); each.as_ref().map_or(0, |_| own)];
        let at = || Ordered::by_slot(positions);
        let entries = each.is_some().then_some(&mut each_by_slot[..]);
        let output = Output::new(&mut by_slot, entries, &numbers, 0);
        let mut outcome = self.pass(copies, request, output, &at);
        if outcome.status == ListStatus::Complete {
            part.to_numbers(self.list, &by_slot, forces);
            if let Some(each) = each {
                self.entries_to_numbers(part, &each_by_slot, each);
            }
            outcome.broken = part.team().any(outcome.broken);
        }
        outcome.summed(request.detail, Some(part.team()))
    }

    /// Runs the chunks once.
    fn pass<'p>(
        &self,
        copies: &mut PackedCopies<P::Row>,
        request: Request,
        output: Output<'_>,
        at: &(dyn Fn() -> Ordered<'p> + Sync),
    ) -> Outcome {
        let over_list = self.pairwise.over(self.list, self.cell);
        // SAFETY: a pass runs each chunk once.
        let run = |rows: &[P::Row], _: Option<&NextRows<'_, P::Row>>, chunk: usize| unsafe {
            over_list.run(self.level, rows, chunk, request.detail, &output)
        };
        copies.run(&Pass { used: self, request, at, run: &run })
    }

    /// Takes entries by slot to their numbers: an energy and nine components in four vectors.
    fn entries_to_numbers(&self, part: &Part, from: &[PerParticle], to: &mut [PerParticle]) {
        let of = |vector: &dyn Fn(&PerParticle) -> DVec3| {
            let by_slot: Vec<DVec3> = from.iter().map(vector).collect();
            let mut by_number = vec![DVec3::ZERO; to.len()];
            part.to_numbers(self.list, &by_slot, &mut by_number);
            by_number
        };
        let energies = of(&|(energy, _)| DVec3::X * *energy);
        let [x, y, z] = [0, 1, 2].map(|axis| of(&|(_, virial)| virial.col(axis)));
        for (k, entry) in to.iter_mut().enumerate() {
            *entry = (energies[k].x, DMat3::from_cols(x[k], y[k], z[k]));
        }
    }
}
