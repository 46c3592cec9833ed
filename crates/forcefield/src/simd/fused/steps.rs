//! One fused step: chunk by chunk, forces, two half kicks, a drift, and rows of the next step.

use glam::DVec3;
use lennard_core::Moving;
use lennard_neighbor::ATOMS_PER_CHUNK;

use super::pack_ahead::{Ahead, NextRows};
use crate::simd::disjoint::Disjoint;
use crate::simd::list_in_use::{ListInUse, ListStatus, Ordered};
use crate::simd::motion::numbers;
use crate::simd::mover::{KickDrift, Mover, move_chunk};
use crate::simd::output::Output;
use crate::simd::packed::{PackedCopies, Pass, Request, are_few};
use crate::simd::packed_list::{ChunkLoop, PackedList};
use crate::simd::prefetch::Region;

/// Particles by slot.
pub struct SlotState<'a> {
    /// Positions, σ.
    pub positions: &'a mut [DVec3],
    /// Positions of the next step, σ. Without this array they overwrite `positions`, which only many particles allow.
    pub next: Option<&'a mut [DVec3]>,
    /// Velocities, σ/τ.
    pub velocities: &'a mut [DVec3],
}

/// Judges the list where the request demands it, and takes one step where the list is complete.
///
/// With [`Mover::Bath`] the step ends after half a kick: positions stay, and chunks pack nothing.
///
/// Where a number is not finite, the written arrays have no meaning.
pub fn fused_step<P: PackedList>(
    used: &ListInUse<'_, P>,
    copies: &mut PackedCopies<P::Row>,
    over_list: &dyn ChunkLoop<P::Row>,
    particles: SlotState<'_>,
    (kick_drift, mover): (KickDrift, &Mover<'_>),
    request: Request,
) -> ListStatus {
    let own = used.list.own();
    assert!(
        particles.positions.len() == own && particles.velocities.len() == own,
        "one vector per slot that has a list"
    );
    assert!(
        particles.next.is_some() || !are_few(used.list.whole()),
        "few particles are packed while chunks run"
    );
    let positions = Disjoint::new(particles.positions);
    let velocities = Disjoint::new(particles.velocities);
    let next = particles.next.map(Disjoint::new);
    // SAFETY: positions are read while rows are packed and while the list is judged. Many particles finish both before the
    // first chunk runs. The chunks of few particles write their positions to another array.
    let at = || Ordered::by_slot(unsafe { positions.all() });
    let ahead = Ahead {
        list: used.list,
        level: used.level,
        // Few particles lie in a cache, and their next chunk may belong to another thread.
        state: next.is_none().then(|| [positions.region(), velocities.region()]),
        built: Region::of(used.built),
        far2: used.criterion.far2(),
    };
    let run = |rows: &[P::Row], next_rows: Option<&NextRows<'_, P::Row>>, chunk| {
        let slots = used.list.chunk_slots().of(chunk..chunk + 1);
        let mut at_rest: [DVec3; ATOMS_PER_CHUNK];
        // SAFETY: each chunk runs once, and its slots belong to no other chunk. This holds for all blocks below.
        let (positions, velocities) = unsafe {
            let positions = match (&next, mover) {
                (_, Mover::Bath { .. }) => {
                    at_rest = [DVec3::ZERO; ATOMS_PER_CHUNK];
                    &mut at_rest[..slots.len()]
                }
                (Some(next), _) => {
                    let next = next.part(slots.clone());
                    next.copy_from_slice(&at().positions[slots.clone()]);
                    next
                }
                (None, _) => positions.part(slots.clone()),
            };
            (positions, velocities.part(slots.clone()))
        };
        let mut of_chunk = [DVec3::ZERO; ATOMS_PER_CHUNK];
        let forces = match mover {
            // SAFETY: as above.
            Mover::Bath { forces, .. } => unsafe { forces.part(slots.clone()) },
            _ => &mut of_chunk[..slots.len()],
        };
        // SAFETY: as above.
        let next_chunk = unsafe { ahead.next_chunk(chunk, next_rows) };
        let output = Output::of_chunk(&mut *forces, numbers(slots.len()), slots.start, next_chunk);
        // SAFETY: as above.
        let totals = unsafe { over_list.run(used.level, rows, chunk, request.detail, &output) };
        let moving = Moving { positions: &mut *positions, velocities, forces };
        // SAFETY: as above.
        let step =
            unsafe { move_chunk(used.level, kick_drift, mover, (chunk, slots.clone()), moving) };
        if matches!(mover, Mover::Bath { .. }) {
            return totals;
        }
        let mut motion = used.motion(Ordered::by_slot(positions));
        motion.built = &used.built[slots.clone()];
        motion.species = motion.species.map(|species| species.part(slots));
        // SAFETY: as above.
        unsafe { ahead.pack(chunk, next_rows, motion, step) };
        totals
    };
    let outcome = copies.run(&Pass { used, request, at: &at, run: &run });
    match used.part {
        None if outcome.broken => ListStatus::NonFinite,
        None => outcome.status,
        Some(part) => {
            // All ranks learn it when they judge the list next.
            part.note_broken(outcome.broken);
            outcome.status
        }
    }
}
