//! Pair forces: the force term, and the backend that takes fused steps. All choices are made when it is built.

mod persist;

use std::sync::Arc;

use glam::{DMat3, DVec3};
use lennard_core::{
    Backend, Configuration, Energetics, Exclusions, ForceError, ForceProperties, ForceStatistics,
    ForceTerm, FusedSteps, Masses, Part, PeriodicBox, SpeedLimit, Team, TooManyRanks, Want,
};
use lennard_neighbor::PairList;

use crate::canonical::{CanonicalJob, NeighborSource, wrap};
use crate::clock::Clock;
use crate::error::ForceFieldError;
use crate::interaction::Pairwise;
use crate::listed::{AnyListed, Loop, with_listed};
use crate::non_finite;
use crate::options::ForceFieldOptions;
use crate::part::{LEAST_OF_A_RANK, most_ranks};
use crate::plan::{Conditions, ForcePlan, Search, TIE_MARGIN, decide};
use crate::reference;
use crate::simd::KickDrift;
use crate::sums::{Detail, PerParticle, Totals};

/// The search for pairs, with the arrays that it needs.
enum Strategy {
    Nothing,
    Reference,
    Direct { wrapped: Vec<DVec3> },
    Verlet(AnyListed),
}

/// The near part.
struct Near {
    pairwise: Arc<Pairwise>,
    /// A short list. Without it, the near part uses the pairs of the whole force.
    list: Option<AnyListed>,
}

/// Forces between pairs of particles.
pub struct PairForces {
    /// The largest share of half the shortest side of the box that the cutoff may have.
    largest_share: f64,
    /// The longest side of the box that the loop takes, σ.
    widest: f64,
    n_atoms: usize,
    whole: Arc<Pairwise>,
    exclusions: Exclusions,
    strategy: Strategy,
    near: Option<Near>,
    /// Room for the forces of the near part while the far part is made.
    near_forces: Vec<DVec3>,
    plan: ForcePlan,
    evaluations: u64,
    clock: Clock,
}

/// Builds the forces that the options describe, for these conditions.
///
/// # Errors
/// [`ForceFieldError`] where an option is out of range, does not fit the box, or excludes another option.
pub fn build(o: &ForceFieldOptions, c: &Conditions<'_>) -> Result<PairForces, ForceFieldError> {
    let decision = decide(o, c)?;
    let plan = decision.plan;
    let whole = Arc::new(decision.whole);
    let listed = |pairwise: &Arc<Pairwise>| {
        let pairwise = Arc::clone(pairwise);
        AnyListed::new(pairwise, plan.skin, decision.level, decision.listed, o.exclusions)
    };
    let strategy = match plan.search {
        Search::Nothing => Strategy::Nothing,
        Search::Reference => Strategy::Reference,
        Search::Direct => Strategy::Direct { wrapped: Vec::new() },
        Search::Verlet => Strategy::Verlet(listed(&whole)),
    };
    let is_listed = matches!(strategy, Strategy::Verlet(_));
    let near = decision.near.map(Arc::new);
    let near = near.map(|pairwise| Near { list: is_listed.then(|| listed(&pairwise)), pairwise });
    let needs_one_image = is_listed && decision.listed != Loop::Canonical;
    Ok(PairForces {
        widest: match strategy {
            Strategy::Verlet(_) => decision.listed.widest(),
            Strategy::Direct { .. } => Loop::Canonical.widest(),
            Strategy::Reference | Strategy::Nothing => f64::INFINITY,
        },
        largest_share: if needs_one_image { 1.0 - TIE_MARGIN } else { 1.0 },
        n_atoms: c.n_atoms,
        whole,
        exclusions: o.exclusions,
        strategy,
        near,
        near_forces: Vec::new(),
        plan,
        evaluations: 0,
        clock: Clock::default(),
    })
}

impl PairForces {
    /// The decisions of the build, and the reasons.
    #[must_use]
    pub fn plan(&self) -> &ForcePlan {
        &self.plan
    }

    /// The largest number of ranks that can share the forces in a box. The forces then wait for their part, and serve nothing else.
    pub fn most_ranks(&mut self, cell: &PeriodicBox) -> usize {
        match &mut self.strategy {
            Strategy::Verlet(listed) => {
                let bundles = with_listed!(listed, l => l.bundles(cell, self.n_atoms));
                most_ranks(self.n_atoms).min(bundles)
            }
            _ => 1,
        }
    }

