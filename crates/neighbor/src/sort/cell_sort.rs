//! The counting sort by cell, which both kinds of tables use.

use lennard_core::parallel::for_each_piece;

use super::positions::Positions;

/// Whether the cells of the positions have a meaning after a sort.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Afterwards {
    Kept,
    /// The sort takes their room, and needs none beside it.
    Lost,
}

/// The result of a counting sort: which of the given positions belongs to each slot.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellSort {
    /// The cell of each position, in the order of the positions, `[N]`.
    pub home: Vec<u32>,
    /// The first slot of each cell, and the end, `[cells + 1]`.
    pub first: Vec<u32>,
    /// The index of the position that belongs to each slot, `[N]`.
    pub source: Vec<u32>,
}

impl CellSort {
    /// Sorts positions whose cells are in `home` into `cells` cells. Inside a cell, particles are in ascending order.
    ///
    /// `particle` holds the particle at each slot: of the last sort on entry, of this sort on return.
    pub fn sort(
        &mut self,
        (cells, afterwards): (usize, Afterwards),
        particle: &mut Vec<u32>,
        positions: Positions<'_>,
    ) {
        let Self { home, first, source } = self;
        // Counts are stored two cells ahead. The scatter below advances entry c + 1 through cell c.
        // Afterwards entry c + 1 is the first slot of cell c + 1.
        first.clear();
        first.resize(cells + 2, 0);
        for home in &*home {
            first[*home as usize + 2] += 1;
        }
        let mut before = 0;
        for first in &mut *first {
            before += *first;
            *first = before;
        }
        source.resize(home.len(), 0);
        for (position, home) in home.iter().enumerate() {
            let slot = &mut first[*home as usize + 1];
            source[*slot as usize] = position as u32;
            *slot += 1;
        }
        first.truncate(cells + 1);
        if let Positions::ById(_) = positions {
            particle.clone_from(source);
            return;
        }
        for ends in first.windows(2) {
            let [begin, end] = [ends[0] as usize, ends[1] as usize];
            if end - begin > 1 {
                source[begin..end].sort_unstable_by_key(|position| particle[*position as usize]);
            }
        }
        // Cells that have served give their room.
        let mut before = match afterwards {
            Afterwards::Kept => vec![0; source.len()],
            Afterwards::Lost => std::mem::take(home),
        };
        std::mem::swap(&mut before, particle);
        for_each_piece(particle, |first, particles| {
            for (particle, position) in particles.iter_mut().zip(&source[first..]) {
                *particle = before[*position as usize];
            }
        });
        if afterwards == Afterwards::Lost {
            *home = before;
        }
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        4 * (self.home.capacity() + self.first.capacity() + self.source.capacity())
    }
}
