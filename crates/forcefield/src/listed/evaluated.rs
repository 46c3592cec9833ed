//! The result of an evaluation.

use crate::simd::{ListStatus, Outcome};
use crate::sums::Totals;

/// The result of an evaluation with a list of any kind.
pub struct Evaluated {
    /// Whether the list could be used. If not, there are no sums.
    pub status: ListStatus,
    /// The totals over all pairs; nothing where only forces are summed.
    pub totals: Totals,
    /// Whether a force is not finite.
    pub broken: bool,
}

impl Evaluated {
    /// The result of a loop over chunks.
    pub fn of(outcome: Outcome) -> Self {
        Self {
            status: outcome.status,
            totals: Totals::of_chunks(&outcome.totals),
            broken: outcome.broken,
        }
    }
}
