//! An interaction of any kind behind a pointer, so that lists and steps are compiled once for all of them.

use glam::DVec3;
use lennard_core::{Configuration, Exclusions};
use lennard_neighbor::{ClusterList, NeighborList};

use crate::canonical::CanonicalJob;
use crate::interaction::{Interaction, SplitWeights};
use crate::pair::Model;
use crate::reference;
use crate::simd::{Detail, LoopOver, PerParticle};
use crate::sums::Totals;

/// An interaction of any kind. Only the loops themselves know which.
pub trait AnyInteraction: LoopOver<NeighborList> + LoopOver<ClusterList> + Sync {
    /// Runs the canonical loop: [`CanonicalJob::run`].
    fn canonical(
        &self,
        job: &CanonicalJob<'_>,
        detail: Detail,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Totals;

    /// Runs the reference loop: [`reference::evaluate`].
    fn reference(
        &self,
        model: &Model,
        exclusions: &Exclusions,
        at: Configuration<'_>,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Totals;
}

impl<I: Interaction> AnyInteraction for I {
    fn canonical(
        &self,
        job: &CanonicalJob<'_>,
        detail: Detail,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Totals {
        job.run(self, detail, forces, each)
    }

    fn reference(
        &self,
        model: &Model,
        exclusions: &Exclusions,
        at: Configuration<'_>,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Totals {
        reference::evaluate(self, model, exclusions, at, forces, each)
    }
}

/// Calls `work` with the interaction of the whole force.
pub fn with_whole<I: Interaction, R>(
    interaction: I,
    work: impl FnOnce(&dyn AnyInteraction) -> R,
) -> R {
    // The constant is alone in its condition: only then does the compiler drop the other instance.
    if I::SHARES_LOOPS_OF_PARTS {
        return work(&SplitWeights::WHOLE.of(interaction));
    }
    work(&interaction)
}
