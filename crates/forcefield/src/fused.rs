//! Fused steps: steps that follow each other, with the particles by slot.

use std::mem;

use glam::DVec3;
use lennard_core::exact::{PartSum, SumOfParts};
use lennard_core::{ForceError, FusedBath, FusedSteps, Masses, Moving};
use lennard_neighbor::{PairList, Positions};

use crate::clock::Clock;
use crate::part::{Part, Particles};
use crate::simd::{
    Disjoint, KickDrift, ListStatus, Mover, PackedCopies, PackedList, Prepared, Request, SlotNoise,
    SlotState, SumOverChunks, are_few, by_slot, fused_step, to_particles,
};
use crate::sums::Detail;
use crate::validity::{Given, ListValidity};

/// Room for particles in the order of a list, beside the room of forces that the caller lends.
#[derive(Debug, Default)]
pub struct FusedBuffers {
    /// Positions, where a bath has forces kept in the room of forces. Elsewhere positions lie there.
    positions: Vec<DVec3>,
    /// The room of forces of a rank, whose particles are others by slot than by number.
    room: Vec<DVec3>,
    velocities: Vec<DVec3>,
    /// Positions of the next step, where chunks still read the positions of this step. It is empty for many particles.
    next: Vec<DVec3>,
    /// The kinetic energy that a bath asks for, or what particles gain by friction and noise, summed over chunks.
    sum: SumOfParts,
    /// The part of each chunk.
    parts: Vec<PartSum>,
}

/// Particles in the order of a list.
struct BySlot<'a> {
    positions: &'a mut [DVec3],
    velocities: &'a mut [DVec3],
    /// Positions of the next step, where they have an array of their own; otherwise empty.
    next: &'a mut [DVec3],
    /// Forces of the step, where a bath acts before the next kick; otherwise empty.
    forces: &'a mut [DVec3],
    sum: &'a mut SumOfParts,
    parts: &'a mut Vec<PartSum>,
}

