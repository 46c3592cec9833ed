//! The particles within the list radius of a part, whose positions come in each step.

use lennard_core::Parcel;

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

    /// The slots of the particles.
    pub fn slots(&self) -> impl Iterator<Item = usize> {
        self.wanted.iter().flatten().map(|slot| *slot as usize)
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

    /// Makes a parcel for each rank with slots in a list by rank, with room for them.
    pub fn address(slots: &[Vec<u32>], parcels: &mut Vec<Parcel>) {
        let full = slots.iter().enumerate().filter(|(_, slots)| !slots.is_empty());
        let mut used = 0;
        for (rank, slots) in full {
            if used == parcels.len() {
                parcels.push(Parcel::default());
            }
            parcels[used].rank = rank;
            parcels[used].vectors.resize(slots.len(), [0.0; 3]);
            used += 1;
        }
        parcels.truncate(used);
    }
}
