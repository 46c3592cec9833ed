//! Elements by slot and by particle.

use std::ops::Range;

use glam::DVec3;
use lennard_core::parallel::{for_each_piece, for_each_range};
use lennard_neighbor::PairList;

use super::disjoint::Disjoint;

/// Gathers elements at some slots from an array by index, where `order` has the index of each slot.
pub fn by_slot(order: &[u32], slots: Range<usize>, from: &[DVec3], to: &mut [DVec3]) {
    let order = &order[slots.clone()];
    for_each_piece(&mut to[slots], |first, piece| {
        for (to, at) in piece.iter_mut().zip(&order[first..]) {
            *to = from[*at as usize];
        }
    });
}

/// Scatters elements by slot to an array by particle.
pub fn to_particles<P: PairList, T: Copy + Send + Sync>(list: &P, from: &[T], to: &mut [T]) {
    let order = list.particles();
    let n = order.len();
    assert!(from.len() == n && to.len() == n, "one vector per slot");
    let to = Disjoint::new(to);
    for_each_range(n, |slots| {
        for (from, at) in from[slots.clone()].iter().zip(&order[slots]) {
            // SAFETY: each particle has one slot.
            unsafe { to.write(*at as usize, *from) };
        }
    });
}
