//! A list in use: the motion since its build, and whether it may be used at some positions.

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_neighbor::{
    Criterion, Displacements, NowAndThen, PackedDisplacement, PairList, Validity, unlisted_pairs,
};

use super::level::Level;
use super::motion::{Motion, MotionSummary, SlotSpecies};
use super::row::DoubleRow;
use crate::interaction::Pairwise;
use crate::share::Share;
use crate::validity::build::Build;

/// Positions and the index in them of each slot.
#[derive(Clone, Copy)]
pub struct Ordered<'a> {
    /// Unwrapped positions, σ.
    pub positions: &'a [DVec3],
    /// The index in `positions` of each slot; none where positions are by slot.
    pub order: Option<&'a [u32]>,
}

impl<'a> Ordered<'a> {
    /// Positions with the index in them of each slot.
    pub fn of(positions: &'a [DVec3], order: &'a [u32]) -> Self {
        Self { positions, order: Some(order) }
    }

    /// Positions by slot.
    pub fn by_slot(positions: &'a [DVec3]) -> Self {
        Self { positions, order: None }
    }

    /// The index in the positions of a slot.
    #[inline(always)]
    pub fn index(&self, slot: usize) -> usize {
        self.order.map_or(slot, |order| order[slot] as usize)
    }
}

/// Whether a list may be used at some positions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ListStatus {
    /// The list contains every pair inside the cutoff.
    Complete,
    /// The list lacks these pairs of slots.
    Incomplete(Vec<[u32; 2]>),
    /// The list may lack pairs, and it must be built again.
    Expired,
    /// A position is not a finite number.
    NonFinite,
}

/// A list with all that its use in a box depends on.
pub struct ListInUse<'a, P> {
    /// The list.
    pub list: &'a P,
    /// The instruction set of the loops.
    pub level: Level,
    /// The box.
    pub cell: &'a PeriodicBox,
    /// The force that the list serves.
    pub pairwise: &'a Pairwise,
    /// The build.
    pub build: &'a Build,
    /// Positions of the build by slot, σ.
    pub built: &'a [DVec3],
    /// The species at each slot, where there are several.
    pub species: Option<&'a [u8]>,
    /// The sides of the box over its sides at the build.
    pub stretch: DVec3,
    /// The criterion in the box.
    pub criterion: Criterion,
    /// The share of this rank, where there are several.
    pub share: Option<&'a Share>,
}

impl<P: PairList> ListInUse<'_, P> {
    /// The motion from the build to some positions.
    pub fn motion<'a>(&'a self, at: Ordered<'a>) -> Motion<'a> {
        Motion {
            positions: at.positions,
            order: at.order,
            built: self.built,
            stretch: self.stretch,
            far2: self.criterion.far2(),
            lengths: self.cell.lengths(),
            species: self
                .species
                .map(|at| SlotSpecies { at, paddings: DoubleRow::paddings(self.level) }),
        }
    }

    /// Judges the list at some positions, by the motion since its build.
    ///
    /// Packed displacements change the time that it takes, and never the result.
    pub fn judge(
        &self,
        summary: &MotionSummary,
        packed: Option<&[PackedDisplacement]>,
        at: Ordered<'_>,
    ) -> ListStatus {
        if let Some(share) = self.share {
            return self.judge_together(share, summary, at);
        }
        if !summary.finite {
            return ListStatus::NonFinite;
        }
        match self.criterion.check(summary.largest2, summary.far.len(), self.built.len()) {
            Validity::Valid => ListStatus::Complete,
            Validity::Expired => ListStatus::Expired,
            Validity::Uncertain => self.unlisted(summary, packed, at),
        }
    }

    /// Judges a list together with the other ranks: all come to the judgment of one rank that sees all particles.
    fn judge_together(
        &self,
        share: &Share,
        summary: &MotionSummary,
        at: Ordered<'_>,
    ) -> ListStatus {
        let n = self.built.len();
        let Some(largest2) = share.largest2(summary) else {
            return ListStatus::NonFinite;
        };
        match self.criterion.check(largest2, 0, n) {
            Validity::Valid => return ListStatus::Complete,
            Validity::Expired => return ListStatus::Expired,
            Validity::Uncertain => {}
        }
        let own_at = |slot: u32| self.now_and_then(at, slot);
        let movers = share.far_movers(&summary.far, own_at);
        if self.criterion.check(largest2, movers.len(), n) == Validity::Expired {
            return ListStatus::Expired;
        }
        let far: Vec<u32> = movers.iter().map(|(slot, _)| *slot).collect();
        let own = share.own();
        let displacements = Displacements {
            cells: self.list.cells(),
            // Positions of other ranks are known of far movers alone, and the search asks for no others.
            at: |slot: u32| {
                if own.contains(&(slot as usize)) {
                    return own_at(slot);
                }
                let mover = movers.binary_search_by_key(&slot, |(slot, _)| *slot);
                mover.map_or([DVec3::NAN; 2], |mover| movers[mover].1)
            },
            packed: None,
            largest2,
            partners: Some(share.partners()),
        };
        let found = self.unlisted_pairs(displacements, &far);
        let missing = share.missing(&found, |pair| self.list.contains(pair));
        if missing.is_empty() { ListStatus::Complete } else { ListStatus::Incomplete(missing) }
    }

    /// The position of the particle at a slot, and its position at the build.
    #[inline(always)]
    fn now_and_then(&self, at: Ordered<'_>, slot: u32) -> NowAndThen {
        let slot = slot as usize;
        [at.positions[at.index(slot)], self.built[slot]]
    }

    /// Whether the list contains every pair inside the cutoff, by a search ahead of the far movers.
    ///
    /// The box equals the box of the build: in any other box the criterion never asks for this search.
    fn unlisted(
        &self,
        summary: &MotionSummary,
        packed: Option<&[PackedDisplacement]>,
        at: Ordered<'_>,
    ) -> ListStatus {
        let displacements = Displacements {
            cells: self.list.cells(),
            at: |slot: u32| self.now_and_then(at, slot),
            packed,
            largest2: summary.largest2,
            partners: None,
        };
        let mut unlisted = self.unlisted_pairs(displacements, &summary.far);
        unlisted.retain(|pair| !self.list.contains(*pair));
        if unlisted.is_empty() { ListStatus::Complete } else { ListStatus::Incomplete(unlisted) }
    }

    /// The pairs inside the cutoff that were beyond the list radius at the build, ahead of the far movers.
    fn unlisted_pairs<A: Fn(u32) -> NowAndThen + Sync>(
        &self,
        displacements: Displacements<'_, A>,
        far: &[u32],
    ) -> Vec<[u32; 2]> {
        let Build { cell, r_list, .. } = self.build;
        unlisted_pairs(cell, *r_list, self.build.inner(), displacements, far)
    }
}
