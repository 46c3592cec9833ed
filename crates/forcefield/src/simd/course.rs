//! Particles on their way: chunk by chunk, forces, kicks and drift in one pass over memory.

use glam::DVec3;
use lennard_core::parallel::{for_each_piece, for_each_range, part};
use lennard_neighbor::ATOMS_PER_CHUNK;

use super::packing::{Motion, Pace};
use super::prefetch::{Asked, Later};
use super::{Next, Output, PairList, Scatter, go_on};
use crate::copies::{Copies, Fitness, Use, are_few};
use crate::terms::Terms;
use crate::truncation::PairForm;

/// Particles by place.
pub struct OnTheWay<'a> {
    /// Positions, σ.
    pub positions: &'a mut [DVec3],
    /// Where those of the next step are written, σ; in place where there is nothing, as only many particles allow.
    pub next: Option<&'a mut [DVec3]>,
    /// Velocities, σ/τ.
    pub velocities: &'a mut [DVec3],
    /// The numbers of the places.
    pub in_order: &'a [u32],
}

/// Judges the list, as far as that was not done, and takes one step where it is fit. Where a number is not
/// finite, what was written is worth nothing.
pub fn advance<P: PairList, F: PairForm>(
    terms: &Terms,
    lists: (&P, &mut Copies<P::Row>),
    job: &P::Job<'_, F>,
    particles: OnTheWay<'_>,
    pace: Pace,
    used: Use,
) -> Fitness {
    let list = lists.0;
    let in_order = particles.in_order;
    let n = in_order.len();
    assert!(
        particles.positions.len() == n && particles.velocities.len() == n,
        "vectors for each place"
    );
    assert!(
        particles.next.is_some() || !are_few(n),
        "few particles are packed while chunks run"
    );
    let positions = Scatter::new(particles.positions);
    let velocities = Scatter::new(particles.velocities);
    let next = particles.next.map(Scatter::new);
    // SAFETY: asked for while rows are packed and the list is judged, which for many particles is over before the first
    // chunk runs, and by the chunks of few, whose positions are written elsewhere.
    let now = || unsafe { positions.all() };
    // Those of few lie in a cache, and the next chunk may be another thread's.
    let state = next
        .is_none()
        .then(|| [&positions, &velocities].map(Asked::scattered));
    let far2 = terms.criterion.far2();
    let built = Asked::of(&terms.built);
    let run = |rows: &[P::Row], next_rows: Option<&Next<'_, P::Row>>, chunk| {
        let places = part(chunk, ATOMS_PER_CHUNK, n);
        // SAFETY: the places of a chunk are no other's.
        let (positions, velocities) = unsafe {
            let positions = match &next {
                Some(next) => {
                    let next = next.part(places.clone());
                    next.copy_from_slice(&now()[places.clone()]);
                    next
                }
                None => positions.part(places.clone()),
            };
            (positions, velocities.part(places.clone()))
        };
        let mut forces = [DVec3::ZERO; ATOMS_PER_CHUNK];
        let forces = &mut forces[..places.len()];
        let order = &in_order[..places.len()];
        let later = state.map(|[positions, velocities]| {
            // SAFETY: this chunk is no other thread's.
            let will_look = |next: &Next<'_, _>| unsafe { next.will_look(chunk, far2) };
            Later {
                to_write: [
                    positions,
                    velocities,
                    next_rows.map_or(positions.none_of(), |next| Asked::scattered(&next.rows)),
                ],
                to_read: if next_rows.is_some_and(will_look) {
                    built
                } else {
                    built.none_of()
                },
            }
        });
        let output = Output::on_the_way(forces, order, places.start, later);
        let totals = P::run(terms.level, job, rows, chunk, used.wanted, &output);
        let step = go_on(terms.level, positions, velocities, forces, pace);
        if let (Some(next), Some(pack)) = (next_rows, P::PACK_AHEAD) {
            let motion = Motion {
                built: &terms.built[places],
                ..terms.motion(positions, order)
            };
            // SAFETY: this chunk is no other thread's.
            unsafe { next.pack((list, pack), terms.level, motion, chunk, step) };
        }
        totals
    };
    let (fitness, _, broken) = terms.use_list(lists, now, in_order, used, &run);
    if broken { Fitness::Broken } else { fitness }
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