impl FusedBuffers {
    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        let vectors = [&self.positions, &self.room, &self.velocities, &self.next];
        let vectors: usize = vectors.iter().map(|v| v.capacity()).sum();
        24 * vectors + self.parts.capacity() * size_of::<PartSum>()
    }

    /// The arrays of some steps, in this room and in the room of forces, which the caller lends. A rank gives its number of own slots.
    fn by_slot<'a>(
        &'a mut self,
        lent: &'a mut [DVec3],
        part: Option<usize>,
        [keeps_forces, reads_while_it_writes]: [bool; 2],
    ) -> BySlot<'a> {
        let n = part.unwrap_or(lent.len());
        let room = |wanted: bool| if wanted { n } else { 0 };
        self.velocities.resize(n, DVec3::ZERO);
        self.next.resize(room(reads_while_it_writes), DVec3::ZERO);
        self.positions.resize(room(keeps_forces), DVec3::ZERO);
        self.room.resize(room(part.is_some()), DVec3::ZERO);
        let forces = if part.is_some() { &mut self.room[..] } else { lent };
        let (positions, forces) =
            if keeps_forces { (&mut self.positions[..], forces) } else { (forces, &mut [][..]) };
        BySlot {
            positions,
            velocities: &mut self.velocities,
            next: &mut self.next,
            forces,
            sum: &mut self.sum,
            parts: &mut self.parts,
        }
    }

    /// Gives the own particles of a rank away ahead of a build, with the room that they lay in.
    fn give<P: PairList>(&mut self, list: &P, keeps_forces: bool) -> Particles {
        let positions = if keeps_forces { &mut self.positions } else { &mut self.room };
        let [positions, velocities] = [positions, &mut self.velocities].map(mem::take);
        let numbers = list.particles()[..list.own()].to_vec();
        Particles { move_on: true, numbers, positions, velocities }
    }

    /// Takes steps, and builds the list wherever it expires. Returns the number of steps taken.
    ///
    /// Where a number is not finite, it takes none.
    pub fn advance<P: PackedList>(
        &mut self,
        validity: &mut ListValidity,
        (list, copies): (&mut P, &mut PackedCopies<P::Row>),
        steps: &mut FusedSteps<'_>,
        kick_drift: KickDrift,
        clock: &mut Clock,
    ) -> u64 {
        let (cell, n) = (steps.cell, steps.positions.len());
        if !validity.may_be_valid::<P>(cell, n) {
            let into = (&mut *list, copies.rows());
            let built = clock.building(|| validity.build_by_number(into, cell, steps.positions));
            if built.is_err() {
                return 0;
            }
        }
        let lent = mem::take(&mut steps.forces);
        let keeps_forces = steps.bath.as_ref().is_some_and(|bath| bath.next_noise().is_none());
        let kinds = [keeps_forces, are_few(list.whole())];
        let is_part = validity.part.is_some();
        let mut particles = self.by_slot(lent, is_part.then(|| list.own()), kinds);
        particles.gather(list, steps, validity.part.as_ref());
        let (mut taken, mut is_new, mut prepared) = (0, false, Prepared::Nothing);
        loop {
            let most = steps.steps - taken;
            let (done, status) = {
                let used = &validity.in_use(list, cell);
                let over_list = used.pairwise.over(list, cell);
                let mut done = 0;
                let status = loop {
                    if done == most {
                        break ListStatus::Complete;
                    }
                    let acts = steps.bath.as_ref().is_some_and(FusedBath::scales);
                    // The last step packs nothing, since no step follows it.
                    let packs_next = P::PACK_AHEAD.is_some()
                        && !are_few(list.whole())
                        && most - done > 1
                        && !acts;
                    let request = Request { detail: Detail::Forces, prepared, packs_next };
                    let BySlot { positions, velocities, next, forces, sum, parts } = &mut particles;
                    let next = (!next.is_empty()).then_some(&mut **next);
                    let state = SlotState { positions, next, velocities };
                    let chunks = list.chunk_slots().count();
                    let of_list = (list.particles(), chunks);
                    let mover = mover(acts, steps, of_list, (forces, sum, parts));
                    let how = (kick_drift, &mover);
                    let status = fused_step(used, copies, &*over_list, state, how, request);
                    if status != ListStatus::Complete {
                        break status;
                    }
                    prepared = if acts {
                        // The bath must not see numbers that are none.
                        if used.part.is_some_and(Part::is_broken) {
                            break ListStatus::NonFinite;
                        }
                        particles.go_on_from_bath(steps, kick_drift, (list.own(), used.part));
                        Prepared::Nothing
                    } else {
                        particles.finish_step(steps, request, used.part)
                    };
                    done += 1;
                    if let Some(part) = used.part {
                        let step = steps.first + taken + done;
                        part.note_speeds(step, steps.dt, &particles.velocities[..list.own()]);
                    }
                };
                (done, status)
            };
            taken += done;
            prepared = Prepared::Nothing;
            match status {
                ListStatus::Complete => break,
                ListStatus::NonFinite => return 0,
                ListStatus::Incomplete(pairs) if validity.insert(list, &pairs, false) => {
                    prepared = Prepared::Judged;
                }
                ListStatus::Expired | ListStatus::Incomplete(_) => {
                    assert!(done > 0 || !is_new, "a new list is complete");
                    if is_part {
                        let mut settling = self.give(list, keeps_forces);
                        let into = (&mut *list, copies.rows());
                        let given = Given::OfRank(&mut settling);
                        let built = clock.building(|| validity.build(into, cell, given));
                        // A rank has another number of own slots now, or keeps what it gave.
                        self.velocities = settling.velocities;
                        particles = self.by_slot(lent, Some(list.own()), kinds);
                        let positions = match &built {
                            Ok(()) => &validity.built[..list.own()],
                            Err(_) => &settling.positions,
                        };
                        particles.positions.copy_from_slice(positions);
                        if built.is_err() {
                            break;
                        }
                    } else {
                        let built = clock.building(|| {
                            let given = Given::All(Positions::BySlot(particles.positions));
                            validity.build((&mut *list, copies.rows()), cell, given)?;
                            particles.reorder(list, validity);
                            Ok::<_, ForceError>(())
                        });
                        if built.is_err() {
                            break;
                        }
                    }
                    is_new = true;
                }
            }
        }
        match &validity.part {
            None if taken > 0 => {
                to_particles(list, particles.positions, steps.positions);
                to_particles(list, particles.velocities, steps.velocities);
            }
            None => {}
            Some(part) if part.is_broken() => return 0,
            Some(part) => {
                part.to_numbers(list, particles.positions, steps.positions);
                part.to_numbers(list, particles.velocities, steps.velocities);
            }
        }
        taken
    }
}

