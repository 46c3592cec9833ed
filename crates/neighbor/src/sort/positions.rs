//! The positions that a sort is given, and why a sort can fail.

use std::fmt;
use std::ops::Range;

use glam::DVec3;
use lennard_core::Team;

/// Why particles cannot be sorted.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GridError {
    /// A coordinate is not finite, or it is so large that its digits no longer tell where in the box it lies.
    #[error("the position of particle {particle} is not a usable number")]
    BadPosition {
        /// Index of the particle, from 0.
        particle: usize,
    },
}

/// Unwrapped positions to sort, σ. Both orders give the same table.
#[derive(Debug, Clone, Copy)]
pub enum Positions<'a> {
    /// Element k belongs to particle k.
    ById(&'a [DVec3]),
    /// Element k belongs to the particle at slot k of the last sort.
    ///
    /// This order sorts faster, since most particles keep nearly the same slot.
    BySlot(&'a [DVec3]),
    /// As [`Positions::BySlot`], where each rank knows the elements of its own slots alone.
    ///
    /// All ranks sort together, and have the same order afterwards.
    Parted(&'a [DVec3], &'a Ranks),
}

/// The slots of several ranks.
#[derive(Clone)]
pub struct Ranks {
    /// The ranks.
    pub team: Team,
    /// The slots of each rank.
    pub slots: Vec<Range<usize>>,
}

impl Ranks {
    /// The slots of this rank.
    #[must_use]
    pub fn own(&self) -> Range<usize> {
        self.slots[self.team.rank()].clone()
    }
}

impl fmt::Debug for Ranks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "rank {} of {:?}", self.team.rank(), self.slots)
    }
}

impl<'a> Positions<'a> {
    /// The positions in their own order.
    #[must_use]
    pub fn values(self) -> &'a [DVec3] {
        let (Self::ById(positions) | Self::BySlot(positions) | Self::Parted(positions, _)) = self;
        positions
    }

    /// The position at each slot, where `source` has the element of it.
    pub(crate) fn by_slot(self, source: &[u32]) -> impl Fn(usize) -> DVec3 + Sync {
        let values = self.values();
        move |slot| values[source[slot] as usize]
    }

    /// The elements that this process knows.
    pub(crate) fn known(self) -> Range<usize> {
        match self {
            Self::ById(positions) | Self::BySlot(positions) => 0..positions.len(),
            Self::Parted(_, ranks) => ranks.own(),
        }
    }

    /// The first element, of all ranks, whose position is not usable, and whether any position is far from the home box.
    pub(crate) fn agree(self, bad: Option<usize>, is_far: bool) -> (Option<usize>, bool) {
        let Self::Parted(positions, ranks) = self else {
            return (bad, is_far);
        };
        let n = positions.len();
        let mut words = [bad.map_or(0, |first| (n - first) as u64), u64::from(is_far)];
        ranks.team.max(&mut words);
        let first = (words[0] > 0).then(|| n - words[0] as usize);
        (first, words[1] > 0)
    }

    /// Makes an array known that has a number for each element, of which each rank knows its own.
    pub(crate) fn make_numbers_known(self, numbers: &mut [u32]) {
        if let Self::Parted(_, ranks) = self {
            ranks.team.gather_numbers(numbers, &ranks.slots);
        }
    }

    /// As [`Positions::make_numbers_known`], for vectors.
    pub(crate) fn make_vectors_known(self, vectors: &mut [DVec3]) {
        if let Self::Parted(_, ranks) = self {
            ranks.team.gather(vectors, &ranks.slots);
        }
    }

    /// The particle of element `k`, where `particle` holds the particle at each slot of the last sort.
    pub(crate) fn particle(self, k: usize, particle: &[u32]) -> usize {
        match self {
            Self::ById(_) => k,
            Self::BySlot(_) | Self::Parted(..) => particle[k] as usize,
        }
    }
}
