//! The result of an evaluation.

use lennard_core::Team;

use crate::simd::{Detail, ListStatus, Outcome};
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
    /// The result of a loop over chunks, of which each rank of a team has some.
    pub fn of(outcome: Outcome, detail: Detail, team: Option<&Team>) -> Self {
        let has_totals = detail != Detail::Forces && outcome.status == ListStatus::Complete;
        Self {
            status: outcome.status,
            totals: if has_totals {
                Totals::of_chunks(&outcome.totals, team)
            } else {
                Totals::NOTHING
            },
            broken: outcome.broken,
        }
    }
}
