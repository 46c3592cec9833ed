//! The positions that a sort is given, and why a sort can fail.

use glam::DVec3;

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
    /// Element k belongs to the particle at slot k of the last sort, or to the particle of a part that was given a number last.
    ///
    /// This order sorts faster, since most particles keep nearly the same slot.
    BySlot(&'a [DVec3]),
}

impl<'a> Positions<'a> {
    /// The positions in their own order.
    #[must_use]
    pub fn values(self) -> &'a [DVec3] {
        let (Self::ById(positions) | Self::BySlot(positions)) = self;
        positions
    }

    /// The position at each slot, where `source` has the element of it.
    pub(crate) fn by_slot(self, source: &[u32]) -> impl Fn(usize) -> DVec3 + Sync {
        let values = self.values();
        move |slot| values[source[slot] as usize]
    }

    /// The particle of element `k`, where `particle` holds the particle at each slot of the last sort.
    pub(crate) fn particle(self, k: usize, particle: &[u32]) -> usize {
        match self {
            Self::ById(_) => k,
            Self::BySlot(_) => particle[k] as usize,
        }
    }
}