impl BySlot<'_> {
    /// Gathers positions and velocities by slot.
    fn gather<P: PairList>(&mut self, list: &P, steps: &FusedSteps<'_>, part: Option<&Part>) {
        let order = list.particles();
        match part {
            None => {
                by_slot(order, 0..order.len(), steps.positions, self.positions);
                by_slot(order, 0..order.len(), steps.velocities, self.velocities);
            }
            Some(part) => {
                part.to_slots(list, steps.positions, self.positions);
                part.to_slots(list, steps.velocities, self.velocities);
            }
        }
    }

    /// Puts the particles in the order of a list that was just built.
    fn reorder<P: PairList>(&mut self, list: &P, validity: &ListValidity) {
        // The velocities move to the room of the old positions.
        by_slot(list.source(), 0..self.positions.len(), self.velocities, self.positions);
        mem::swap(&mut self.positions, &mut self.velocities);
        self.positions.copy_from_slice(&validity.built);
    }

    /// Lets the bath scale the velocities after half a kick, and goes on with the other half and the drift.
    fn go_on_from_bath(
        &mut self,
        steps: &mut FusedSteps<'_>,
        kick_drift: KickDrift,
        (own, part): (usize, Option<&Part>),
    ) {
        let kinetic = self.sum.value(self.parts, part.map(Part::team));
        let factor = steps.bath.as_mut().map_or(1.0, |bath| bath.factor(kinetic));
        let moving = Moving {
            positions: &mut self.positions[..own],
            velocities: &mut self.velocities[..own],
            forces: &self.forces[..own],
        };
        moving.all(move |c| kick_drift.on_from_bath(factor, c));
    }

    /// Makes the positions of the next step the present ones; returns the state of their rows.
    fn finish_step(
        &mut self,
        steps: &mut FusedSteps<'_>,
        request: Request,
        part: Option<&Part>,
    ) -> Prepared {
        if let Some(bath) = &mut steps.bath {
            bath.pass(|| self.sum.value(self.parts, part.map(Part::team)));
        }
        if !self.next.is_empty() {
            mem::swap(&mut self.positions, &mut self.next);
        }
        if request.packs_next { Prepared::Packed } else { Prepared::Nothing }
    }
}

/// What moves the particles in the next step; `acts` says whether the bath does after it. Only some steps use the arrays.
fn mover<'a>(
    acts: bool,
    steps: &FusedSteps<'_>,
    (particles, chunks): (&'a [u32], usize),
    (forces, sum, parts): (&'a mut [DVec3], &'a mut SumOfParts, &'a mut Vec<PartSum>),
) -> Mover<'a> {
    let Masses::Uniform(mass) = *steps.masses else {
        return Mover::Drift;
    };
    if acts {
        let forces = Disjoint::new(forces);
        return Mover::Bath { forces, mass, sum: SumOverChunks::begin(sum, parts, chunks) };
    }
    let Some(of_step) = steps.bath.as_ref().and_then(FusedBath::next_noise) else {
        return Mover::Drift;
    };
    let noise = SlotNoise { of_step, mass, particles };
    Mover::Noise(noise, SumOverChunks::begin(sum, parts, chunks))
}