    /// Builds the list at a configuration, whether it expired or not; returns whether there is a list.
    pub(crate) fn rebuild(&mut self, at: Configuration<'_>) -> Result<bool, ForceError> {
        match &mut self.strategy {
            Strategy::Verlet(listed) => {
                with_listed!(listed, l => l.build(at.cell, at.positions))?;
                Ok(true)
            }
            Strategy::Nothing | Strategy::Reference | Strategy::Direct { .. } => Ok(false),
        }
    }

    /// Number of lanes computed in one evaluation.
    pub(crate) fn lanes(&self) -> u64 {
        match &self.strategy {
            Strategy::Verlet(listed) => with_listed!(listed, l => l.list().lanes_computed()),
            Strategy::Direct { .. } => 2 * all_pairs(self.n_atoms),
            Strategy::Reference => all_pairs(self.n_atoms),
            Strategy::Nothing => 0,
        }
    }

    /// Checks that each pair has one image inside the cutoff at most in a box, and that the loop resolves positions in it.
    fn check_box(&self, cell: &PeriodicBox) -> Result<(), ForceError> {
        let (r_cut, largest) = (self.whole.model().r_cut, cell.largest_cutoff());
        if r_cut > largest * self.largest_share {
            return Err(ForceError::CutoffOverHalfBox { r_cut, largest });
        }
        let (widest, largest) = (cell.lengths().max_element(), self.widest);
        if widest > largest {
            return Err(ForceError::BoxTooWide { widest, largest });
        }
        Ok(())
    }

    /// No force on any particle.
    fn nothing(
        &mut self,
        at: Configuration<'_>,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        self.evaluations += 1;
        if !at.positions.iter().all(|r| r.is_finite()) {
            return Err(non_finite::position(at.positions));
        }
        forces.fill(DVec3::ZERO);
        let each = want.per_particle.then(|| vec![(0.0, DMat3::ZERO); self.n_atoms]);
        Ok(Totals::NOTHING.deliver(want, 0.0, each))
    }

    /// Writes the forces of the whole or of the near part (and `each`), and returns the totals that `detail` asks for.
    fn run(
        &mut self,
        of_near: bool,
        at: Configuration<'_>,
        detail: Detail,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Result<Totals, ForceError> {
        let clock = &mut self.clock;
        let (pairwise, own_list) = match &mut self.near {
            Some(near) if of_near => (&near.pairwise, near.list.as_mut()),
            _ => (&self.whole, None),
        };
        if let Some(list) = own_list {
            return with_listed!(list, l => l.evaluate(at, detail, forces, each, clock));
        }
        let exclusions = &self.exclusions;
        if let Strategy::Verlet(listed) = &mut self.strategy {
            return with_listed!(listed, l => l.evaluate(at, detail, forces, each, clock));
        }
        if !at.positions.iter().all(|r| r.is_finite()) {
            return Err(non_finite::position(at.positions));
        }
        let totals = clock.computing(|_| match &mut self.strategy {
            Strategy::Direct { wrapped } => {
                wrap(at.cell, at.positions, wrapped);
                let job = CanonicalJob {
                    pairwise,
                    cell: at.cell,
                    wrapped,
                    neighbors: NeighborSource::AllBut(exclusions),
                };
                job.run(detail, forces, each)
            }
            _ => reference::evaluate(pairwise, exclusions, at, forces, each),
        });
        if !forces.iter().all(|f| f.is_finite()) {
            return Err(non_finite::force(forces));
        }
        Ok(totals)
    }

    /// The far part: what the near part leaves of the whole. It has all pairs, and the whole jump at the cutoff.
    fn far(
        &mut self,
        at: Configuration<'_>,
        detail: Detail,
        forces: &mut [DVec3],
        mut each: Option<&mut [PerParticle]>,
    ) -> Result<Totals, ForceError> {
        let whole = self.run(false, at, detail, forces, each.as_deref_mut())?;
        let mut near = std::mem::take(&mut self.near_forces);
        near.resize(forces.len(), DVec3::ZERO);
        let mut near_each = each.as_ref().map(|each| vec![(0.0, DMat3::ZERO); each.len()]);
        let of_near = self.run(true, at, detail, &mut near, near_each.as_deref_mut())?;
        for (force, near) in forces.iter_mut().zip(&near) {
            *force -= *near;
        }
        for (each, near) in each.into_iter().flatten().zip(near_each.iter().flatten()) {
            each.0 -= near.0;
            each.1 -= near.1;
        }
        self.near_forces = near;
        Ok(whole.without(&of_near))
    }
}

impl ForceTerm for PairForces {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        assert_eq!(
            (at.positions.len(), forces.len()),
            (self.n_atoms, self.n_atoms),
            "the forces were built for another number of particles"
        );
        if matches!(self.strategy, Strategy::Nothing) {
            return self.nothing(at, want, forces);
        }
        self.check_box(at.cell)?;
        if part != Part::All && self.near.is_none() {
            return Err(ForceError::NotSplit);
        }
        self.evaluations += 1;
        let mut each = want.per_particle.then(|| vec![(0.0, DMat3::ZERO); self.n_atoms]);
        let detail = if want.per_particle || want.virial_tensor {
            Detail::Everything
        } else if want.is_nothing() {
            Detail::Forces
        } else {
            Detail::Totals
        };
        let slots = each.as_deref_mut();
        let mut jump = self.whole.model().energy_at_cutoff;
        let totals = match part {
            Part::All => self.run(false, at, detail, forces, slots)?,
            Part::Far => self.far(at, detail, forces, slots)?,
            Part::Near => {
                // The near part is zero at the cutoff.
                jump = 0.0;
                let totals = self.run(true, at, detail, forces, slots)?;
                Totals { at_cutoff: 0.0, ..totals }
            }
        };
        Ok(totals.deliver(want, jump, each))
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties {
            velocity_dependent: false,
            linear: false,
            splits: self.near.is_some() || matches!(self.strategy, Strategy::Nothing),
            ..ForceProperties::default()
        }
    }

