//! The counting sort by cell, which both kinds of tables are made with.

use lennard_core::parallel::for_each_piece;

/// Which of the positions that a table was sorted from stands at each place, and whose it is.
#[derive(Debug, Clone, Default)]
pub(crate) struct Standing {
    /// The cell of each position, as given.
    pub home: Vec<u32>,
    /// First place of each cell, and the end, `[cells + 1]`.
    pub first: Vec<u32>,
    /// Which position stands at each place.
    pub from: Vec<u32>,
}

impl Standing {
    /// Sorts positions, whose cells are in `home`, into that many `cells`, and those of one cell by particle. `particle`
    /// has the particle of each place: where `again`, that of each position, given in the order of the last sort; otherwise
    /// positions are given by particle.
    pub fn sort(&mut self, cells: usize, particle: &mut Vec<u32>, again: bool) {
        let Self { home, first, from } = self;
        // Two ahead: after the scatter, entry c + 1 has moved from the first place of c to that of c + 1.
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
        from.resize(home.len(), 0);
        for (position, home) in home.iter().enumerate() {
            let place = &mut first[*home as usize + 1];
            from[*place as usize] = position as u32;
            *place += 1;
        }
        first.truncate(cells + 1);
        if !again {
            particle.clone_from(from);
            return;
        }
        for ends in first.windows(2) {
            let [begin, end] = [ends[0] as usize, ends[1] as usize];
            if end - begin > 1 {
                from[begin..end].sort_unstable_by_key(|position| particle[*position as usize]);
            }
        }
        let before = std::mem::replace(particle, vec![0; from.len()]);
        for_each_piece(particle, |first, particles| {
            for (particle, position) in particles.iter_mut().zip(&from[first..]) {
                *particle = before[*position as usize];
            }
        });
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        4 * (self.home.capacity() + self.first.capacity() + self.from.capacity())
    }
}
