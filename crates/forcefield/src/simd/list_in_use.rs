//! A list in use: the motion since its build, and whether it may be used at some positions.

use glam::DVec3;
use lennard_core::{Own, PeriodicBox};
use lennard_neighbor::{
    Criterion, Displacements, NowAndThen, PackedDisplacement, PairList, Validity, unlisted_pairs,
};

use super::level::Level;
use super::motion::{Motion, MotionSummary, SlotSpecies};
use super::row::DoubleRow;
use crate::interaction::Pairwise;
use crate::part::Part;
use crate::validity::build::{Build, Lacking};

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
    /// The list lacks these pairs.
    Incomplete(Vec<Lacking>),
    /// The list may lack pairs, and it must be built again.
    Expired,
    /// A position is not a finite number.
    NonFinite,
}

/// Fetches the positions of the halo while some work is done: of all of it, or of what lists name.
pub type Fetch<'a> = dyn Fn(bool, &mut dyn FnMut()) + Sync + 'a;

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
    /// Packed displacements change the time that it takes, and never the result. `fetch` brings positions of the halo.
    pub fn judge<'p>(
        &self,
        summary: &MotionSummary,
        packed: Option<&[PackedDisplacement]>,
        at: &(dyn Fn() -> Ordered<'p> + Sync),
        fetch: Option<&Fetch<'_>>,
    ) -> ListStatus {
        let n = self.list.whole();
        let largest2 = match self.part {
            None => summary.finite.then_some(summary.largest2),
            Some(part) => part.largest2(summary),
        };
        let Some(largest2) = largest2 else {
            return ListStatus::NonFinite;
        };
        match self.criterion.check(largest2, 0, n) {
            Validity::Valid => return ListStatus::Complete,
            Validity::Expired => return ListStatus::Expired,
            Validity::Uncertain => {}
        }
        let movers = Own::whole_of(self.part.map(Part::team), summary.far.len());
        if self.criterion.check(largest2, movers, n) == Validity::Expired {
            return ListStatus::Expired;
        }
        if let Some(fetch) = fetch {
            fetch(true, &mut || {});
        }
        let at = at();
        let displacements = |packed, partners| Displacements {
            cells: self.list.cells(),
            at: |slot: u32| self.now_and_then(at, slot),
            packed,
            largest2,
            partners,
        };
        let mut found = self.unlisted_pairs(displacements(packed, None), &summary.far);
        if let Some(part) = self.part {
            // Pairs of two far movers are found twice, and other ranks find the pairs of others.
            let moved2 = |slot: &u32| {
                let [now, then] = self.now_and_then(at, *slot);
                (now - then).length_squared()
            };
            let halo = self.list.own() as u32..self.built.len() as u32;
            let far: Vec<u32> = halo.filter(|s| moved2(s) > self.criterion.far2()).collect();
            let partners = Some(part.partners());
            found.extend(self.unlisted_pairs(displacements(None, partners), &far));
        }
        self.missing(found)
    }

    /// Of the pairs of slots that were found, those that a list of any rank lacks.
    fn missing(&self, mut found: Vec<[u32; 2]>) -> ListStatus {
        let particles = self.list.particles();
        found.retain(|pair| !self.list.contains(*pair));
        let lacking = |slots: [u32; 2]| Lacking {
            particles: slots.map(|slot| particles[slot as usize]),
            slots: Some(slots),
        };
        let lacking: Vec<Lacking> = match self.part {
            None => found.into_iter().map(lacking).collect(),
            Some(part) if P::INSERTS => part.missing(self.list, &found),
            Some(part) if part.team().any(!found.is_empty()) => return ListStatus::Expired,
            Some(_) => Vec::new(),
        };
        if lacking.is_empty() { ListStatus::Complete } else { ListStatus::Incomplete(lacking) }
    }

    /// The position of the particle at a slot, and its position at the build.
    #[inline(always)]
    fn now_and_then(&self, at: Ordered<'_>, slot: u32) -> NowAndThen {
        let slot = slot as usize;
        [at.positions[at.index(slot)], self.built[slot]]
    }

    /// The pairs inside the cutoff that were beyond the list radius at the build, ahead of the far movers.
    ///
    /// The box equals the box of the build: in any other box the criterion never asks for this search.
    fn unlisted_pairs<A: Fn(u32) -> NowAndThen + Sync>(
        &self,
        displacements: Displacements<'_, A>,
        far: &[u32],
    ) -> Vec<[u32; 2]> {
        let Build { cell, r_list, .. } = self.build;
        unlisted_pairs(cell, *r_list, self.build.inner(), displacements, far)
    }
}
