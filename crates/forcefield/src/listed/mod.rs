//! A Verlet list at work: positions are packed into rows, the list is judged before each use, and pairs are summed.

mod evaluated;
mod folded;
mod persist;

use std::sync::Arc;

use glam::DVec3;
use lennard_core::{
    Configuration, Exclusions, ForceError, FusedSteps, HaloSize, PeriodicBox, Team, TooManyRanks,
};
use lennard_neighbor::{ClusterList, FIXED_UNITS, Images, NeighborList, PairList, Positions};

use self::evaluated::Evaluated;
use self::folded::Folded;
use crate::clock::Clock;
use crate::fused::FusedBuffers;
use crate::interaction::Pairwise;
use crate::non_finite;
use crate::share::Share;
use crate::simd::{
    Detail, DoubleRow, FixedRow, KickDrift, Level, ListStatus, PackedCopies, PerParticle, Prepared,
    Request,
};
use crate::sums::Totals;
use crate::validity::ListValidity;

/// A list with the private copies of the positions that its loop reads.
enum Pairs {
    /// One list per particle, for forces that are a pure function of the positions.
    Canonical(Box<NeighborList>, Folded),
    /// One list per particle.
    Rows(Box<NeighborList>, Copies<DoubleRow>),
    /// One list per cluster of four particles.
    Clusters(Box<ClusterList>, Copies<FixedRow>),
}

/// Copies of the particles for single evaluations and for fused steps.
#[derive(Default)]
struct Copies<Row> {
    packed: PackedCopies<Row>,
    fused: FusedBuffers,
}

impl<Row: Copy + Default + Send + Sync> Copies<Row> {
    fn bytes(&self) -> usize {
        self.packed.bytes() + self.fused.bytes()
    }
}

/// The smallest number of fused steps that is worth gathering the particles by slot.
const FEWEST_STEPS: u64 = 3;

/// A list with everything that belongs to it.
pub struct Listed {
    validity: ListValidity,
    pairs: Pairs,
}

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

/// Evaluates `$body` with `$list` bound to the list of any kind.
macro_rules! with_any_list {
    ($pairs:expr, $list:ident => $body:expr) => {
        match $pairs {
            Pairs::Canonical($list, _) | Pairs::Rows($list, _) => $body,
            Pairs::Clusters($list, _) => $body,
        }
    };
}
use with_any_list;

impl Listed {
    /// A list for `r_cut` and `skin` in σ, without the excluded pairs.
    ///
    /// `of_particle` has the species of each particle, where there are several.
    pub fn new(
        (r_cut, skin): (f64, f64),
        level: Level,
        kind: Loop,
        exclusions: Exclusions,
        of_particle: Option<Arc<[u8]>>,
    ) -> Self {
        let list =
            |images| Box::new(NeighborList::new(images, level.lanes()).excluding(exclusions));
        let pairs = match kind {
            Loop::Canonical => Pairs::Canonical(list(Images::Folded), Folded::default()),
            Loop::Rows => Pairs::Rows(list(Images::Ghosts), Copies::default()),
            Loop::Cluster => Pairs::Clusters(
                Box::new(ClusterList::default().excluding(exclusions)),
                Copies::default(),
            ),
        };
        Self { validity: ListValidity::new(r_cut, skin, level, of_particle), pairs }
    }

    /// Shares the list of `n` particles with the other ranks of a team; returns whether it can.
    ///
    /// Canonical forces have a loop in the order of the particles, which is not shared.
    pub fn share(&mut self, team: &Team, n: usize) -> Result<bool, TooManyRanks> {
        let validity = &mut self.validity;
        match &mut self.pairs {
            Pairs::Canonical(..) => return Ok(false),
            Pairs::Rows(list, _) => validity.share(&mut **list, team, n)?,
            Pairs::Clusters(list, _) => validity.share(&mut **list, team, n)?,
        }
        Ok(true)
    }

    /// What a rank would need of others, if so many ranks shared the list as it is.
    pub fn halo_on(&self, n: usize, ranks: usize) -> Option<HaloSize> {
        match &self.pairs {
            Pairs::Canonical(..) => None,
            Pairs::Rows(list, _) => self.validity.halo_on(&**list, n, ranks),
            Pairs::Clusters(list, _) => self.validity.halo_on(&**list, n, ranks),
        }
    }

    /// Number of lanes computed in one evaluation, which contains every pair twice.
    pub fn lanes(&self) -> u64 {
        match &self.pairs {
            Pairs::Canonical(list, _) | Pairs::Rows(list, _) => list.lanes_computed(),
            Pairs::Clusters(list, _) => list.lanes_computed(),
        }
    }

    /// Number of listed pairs, each counted once.
    pub fn listed_pairs(&self) -> u64 {
        with_any_list!(&self.pairs, list => list.pairs())
    }

