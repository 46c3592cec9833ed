//! The counting sort by cell, which both kinds of tables are made with.

use glam::DVec3;
use lennard_core::parallel::for_each_piece;

/// Positions (unwrapped, σ) to sort. What comes of them is the same either way.
#[derive(Debug, Clone, Copy)]
pub enum Given<'a> {
    /// In the order of the particles.
    ByParticle(&'a [DVec3]),
    /// In the order of the places that the same particles have since the last sort, which takes less time, since places
    /// change little.
    ByPlace(&'a [DVec3]),
}

impl<'a> Given<'a> {
    /// The positions, in their order.
    #[must_use]
    pub fn positions(self) -> &'a [DVec3] {
        let (Self::ByParticle(positions) | Self::ByPlace(positions)) = self;
        positions
    }

    /// Whose a position is, where `particle` has the particle of each place.
    pub(crate) fn particle_of(self, position: usize, particle: &[u32]) -> usize {
        match self {
            Self::ByParticle(_) => position,
            Self::ByPlace(_) => particle[position] as usize,
        }
    }
}

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
    /// Sorts what is `given`, whose cells are in `home`, into that many `cells`, and those of one cell by particle;
    /// `particle` has the particle of each place, before and after.
    pub fn sort(&mut self, cells: usize, particle: &mut Vec<u32>, given: Given<'_>) {
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
        if let Given::ByParticle(_) = given {
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
