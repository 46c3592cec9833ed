//! A Verlet list at work: positions are packed into rows, the list is judged before each use, and pairs are summed.

mod folded;
mod persist;

use std::sync::Arc;

use glam::DVec3;
use lennard_core::{
    Configuration, Exclusions, ForceError, FusedSteps, PeriodicBox, SpeedLimit, Team,
};
use lennard_neighbor::{ClusterList, FIXED_UNITS, Images, NeighborList};

use self::folded::Folded;
use crate::clock::Clock;
use crate::fused::FusedBuffers;
use crate::interaction::Pairwise;
use crate::non_finite;
use crate::part::Part;
use crate::simd::{KickDrift, Level, ListStatus, PackedCopies, PackedList, Prepared, Request};
use crate::sums::{Detail, PerParticle, Totals};
use crate::validity::ListValidity;

/// The smallest number of fused steps that is worth gathering the particles by slot.
const FEWEST_STEPS: u64 = 3;

/// A list of one kind with everything that belongs to it.
pub struct Listed<P: PackedList> {
    list: P,
    validity: ListValidity,
    packed: PackedCopies<P::Row>,
    fused: FusedBuffers,
    /// The copies of the canonical loop, which takes the place of the loop over rows.
    folded: Option<Folded>,
}

/// A list of any kind.
pub enum AnyListed {
    /// One list per particle.
    Rows(Box<Listed<NeighborList>>),
    /// One list per cluster of four particles.
    Clusters(Box<Listed<ClusterList>>),
}

/// Evaluates `$body` with `$listed` bound to a list of any kind.
macro_rules! with_listed {
    ($any:expr, $listed:ident => $body:expr) => {
        match $any {
            AnyListed::Rows($listed) => $body,
            AnyListed::Clusters($listed) => $body,
        }
    };
}
pub(crate) use with_listed;

/// The loop that a list serves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loop {
    /// Forces that are a pure function of the positions.
    Canonical,
    /// One list per particle, in double precision.
    Rows,
    /// One list per cluster of four particles, in mixed precision.
    Cluster,
}

/// The coarsest unit of coordinates that forces bear, σ: a force changes by less than 1e-4 of itself over it.
const COARSEST_UNIT: f64 = 1e-6;
/// 2⁵³, the number of places of a folded coordinate in double precision along each side.
const DOUBLE_UNITS: f64 = 9_007_199_254_740_992.0;

impl Loop {
    /// The longest side of a box in which the coordinates of the loop resolve positions, σ.
    pub fn widest(self) -> f64 {
        match self {
            Self::Cluster => COARSEST_UNIT * FIXED_UNITS,
            Self::Rows | Self::Canonical => COARSEST_UNIT * DOUBLE_UNITS,
        }
    }
}

impl AnyListed {
    /// A list that serves a force by a loop, with a skin, σ, without the excluded pairs.
    pub fn new(
        pairwise: Arc<Pairwise>,
        skin: f64,
        level: Level,
        kind: Loop,
        exclusions: Exclusions,
    ) -> Self {
        let validity = ListValidity::new(pairwise, skin, level);
        let rows = |images| NeighborList::new(images, level.lanes()).excluding(exclusions);
        match kind {
            Loop::Canonical => {
                let folded = Some(Folded::default());
                Self::Rows(Box::new(Listed {
                    folded,
                    ..Listed::of(rows(Images::Folded), validity)
                }))
            }
            Loop::Rows => Self::Rows(Box::new(Listed::of(rows(Images::Ghosts), validity))),
            Loop::Cluster => {
                let list = ClusterList::default().excluding(exclusions);
                Self::Clusters(Box::new(Listed::of(list, validity)))
            }
        }
    }
}

impl<P: PackedList> Listed<P> {
    fn of(list: P, validity: ListValidity) -> Self {
        let (packed, fused) = (PackedCopies::default(), FusedBuffers::default());
        Self { list, validity, packed, fused, folded: None }
    }

    /// Number of bundles of columns in a box with `whole` particles, which ranks can own.
    pub fn bundles(&mut self, cell: &PeriodicBox, whole: usize) -> usize {
        let reach = self.validity.reach::<P>(cell);
        self.list.begin_part(cell, reach, whole).bundles()
    }

