//! Particles on their way: chunk by chunk, forces, kicks and drift in one pass over memory.

use glam::DVec3;
use lennard_core::parallel::{for_each_piece, for_each_range, part};
use lennard_core::tasks::for_each_task;
use lennard_neighbor::ATOMS_PER_CHUNK;

use super::packing::Pace;
use super::prefetch::prefetch_write_all;
use super::{Level, Output, PairList, Scatter, Wanted, go_on};
use crate::truncation::PairForm;

/// One step of `positions`, σ, and `velocities`, σ/τ, both by place, with the forces that are found from `rows`; one that is
/// not finite leaves a position that is not. `in_order` numbers the places.
pub fn advance<P: PairList, F: PairForm>(
    level: Level,
    job: &P::Job<'_, F>,
    rows: &[P::Row],
    (positions, velocities): (&mut [DVec3], &mut [DVec3]),
    in_order: &[u32],
    pace: Pace,
) {
    let n = in_order.len();
    assert!(
        positions.len() == n && velocities.len() == n,
        "vectors for each place"
    );
    let (positions, velocities) = (Scatter::new(positions), Scatter::new(velocities));
    for_each_task(n.div_ceil(ATOMS_PER_CHUNK), |(): &mut (), chunk| {
        let places = part(chunk, ATOMS_PER_CHUNK, n);
        // SAFETY: the places of a chunk are no other's.
        let (positions, velocities) = unsafe {
            (
                positions.part(places.clone()),
                velocities.part(places.clone()),
            )
        };
        // Needed at once after the forces, and too short for a processor to take them for streams.
        prefetch_write_all(positions);
        prefetch_write_all(velocities);
        let mut forces = [DVec3::ZERO; ATOMS_PER_CHUNK];
        let forces = &mut forces[..places.len()];
        let output = Output::new(forces, None, &in_order[..places.len()], places.start);
        P::run(level, job, rows, chunk, Wanted::Forces, &output);
        go_on(level, positions, velocities, forces, pace);
    });
}

/// Takes from an array by particle what belongs to each place, where `order` has the particle of each.
pub fn take(order: &[u32], from: &[DVec3], to: &mut Vec<DVec3>) {
    to.resize(order.len(), DVec3::ZERO);
    for_each_piece(to, |first, piece| {
        for (to, at) in piece.iter_mut().zip(&order[first..]) {
            *to = from[*at as usize];
        }
    });
}

/// Brings what lies by place back to where it belongs.
pub fn bring_back<P: PairList>(list: &P, from: &[DVec3], to: &mut [DVec3]) {
    let order = list.particles();
    let n = order.len();
    assert!(from.len() == n && to.len() == n, "a vector for each place");
    let to = Scatter::new(to);
    for_each_range(n, |places| {
        for (from, at) in from[places.clone()].iter().zip(&order[places]) {
            // SAFETY: each particle stands at one place.
            unsafe { to.write(*at as usize, *from) };
        }
    });
}
