//! A list in use: the motion since its build, and whether it may be used at some positions.

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_neighbor::{
    Criterion, Displacements, NowAndThen, PackedDisplacement, PairList, Partners, Validity,
    unlisted_pairs,
};

use super::level::Level;
use super::motion::{Motion, MotionSummary, SlotSpecies};
use super::row::DoubleRow;
use crate::interaction::Pairwise;
use crate::part::{Part, Settled};
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
    /// The list lacks these pairs of slots. On ranks, other ranks may have complete lists.
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
    /// The part of this rank, where there are several.
    pub part: Option<&'a Part>,
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

    /// Judges the list at some positions, by the motion since its build. All ranks come to the judgment of one process.
    ///
    /// Packed displacements change the time that it takes, and never the result.
    pub fn judge<'p>(
        &self,
        summary: &MotionSummary,
        packed: Option<&[PackedDisplacement]>,
        at: &(dyn Fn() -> Ordered<'p> + Sync),
    ) -> ListStatus {
        let n = self.list.whole();
        let motion = match self.part {
            None => summary.finite.then_some((summary.largest2, summary.far.len())),
            Some(part) => part.motion(summary),
        };
        let Some((largest2, far)) = motion else {
            return ListStatus::NonFinite;
        };
        match self.criterion.check(largest2, far, n) {
            Validity::Valid => return ListStatus::Complete,
            Validity::Expired => return ListStatus::Expired,
            Validity::Uncertain => {}
        }
        let at = at();
        let lacking = match self.part {
            None => {
                let of_slot = |slot| self.now_and_then(at, slot);
                let mut found =
                    self.unlisted_pairs(of_slot, (packed, None), largest2, &summary.far);
                found.retain(|pair| !self.list.contains(*pair));
                found
            }
            Some(part) => self.unlisted_on_rank(part, at, largest2, &summary.far),
        };
        // Lists that insert nothing expire on all ranks.
        let expires = match self.part {
            Some(part) if !P::INSERTS => part.team().any(!lacking.is_empty()),
            _ => false,
        };
        if expires {
            ListStatus::Expired
        } else if lacking.is_empty() {
            ListStatus::Complete
        } else {
            ListStatus::Incomplete(lacking)
        }
    }

    /// The pairs of slots that the lists of this rank lack: own particles look for the far movers of all ranks.
    fn unlisted_on_rank(
        &self,
        part: &Part,
        at: Ordered<'_>,
        largest2: f64,
        own: &[u32],
    ) -> Vec<[u32; 2]> {
        let settled = Settled { list: self.list, cell: &self.build.cell, built: self.built };
        let movers = part.far_movers(&settled, own, |slot| self.now_and_then(at, slot)[0]);
        let far: Vec<u32> = own.iter().copied().chain(movers.slots()).collect();
        let first = self.list.own() as u32;
        let of_slot = |slot: u32| match slot < first {
            true => self.now_and_then(at, slot),
            false => [movers.position(slot), self.built[slot as usize]],
        };
        let partners = Some(part.partners());
        let found = self.unlisted_pairs(of_slot, (None, partners), largest2, &far);
        if P::INSERTS { part.missing(&settled, &movers, found) } else { found }
    }

    /// The position of the particle at a slot, and its position at the build.
    #[inline(always)]
    fn now_and_then(&self, at: Ordered<'_>, slot: u32) -> NowAndThen {
        let slot = slot as usize;
        [at.positions[at.index(slot)], self.built[slot]]
    }

    /// The pairs inside the cutoff that were beyond the list radius at the build, ahead of the far movers. `of_slot` gives the position
    /// now and at the build.
    ///
    /// The box equals the box of the build: in any other box the criterion never asks for this search.
    fn unlisted_pairs(
        &self,
        of_slot: impl Fn(u32) -> NowAndThen + Sync,
        (packed, partners): (Option<&[PackedDisplacement]>, Option<&Partners>),
        largest2: f64,
        far: &[u32],
    ) -> Vec<[u32; 2]> {
        let Build { cell, r_list, .. } = self.build;
        let cells = self.list.cells();
        let displacements = Displacements { cells, at: of_slot, packed, largest2, partners };
        unlisted_pairs(cell, *r_list, self.build.inner(), displacements, far)
    }
}