    /// Shares the list of `whole` particles with the other ranks of a team; returns whether it can.
    ///
    /// Canonical forces have a loop in the order of the particles, which is not shared.
    pub fn share(&mut self, team: &Team, whole: usize, limit: SpeedLimit) -> bool {
        if self.folded.is_none() {
            self.validity.forget();
            self.validity.part = Some(Part::new(team, whole, limit));
        }
        self.folded.is_none()
    }

    /// The list itself.
    pub fn list(&self) -> &P {
        &self.list
    }

    /// Number of builds so far.
    pub fn builds(&self) -> u64 {
        self.validity.builds
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> u64 {
        let copies = self.packed.bytes() + self.fused.bytes();
        let folded = self.folded.as_ref().map_or(0, Folded::bytes);
        (self.list.bytes() + copies + folded + self.validity.bytes()) as u64
    }

    /// Builds the list for positions in a box.
    pub fn build(&mut self, cell: &PeriodicBox, positions: &[DVec3]) -> Result<(), ForceError> {
        self.validity.build_by_number((&mut self.list, self.packed.rows()), cell, positions)?;
        if let Some(folded) = &mut self.folded {
            folded.take_list(&self.list);
        }
        Ok(())
    }

    /// Writes forces (and `each`) at a configuration, and returns the totals that `detail` asks for.
    pub fn evaluate(
        &mut self,
        at: Configuration<'_>,
        detail: Detail,
        forces: &mut [DVec3],
        mut each: Option<&mut [PerParticle]>,
        clock: &mut Clock,
    ) -> Result<Totals, ForceError> {
        let (status, totals) = clock.computing(|clock| {
            let mut request = Request::of(detail);
            let mut is_new = false;
            // On ranks, positions at own slots.
            let mut by_slot = Vec::new();
            loop {
                if !self.validity.may_be_valid::<P>(at.cell, at.positions.len()) {
                    assert!(!is_new, "a new list is complete");
                    clock.building(|| self.build(at.cell, at.positions))?;
                    (request, is_new) = (Request::of(detail), true);
                }
                let used = self.validity.in_use(&self.list, at.cell);
                let each = each.as_deref_mut();
                let (status, totals) = match (&mut self.folded, used.part) {
                    (Some(folded), _) => folded.evaluate(&used, at.positions, detail, forces, each),
                    (None, None) => {
                        used.evaluate(&mut self.packed, at.positions, request, forces, each)
                    }
                    (None, Some(part)) => {
                        if request.prepared == Prepared::Nothing {
                            by_slot.clear();
                            by_slot.extend_from_slice(&self.validity.built[..self.list.own()]);
                            if !is_new {
                                part.to_slots(&self.list, at.positions, &mut by_slot);
                            }
                        }
                        let given = (&by_slot[..], request);
                        used.evaluate_part(part, &mut self.packed, given, forces, each)
                    }
                };
                match &status {
                    ListStatus::Complete | ListStatus::NonFinite => return Ok((status, totals)),
                    ListStatus::Incomplete(pairs)
                        if !is_new && self.validity.insert(&mut self.list, pairs, false) =>
                    {
                        request.prepared = Prepared::Judged;
                    }
                    ListStatus::Expired | ListStatus::Incomplete(_) => self.validity.forget(),
                }
            }
        })?;
        let part = self.validity.part.as_ref();
        let first_of_all = |vectors: &[DVec3]| match part {
            None => non_finite::first(vectors).unwrap_or_default(),
            Some(part) => {
                let own = non_finite::first(vectors).map(|k| part.numbers().start + k);
                part.lowest(own).unwrap_or_default()
            }
        };
        if status == ListStatus::NonFinite {
            return Err(ForceError::NonFinitePosition { particle: first_of_all(at.positions) });
        }
        if totals.broken {
            return Err(ForceError::NonFiniteForce { particle: first_of_all(forces) });
        }
        Ok(totals)
    }

    /// Takes fused steps: see [`lennard_core::Backend::advance`].
    pub fn advance(
        &mut self,
        steps: &mut FusedSteps<'_>,
        kick_drift: KickDrift,
        clock: &mut Clock,
    ) -> u64 {
        // Canonical forces have one loop only, which does not fuse steps.
        if steps.steps < FEWEST_STEPS || self.folded.is_some() {
            return 0;
        }
        let Self { list, validity, packed, fused, .. } = self;
        let list = (list, packed);
        clock.computing(|clock| fused.advance(validity, list, steps, kick_drift, clock))
    }
}