    fn statistics(&self) -> ForceStatistics {
        let mut statistics = ForceStatistics {
            evaluations: self.evaluations,
            skin: self.plan.skin,
            force_seconds: self.clock.force,
            neighbor_seconds: self.clock.neighbor,
            ..ForceStatistics::default()
        };
        let whole = match &self.strategy {
            Strategy::Verlet(listed) => Some(listed),
            _ => None,
        };
        let near = self.near.as_ref().and_then(|near| near.list.as_ref());
        for listed in whole.into_iter().chain(near) {
            let (builds, bytes) = with_listed!(listed, l => (l.builds(), l.bytes()));
            statistics.builds += builds;
            statistics.bytes += bytes;
        }
        match &self.strategy {
            Strategy::Verlet(listed) => {
                statistics.listed_pairs = with_listed!(listed, l => l.list().pairs());
            }
            Strategy::Direct { wrapped } => {
                statistics.bytes = 24 * wrapped.capacity() as u64;
                statistics.listed_pairs = all_pairs(self.n_atoms);
            }
            Strategy::Reference => statistics.listed_pairs = all_pairs(self.n_atoms),
            Strategy::Nothing => {}
        }
        statistics
    }
}

fn all_pairs(n: usize) -> u64 {
    let n = n as u64;
    n * (n - 1) / 2
}

impl Backend for PairForces {
    fn advance(&mut self, steps: &mut FusedSteps<'_>) -> u64 {
        let Masses::Uniform(mass) = steps.masses else {
            return 0;
        };
        let kick_drift = KickDrift { half_kick: 0.5 * steps.dt / mass, dt: steps.dt };
        if self.check_box(steps.cell).is_err() {
            return 0;
        }
        let Strategy::Verlet(listed) = &mut self.strategy else {
            return 0;
        };
        let clock = &mut self.clock;
        let taken = with_listed!(listed, l => l.advance(steps, kick_drift, clock));
        self.evaluations += taken;
        taken
    }

    fn share(
        &mut self,
        team: &Team,
        cell: &PeriodicBox,
        limit: SpeedLimit,
    ) -> Result<bool, TooManyRanks> {
        let (ranks, particles) = (team.ranks(), self.n_atoms);
        let most = self.most_ranks(cell);
        let Strategy::Verlet(listed) = &mut self.strategy else {
            return Ok(false);
        };
        if self.near.is_some() || ranks > most {
            return Err(TooManyRanks { ranks, particles, least: LEAST_OF_A_RANK, most });
        }
        let shares = with_listed!(listed, l => l.share(team, self.n_atoms, limit));
        if shares {
            self.n_atoms = team.numbers(self.n_atoms).len();
        }
        Ok(shares)
    }
}
