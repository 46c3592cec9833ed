//! What moves between ranks at a build: particles to their new ranks, and positions around the particles of each rank.

use std::ops::Range;

use glam::DVec3;
use lennard_core::parallel::{for_each_piece, map_ranges};

use super::{Share, rank_of};

impl Share {
    /// Notes which particles a build moves between ranks; `source` has the slot before it of the particle at each slot.
    pub fn plan_moves(&mut self, source: &[u32]) {
        let (own, own_before) = (self.own(), self.own_before());
        let was_own = |slot: u32| own_before.contains(&(slot as usize));
        let is_own = |slot: u32| own.contains(&(slot as usize));
        let moved: Vec<[u32; 2]> = map_ranges(source.len(), |slots| {
            let moves = slots.map(|slot| [slot as u32, source[slot]]);
            let moves = moves.filter(|[slot, before]| is_own(*slot) != was_own(*before));
            moves.collect::<Vec<_>>()
        })
        .concat();
        let nothing = vec![Vec::new(); self.slots().len()];
        (self.leaving, self.arriving) = (nothing.clone(), nothing);
        // Both ranks have them in the order of their slots after the build.
        for [slot, before] in moved {
            if is_own(slot) {
                self.arriving[rank_of(&self.before, before)].push(slot);
            } else {
                self.leaving[rank_of(&self.ranks.slots, slot)].push(before);
            }
        }
    }

    /// Brings vectors of the particles of this rank from the slots before a build to the slots after it.
    pub fn migrate(&self, source: &[u32], from: &[DVec3], to: &mut [DVec3]) {
        let (own, own_before) = (self.own(), self.own_before());
        let stays = |slot: u32| own_before.contains(&(slot as usize));
        for_each_piece(&mut to[own.clone()], |first, piece| {
            for (to, before) in piece.iter_mut().zip(&source[own.start + first..]) {
                if stays(*before) {
                    *to = from[*before as usize];
                }
            }
        });
        self.swap(
            [&self.leaving, &self.arriving],
            |before| from[before as usize],
            &mut || {},
            |slot, vector| to[slot as usize] = vector,
        );
    }

    /// Fetches the positions of a build by slot that the search of this rank looks into: `near` has runs of their slots.
    pub fn fetch_near(&mut self, near: &[Range<usize>], built: &mut [DVec3]) {
        self.want(near.iter().cloned().flatten().map(|slot| slot as u32));
        let mut found = Vec::new();
        let put = |slot, r| found.push((slot, r));
        self.fetch(|slot| built[slot as usize], &mut || {}, put);
        for (slot, r) in found {
            built[slot as usize] = r;
        }
    }
}
