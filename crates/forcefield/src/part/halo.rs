//! The particles around a part, and the ranks that have them.

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
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.wanted.iter().map(Vec::len).sum()
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        4 * self.wanted.iter().chain(&self.given).map(Vec::capacity).sum::<usize>()
    }

    /// Makes a parcel for each rank with slots in some lists by rank, with room for them.
    pub fn address<'a>(
        lists: impl Iterator<Item = &'a [Vec<u32>]> + Clone,
        parcels: &mut Vec<Parcel>,
    ) {
        let ranks = lists.clone().map(<[_]>::len).max().unwrap_or(0);
        let count = |rank: usize| lists.clone().map(|list| list[rank].len()).sum::<usize>();
        let ranks = (0..ranks).map(|rank| (rank, count(rank))).filter(|(_, count)| *count > 0);
        let mut used = 0;
        for (rank, count) in ranks {
            if used == parcels.len() {
                parcels.push(Parcel::default());
            }
            parcels[used].rank = rank;
            parcels[used].vectors.resize(count, [0.0; 3]);
            used += 1;
        }
        parcels.truncate(used);
    }
}
