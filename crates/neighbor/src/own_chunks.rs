//! The lists that a process keeps: all, or the lists of one rank.

use std::ops::Range;

use crate::rows::ATOMS_PER_CHUNK;

/// The chunks whose lists are kept: all, or the chunks of one rank. All others stay empty.
#[derive(Debug, Clone, Default)]
pub(crate) struct OwnChunks(Option<Range<usize>>);

impl OwnChunks {
    /// The chunks `own` alone; the others are emptied.
    pub(crate) fn alone<C: Default>(own: Range<usize>, chunks: &mut [C]) -> Self {
        let all = chunks.iter_mut().enumerate();
        for (_, chunk) in all.filter(|(c, _)| !own.contains(c)) {
            *chunk = C::default();
        }
        Self(Some(own))
    }

    /// The kept ones of so many chunks.
    pub(crate) fn of(&self, chunks: usize) -> Range<usize> {
        self.0.clone().unwrap_or(0..chunks)
    }
}

/// The slots of some chunks of `n` particles.
#[must_use]
pub fn slots_of(chunks: &Range<usize>, n: usize) -> Range<usize> {
    let slot = |chunk: usize| (chunk * ATOMS_PER_CHUNK).min(n);
    slot(chunks.start)..slot(chunks.end)
}
