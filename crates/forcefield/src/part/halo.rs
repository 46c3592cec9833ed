//! The particles within the list radius of a part, whose positions come in each step.

use std::sync::MutexGuard;

use lennard_core::tasks::for_each_item;
use lennard_core::{Parcel, Team};

/// Particles around a part, and particles of this rank around other parts.
#[derive(Default)]
pub struct Halo {
    /// For each rank, the slots of the particles of that rank, in its order.
    pub wanted: Vec<Vec<u32>>,
    /// For each rank, the own slots of the particles that it wants.
    pub given: Vec<Vec<u32>>,
}

impl Halo {
    /// A halo without particles, among so many ranks.
    pub fn among(ranks: usize) -> Self {
        Self { wanted: vec![Vec::new(); ranks], given: vec![Vec::new(); ranks] }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.wanted.iter().map(Vec::len).sum()
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        4 * self.wanted.iter().chain(&self.given).map(Vec::capacity).sum::<usize>()
    }

    /// Lets a particle of another rank come too, and a particle of this rank go there, where they do not yet.
    pub fn add(&mut self, rank: usize, wanted: u32, given: u32) {
        for (slots, slot) in [(&mut self.wanted[rank], wanted), (&mut self.given[rank], given)] {
            if !slots.contains(&slot) {
                slots.push(slot);
            }
        }
    }

    /// Makes a parcel for each rank with slots in a list by rank, with room for so many words of each.
    pub fn address(slots: &[Vec<u32>], words: usize, parcels: &mut Vec<Parcel>) {
        let full = slots.iter().enumerate().filter(|(_, slots)| !slots.is_empty());
        let mut used = 0;
        for (rank, slots) in full {
            if used == parcels.len() {
                parcels.push(Parcel::default());
            }
            parcels[used].rank = rank;
            parcels[used].words.resize(words * slots.len(), 0);
            used += 1;
        }
        parcels.truncate(used);
    }
}

/// What goes out of a part and comes to its halo in one step.
pub struct Mail<'a> {
    pub(super) halo: &'a Halo,
    pub(super) team: &'a Team,
    /// Words of a particle.
    pub(super) words: usize,
    pub(super) buffers: MutexGuard<'a, [Vec<Parcel>; 2]>,
}

impl Mail<'_> {
    /// Fills what goes out: `write` gives the words of an own slot.
    pub fn send(&mut self, write: impl Fn(usize, &mut [u32]) + Sync) {
        let [outgoing, _] = &mut *self.buffers;
        for Parcel { rank, words } in outgoing {
            let slots = self.halo.given[*rank].chunks(PARTICLES_A_TASK);
            let tasks = words.chunks_mut(self.words * PARTICLES_A_TASK).zip(slots);
            for_each_item(tasks, |(), _, (words, slots)| {
                let particles = words.chunks_exact_mut(self.words).zip(slots);
                particles.for_each(|(to, slot)| write(*slot as usize, to));
            });
        }
    }

    /// Sends it, does some work, and waits for what comes.
    pub fn exchange(&mut self, meanwhile: &mut dyn FnMut()) {
        let [outgoing, incoming] = &mut *self.buffers;
        self.team.exchange(outgoing, incoming, meanwhile);
    }

    /// Takes what came: `read` gets the words of each slot of the halo once.
    pub fn receive(&self, read: impl Fn(usize, &[u32]) + Sync) {
        let [_, incoming] = &*self.buffers;
        for Parcel { rank, words } in incoming {
            let slots = self.halo.wanted[*rank].chunks(PARTICLES_A_TASK);
            let tasks = words.chunks(self.words * PARTICLES_A_TASK).zip(slots);
            for_each_item(tasks, |(), _, (words, slots)| {
                let particles = words.chunks_exact(self.words).zip(slots);
                particles.for_each(|(from, slot)| read(*slot as usize, from));
            });
        }
    }
}

/// Particles that one task writes or reads.
const PARTICLES_A_TASK: usize = 2048;
