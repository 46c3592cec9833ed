//! Fused steps: steps that follow each other, with the particles by slot.

use std::ops::Range;

use glam::DVec3;
use lennard_core::{ForceError, FusedBath, FusedSteps, Masses};
use lennard_neighbor::Positions;

use crate::clock::Clock;
use crate::share::Share;
use crate::simd::{
    Detail, Disjoint, KickDrift, Level, ListStatus, LoopOver, Mover, PackedCopies, PairList,
    Prepared, Request, SlotNoise, SlotState, are_few, by_slot, fused_step, to_particles,
};
use crate::validity::ListValidity;

/// Particles in the order of a list.
#[derive(Debug, Default)]
pub struct FusedBuffers {
    positions: Vec<DVec3>,
    velocities: Vec<DVec3>,
    /// Positions of the next step, where chunks still read the positions of this step. It is empty for many particles.
    next: Vec<DVec3>,
    /// Forces of the step, where a bath acts before the next kick.
    forces: Vec<DVec3>,
    /// Kinetic energy that the particle at each slot gains by friction and noise.
    gained: Vec<f64>,
    /// 0, 1, …
    slots: Vec<u32>,
}

impl FusedBuffers {
    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        let vectors = [&self.positions, &self.velocities, &self.next, &self.forces];
        let vectors: usize = vectors.iter().map(|v| v.capacity()).sum();
        24 * vectors + 8 * self.gained.capacity() + 4 * self.slots.capacity()
    }

    /// Takes steps, and builds the list wherever it expires. Returns the number of steps taken.
    ///
    /// Where a number is not finite, it takes none.
    pub fn advance<P: PairList>(
        &mut self,
        validity: &mut ListValidity,
        (list, copies): (&mut P, &mut PackedCopies<P::Row>),
        interaction: &dyn LoopOver<P>,
        steps: &mut FusedSteps<'_>,
        kick_drift: KickDrift,
        clock: &mut Clock,
    ) -> u64 {
        let (cell, n) = (steps.cell, steps.positions.len());
        if !validity.may_be_valid::<P>(cell, n) {
            let positions = Positions::ById(steps.positions);
            let built =
                clock.building(|| validity.build((&mut *list, copies.rows()), cell, positions));
            if built.is_err() {
                return 0;
            }
        }
        self.gather(list, steps, validity.shared());
        let (mut taken, mut is_new, mut prepared) = (0, false, Prepared::Nothing);
        loop {
            let most = steps.steps - taken;
            let (done, status) = validity.with_list(list, cell, |used| {
                let over_list = interaction.over(list, used.r_cut, cell);
                let mut done = 0;
                while done < most {
                    let acts = steps.bath.as_ref().is_some_and(FusedBath::acts);
                    let mut request = self.request::<P>(prepared, most - done);
                    request.packs_next &= !acts;
                    let (particles, rest) = self.particles();
                    let mover = rest.mover(acts, steps, list.particles());
                    let how = (kick_drift, &mover);
                    let status = fused_step(used, copies, &*over_list, particles, how, request);
                    if status != ListStatus::Complete {
                        return (done, status);
                    }
                    prepared = if acts {
                        // The bath must not see numbers that are none.
                        if used.share.is_some_and(Share::is_broken) {
                            return (done, ListStatus::NonFinite);
                        }
                        self.go_on_from_bath(steps, (kick_drift, used.level), used.share);
                        Prepared::Nothing
                    } else {
                        self.finish_step(steps, request, used.share)
                    };
                    done += 1;
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
                        let ranks = validity.shared().map(|share| share.ranks().clone());
                        let positions = match &ranks {
                            None => Positions::BySlot(&self.positions),
                            Some(ranks) => Positions::Parted(&self.positions, ranks),
                        };
                        validity.build((&mut *list, copies.rows()), cell, positions)?;
                        self.reorder(list, validity);
                        Ok::<_, ForceError>(())
                    });
                    if built.is_err() {
                        break;
                    }
                    is_new = true;
                }
            }
        }
        if let Some(share) = validity.shared() {
            if share.is_broken() {
                return 0;
            }
            self.make_whole(Some(share));
        }
        if taken > 0 {
            to_particles(list, &self.positions, steps.positions);
            to_particles(list, &self.velocities, steps.velocities);
        }
        taken
    }

    /// Gathers positions and velocities by slot.
    fn gather<P: PairList>(&mut self, list: &P, steps: &FusedSteps<'_>, share: Option<&Share>) {
        let n = steps.positions.len();
        if self.slots.len() != n {
            self.slots = (0..n as u32).collect();
        }
        let (order, own) = (list.particles(), self.own(share));
        by_slot(order, own.clone(), steps.positions, &mut self.positions);
        by_slot(order, own, steps.velocities, &mut self.velocities);
        let reads_while_it_writes = are_few(n) && share.is_none();
        let next = if reads_while_it_writes { n } else { 0 };
        self.next.resize(next, DVec3::ZERO);
    }

    /// Gathers what the ranks have of positions and velocities, where there are several.
    fn make_whole(&mut self, share: Option<&Share>) {
        if let Some(share) = share {
            share.team().gather(&mut self.positions, share.slots());
            share.team().gather(&mut self.velocities, share.slots());
        }
    }

    /// The slots whose particles this process moves.
    fn own(&self, share: Option<&Share>) -> Range<usize> {
        share.map_or(0..self.slots.len(), Share::own)
    }

    /// Puts the particles of this process in the order of a list that was just built.
    fn reorder<P: PairList>(&mut self, list: &P, validity: &ListValidity) {
        let (source, own) = (list.source(), self.own(validity.shared()));
        // The velocities move to the room of the old positions.
        match validity.shared() {
            None => by_slot(source, own.clone(), &self.velocities, &mut self.positions),
            Some(share) => share.migrate(source, &self.velocities, &mut self.positions),
        }
        std::mem::swap(&mut self.positions, &mut self.velocities);
        let built = &validity.built()[own.clone()];
        self.positions[own].copy_from_slice(built);
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

    fn particles(&mut self) -> (SlotState<'_>, Rest<'_>) {
        let particles = SlotState {
            positions: &mut self.positions,
            next: (!self.next.is_empty()).then_some(&mut self.next[..]),
            velocities: &mut self.velocities,
            slots: &self.slots,
        };
        let rest = Rest {
            forces: &mut self.forces,
            gained: &mut self.gained,
        };
        (particles, rest)
    }

    /// Lets the bath scale the velocities after half a kick, and goes on with the other half and the drift.
    fn go_on_from_bath(
        &mut self,
        steps: &mut FusedSteps<'_>,
        (kick_drift, level): (KickDrift, Level),
        share: Option<&Share>,
    ) {
        let own = self.own(share);
        let (positions, velocities) = (&mut self.positions[own.clone()], &mut self.velocities);
        let velocities = &mut velocities[own.clone()];
        // All masses are equal, so that the order of the slots serves as well.
        let kinetic = (steps.masses).kinetic_energy_over(share.map(Share::team), velocities);
        let factor = steps.bath.as_mut().map_or(1.0, |bath| bath.factor(kinetic));
        let forces = &self.forces[own];
        kick_drift.scale_and_go_on(level, factor, positions, velocities, forces);
    }

    /// Makes the positions of the next step the present ones; returns the state of their rows.
    fn finish_step(
        &mut self,
        steps: &mut FusedSteps<'_>,
        request: Request,
        share: Option<&Share>,
    ) -> Prepared {
        if let Some(bath) = &mut steps.bath {
            bath.pass();
        }
        if let Some(noise) = &mut steps.noise {
            noise.pass(&self.gained[self.own(share)], share.map(Share::team));
        }
        if !self.next.is_empty() {
            std::mem::swap(&mut self.positions, &mut self.next);
        }
        if request.packs_next {
            Prepared::Packed
        } else {
            Prepared::Nothing
        }
    }
}

/// Arrays by slot that only some steps use.
struct Rest<'a> {
    forces: &'a mut Vec<DVec3>,
    gained: &'a mut Vec<f64>,
}

impl<'a> Rest<'a> {
    /// What moves the particles in the next step; `acts` says whether the bath does after it.
    fn mover(self, acts: bool, steps: &FusedSteps<'_>, particles: &'a [u32]) -> Mover<'a> {
        let n = particles.len();
        if acts {
            self.forces.resize(n, DVec3::ZERO);
            return Mover::Kick(Disjoint::new(self.forces));
        }
        match (&steps.noise, steps.masses) {
            (Some(noise), Masses::Uniform(mass)) => {
                self.gained.resize(n, 0.0);
                let noise = SlotNoise {
                    of_step: noise.next_step(),
                    mass: *mass,
                    particles,
                };
                Mover::Noise(noise, Disjoint::new(self.gained))
            }
            _ => Mover::Drift,
        }
    }
}
