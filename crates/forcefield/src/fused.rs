//! Fused steps: steps that follow each other, with the particles by slot.

use glam::DVec3;
use lennard_core::{ForceError, FusedSteps};
use lennard_neighbor::Positions;

use crate::clock::Clock;
use crate::interaction::Interaction;
use crate::simd::{
    Detail, KickDrift, ListStatus, PackedCopies, PairList, Prepared, Request, SlotState, are_few,
    by_slot, fused_step, to_particles,
};
use crate::validity::ListValidity;

/// Particles in the order of a list.
#[derive(Debug, Default)]
pub struct FusedBuffers {
    positions: Vec<DVec3>,
    velocities: Vec<DVec3>,
    /// Positions of the next step, where chunks still read the positions of this step. It is empty for many particles.
    next: Vec<DVec3>,
    /// 0, 1, …
    slots: Vec<u32>,
}

impl FusedBuffers {
    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        let vectors = [&self.positions, &self.velocities, &self.next];
        let vectors: usize = vectors.iter().map(|v| v.capacity()).sum();
        24 * vectors + 4 * self.slots.capacity()
    }

    /// Takes steps, and builds the list wherever it expires. Returns the number of steps taken.
    ///
    /// Where a number is not finite, it takes none.
    pub fn advance<P: PairList, I: Interaction>(
        &mut self,
        validity: &mut ListValidity,
        (list, copies): (&mut P, &mut PackedCopies<P::Row>),
        interaction: I,
        steps: &mut FusedSteps<'_>,
        kick_drift: KickDrift,
        clock: &mut Clock,
    ) -> u64 {
        let (cell, n) = (steps.cell, steps.positions.len());
        if !validity.may_be_valid::<P>(cell, n) {
            let positions = Positions::ById(steps.positions);
            let built = clock.building(|| validity.build(list, cell, positions));
            if built.is_err() {
                return 0;
            }
        }
        self.gather(list, steps);
        let (mut taken, mut is_new, mut prepared) = (0, false, Prepared::Nothing);
        loop {
            let most = steps.steps - taken;
            let (done, status) = validity.with_list(list, cell, |used| {
                let job = list.job(interaction, used.r_cut, cell);
                let mut done = 0;
                while done < most {
                    let request = self.request::<P>(prepared, most - done);
                    let particles = self.particles();
                    let status = fused_step(used, copies, &job, particles, kick_drift, request);
                    if status != ListStatus::Complete {
                        return (done, status);
                    }
                    done += 1;
                    prepared = self.finish_step(request);
                }
                (done, ListStatus::Complete)
            });
            taken += done;
            prepared = Prepared::Nothing;
            match status {
                ListStatus::Complete => break,
                ListStatus::NonFinite => return 0,
                ListStatus::Incomplete(pairs) if validity.insert(list, &pairs) => {
                    prepared = Prepared::Judged;
                }
                ListStatus::Expired | ListStatus::Incomplete(_) => {
                    assert!(done > 0 || !is_new, "a new list is complete");
                    let built = clock.building(|| {
                        validity.build(list, cell, Positions::BySlot(&self.positions))?;
                        self.reorder(list, validity.built());
                        Ok::<_, ForceError>(())
                    });
                    if built.is_err() {
                        break;
                    }
                    is_new = true;
                }
            }
        }
        if taken > 0 {
            to_particles(list, &self.positions, steps.positions);
            to_particles(list, &self.velocities, steps.velocities);
        }
        taken
    }

    /// Gathers positions and velocities by slot.
    fn gather<P: PairList>(&mut self, list: &P, steps: &FusedSteps<'_>) {
        let n = steps.positions.len();
        by_slot(list.particles(), steps.positions, &mut self.positions);
        by_slot(list.particles(), steps.velocities, &mut self.velocities);
        if self.slots.len() != n {
            self.slots = (0..n as u32).collect();
        }
        self.next
            .resize(if are_few(n) { n } else { 0 }, DVec3::ZERO);
    }

    /// Puts the particles in the order of a list that was just built; `built` has their positions in that order.
    fn reorder<P: PairList>(&mut self, list: &P, built: &[DVec3]) {
        // The velocities move to the room of the old positions.
        by_slot(list.source(), &self.velocities, &mut self.positions);
        std::mem::swap(&mut self.positions, &mut self.velocities);
        self.positions.copy_from_slice(built);
    }

    /// The request of the next step, of which `left` steps are left.
    fn request<P: PairList>(&self, prepared: Prepared, left: u64) -> Request {
        Request {
            detail: Detail::Forces,
            prepared,
            // The last step packs nothing, since no step follows it.
            packs_next: P::PACK_AHEAD.is_some() && !are_few(self.slots.len()) && left > 1,
        }
    }

    fn particles(&mut self) -> SlotState<'_> {
        let few = are_few(self.slots.len());
        SlotState {
            positions: &mut self.positions,
            next: few.then_some(&mut self.next[..]),
            velocities: &mut self.velocities,
            slots: &self.slots,
        }
    }

    /// Makes the positions of the next step the present ones; returns the state of their rows.
    fn finish_step(&mut self, request: Request) -> Prepared {
        if are_few(self.slots.len()) {
            std::mem::swap(&mut self.positions, &mut self.next);
        }
        if request.packs_next {
            Prepared::Packed
        } else {
            Prepared::Nothing
        }
    }
}