    /// Number of builds so far.
    pub fn builds(&self) -> u64 {
        self.validity.builds()
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> u64 {
        let pairs = match &self.pairs {
            Pairs::Canonical(list, folded) => list.bytes() + folded.bytes(),
            Pairs::Rows(list, copies) => list.bytes() + copies.bytes(),
            Pairs::Clusters(list, copies) => list.bytes() + copies.bytes(),
        };
        (pairs + self.validity.bytes()) as u64
    }

    /// Builds the list for positions in a box.
    pub fn build(&mut self, cell: &PeriodicBox, positions: &[DVec3]) -> Result<(), ForceError> {
        let positions = Positions::ById(positions);
        let validity = &mut self.validity;
        match &mut self.pairs {
            Pairs::Canonical(list, folded) => {
                validity.build((&mut **list, &mut Vec::new()), cell, positions)?;
                folded.take_list(list);
                Ok(())
            }
            Pairs::Rows(list, copies) => {
                validity.build((&mut **list, copies.packed.rows()), cell, positions)
            }
            Pairs::Clusters(list, copies) => {
                validity.build((&mut **list, copies.packed.rows()), cell, positions)
            }
        }
    }

    /// Inserts pairs that the list lacks; returns whether it can take them.
    fn insert(&mut self, pairs: &[[u32; 2]]) -> bool {
        let validity = &mut self.validity;
        with_any_list!(&mut self.pairs, list => validity.insert(&mut **list, pairs))
    }

    fn may_be_valid(&self, cell: &PeriodicBox, n: usize) -> bool {
        match &self.pairs {
            Pairs::Canonical(..) | Pairs::Rows(..) => {
                self.validity.may_be_valid::<NeighborList>(cell, n)
            }
            Pairs::Clusters(..) => self.validity.may_be_valid::<ClusterList>(cell, n),
        }
    }

    /// Writes forces (and `each`) at a configuration, and returns the totals that `detail` asks for.
    pub fn evaluate(
        &mut self,
        pairwise: &Pairwise,
        at: Configuration<'_>,
        detail: Detail,
        forces: &mut [DVec3],
        mut each: Option<&mut [PerParticle]>,
        clock: &mut Clock,
    ) -> Result<Totals, ForceError> {
        let outcome = clock.computing(|clock| {
            let mut request = Request::of(detail);
            while self.may_be_valid(at.cell, at.positions.len()) {
                let each = each.as_deref_mut();
                let outcome = self.attempt(pairwise, at, request, forces, each);
                match &outcome.status {
                    ListStatus::Complete | ListStatus::NonFinite => return Ok(outcome),
                    ListStatus::Incomplete(pairs) if self.insert(pairs) => {
                        request.prepared = Prepared::Judged;
                    }
                    ListStatus::Expired | ListStatus::Incomplete(_) => break,
                }
            }
            clock.building(|| self.build(at.cell, at.positions))?;
            Ok(self.attempt(pairwise, at, Request::of(detail), forces, each))
        })?;
        if outcome.status == ListStatus::NonFinite {
            return Err(non_finite::position(at.positions));
        }
        assert_eq!(outcome.status, ListStatus::Complete, "a new list is complete");
        if outcome.broken {
            return Err(non_finite::force(forces));
        }
        Ok(outcome.totals)
    }

    /// Judges the list where the request demands it, and evaluates where the list is complete.
    fn attempt(
        &mut self,
        pairwise: &Pairwise,
        at: Configuration<'_>,
        request: Request,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Evaluated {
        let (validity, positions) = (&self.validity, at.positions);
        match &mut self.pairs {
            Pairs::Canonical(list, folded) => validity.with_list(&**list, at.cell, |used| {
                folded.evaluate(used, pairwise, positions, request.detail, forces, each)
            }),
            Pairs::Rows(list, copies) => validity.with_list(&**list, at.cell, |used| {
                let packed = &mut copies.packed;
                let found = used.evaluate(packed, pairwise, positions, request, forces, each);
                Evaluated::of(found, request.detail, used.share.map(Share::team))
            }),
            Pairs::Clusters(list, copies) => validity.with_list(&**list, at.cell, |used| {
                let packed = &mut copies.packed;
                let found = used.evaluate(packed, pairwise, positions, request, forces, each);
                Evaluated::of(found, request.detail, used.share.map(Share::team))
            }),
        }
    }

    /// Takes fused steps: see [`lennard_core::Backend::advance`].
    pub fn advance(
        &mut self,
        pairwise: &Pairwise,
        steps: &mut FusedSteps<'_>,
        kick_drift: KickDrift,
        clock: &mut Clock,
    ) -> u64 {
        if steps.steps < FEWEST_STEPS {
            return 0;
        }
        let validity = &mut self.validity;
        let taken = clock.computing(|clock| match &mut self.pairs {
            // Canonical forces have one loop only, which does not fuse steps.
            Pairs::Canonical(..) => 0,
            Pairs::Rows(list, Copies { packed, fused }) => {
                fused.advance(validity, (&mut **list, packed), pairwise, steps, kick_drift, clock)
            }
            Pairs::Clusters(list, Copies { packed, fused }) => {
                fused.advance(validity, (&mut **list, packed), pairwise, steps, kick_drift, clock)
            }
        });
        // Checkpoints read them, and single evaluations.
        self.validity.know_all_built();
        taken
    }
}
