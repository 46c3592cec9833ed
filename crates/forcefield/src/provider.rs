//! Pair forces: the force term, and the backend that takes fused steps. All choices are made when it is built.

mod persist;

use std::sync::Arc;

use glam::{DMat3, DVec3};
use lennard_core::{
    Backend, Configuration, Energetics, Exclusions, ForceError, ForceProperties, ForceStatistics,
    ForceTerm, FusedSteps, HaloSize, Masses, Part, PeriodicBox, Team, TooManyRanks, Want,
};

use crate::any_interaction::{AnyInteraction, with_whole};
use crate::canonical::{CanonicalJob, NeighborSource, wrap};
use crate::clock::Clock;
use crate::error::ForceFieldError;
use crate::interaction::{ManySpecies, OneSpecies, SplitWeights};
use crate::listed::{Listed, Loop};
use crate::non_finite;
use crate::options::{ForceFieldOptions, SplitOptions};
use crate::pair::{Laws, Model, with_form};
use crate::plan::{Conditions, ForcePlan, Search, TIE_MARGIN, decide};
use crate::simd::{Detail, KickDrift, PerParticle};
use crate::sums::Totals;

/// The search for pairs, with the arrays that it needs.
enum Strategy {
    Nothing,
    Reference,
    Direct { wrapped: Vec<DVec3> },
    Verlet(Box<Listed>),
}

/// Near and far parts.
struct Split {
    options: SplitOptions,
    /// A short list for the near part. Without it, the near part uses the pairs of the whole force.
    near: Option<Box<Listed>>,
}

/// Forces between pairs of particles.
pub struct PairForces {
    /// The largest share of half the shortest side of the box that the cutoff may have.
    largest_share: f64,
    /// The longest side of the box that the loop takes, σ.
    widest: f64,
    n_atoms: usize,
    model: Model,
    /// The potentials of each pair of species, where pairs differ.
    laws: Option<Arc<Laws>>,
    exclusions: Exclusions,
    strategy: Strategy,
    split: Option<Split>,
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
    let listed = |r_cut| {
        let level = decision.level;
        let laws = decision.laws.as_ref();
        Box::new(Listed::new(
            (r_cut, plan.skin),
            level,
            decision.listed,
            o.exclusions,
            laws.map(|laws| laws.mixture.of_particle().clone()),
        ))
    };
    let strategy = match plan.search {
        Search::Nothing => Strategy::Nothing,
        Search::Reference => Strategy::Reference,
        Search::Direct => Strategy::Direct { wrapped: Vec::new() },
        Search::Verlet => Strategy::Verlet(listed(decision.model.r_cut)),
    };
    let split = o.split.map(|options| Split {
        options,
        near: matches!(strategy, Strategy::Verlet(_)).then(|| listed(options.r_split)),
    });
    let is_listed = matches!(strategy, Strategy::Verlet(_));
    let needs_one_image = is_listed && decision.listed != Loop::Canonical;
    Ok(PairForces {
        widest: match strategy {
            Strategy::Verlet(_) => decision.listed.widest(),
            Strategy::Direct { .. } => Loop::Canonical.widest(),
            Strategy::Reference | Strategy::Nothing => f64::INFINITY,
        },
        largest_share: if needs_one_image { 1.0 - TIE_MARGIN } else { 1.0 },
        n_atoms: c.n_atoms,
        model: decision.model,
        laws: decision.laws,
        exclusions: o.exclusions,
        strategy,
        split,
        plan,
        evaluations: 0,
        clock: Clock::default(),
    })
}

/// Runs `$body` with `$interaction` bound to the interaction of a form and the laws of a mixture.
macro_rules! with_interaction {
    ($form:expr, $laws:expr, $interaction:ident => $body:expr) => {
        with_form!($form, form => match $laws {
            // Unit tests look at parts, and tests/all at loops: without the loops, unit tests compile two minutes faster.
            _ if cfg!(test) => unreachable!("a unit test evaluates no forces"),
            None => {
                let $interaction = OneSpecies(form);
                $body
            }
            Some(laws) => {
                let $interaction = ManySpecies { form, laws };
                $body
            }
        })
    };
}

impl PairForces {
    /// The decisions of the build, and the reasons.
    #[must_use]
    pub fn plan(&self) -> &ForcePlan {
        &self.plan
    }

    /// Builds the list at a configuration, whether it expired or not; returns whether there is a list.
    pub(crate) fn rebuild(&mut self, at: Configuration<'_>) -> Result<bool, ForceError> {
        match &mut self.strategy {
            Strategy::Verlet(listed) => listed.build(at.cell, at.positions).map(|()| true),
            Strategy::Nothing | Strategy::Reference | Strategy::Direct { .. } => Ok(false),
        }
    }

    /// Number of lanes computed in one evaluation.
    pub(crate) fn lanes(&self) -> u64 {
        match &self.strategy {
            Strategy::Verlet(listed) => listed.lanes(),
            Strategy::Direct { .. } => 2 * all_pairs(self.n_atoms),
            Strategy::Reference => all_pairs(self.n_atoms),
            Strategy::Nothing => 0,
        }
    }

    /// Checks that each pair has one image inside the cutoff at most in a box, and that the loop resolves positions in it.
    fn check_box(&self, cell: &PeriodicBox) -> Result<(), ForceError> {
        let (r_cut, largest) = (self.model.r_cut, cell.largest_cutoff());
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

    /// Evaluates a part of the force, or the whole.
    fn run(
        &mut self,
        interaction: &dyn AnyInteraction,
        near: bool,
        at: Configuration<'_>,
        detail: Detail,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Result<Totals, ForceError> {
        let clock = &mut self.clock;
        if let Some(Split { near: Some(list), .. }) = &mut self.split
            && near
        {
            return list.evaluate(interaction, at, detail, forces, each, clock);
        }
        // The near part is zero beyond r_split, so that the cutoff of the whole force serves it too.
        let (model, exclusions) = (self.model, &self.exclusions);
        if let Strategy::Verlet(listed) = &mut self.strategy {
            return listed.evaluate(interaction, at, detail, forces, each, clock);
        }
        if !at.positions.iter().all(|r| r.is_finite()) {
            return Err(non_finite::position(at.positions));
        }
        let totals = clock.computing(|_| match &mut self.strategy {
            Strategy::Direct { wrapped } => {
                wrap(at.cell, at.positions, wrapped);
                let job = CanonicalJob {
                    r_cut: model.r_cut,
                    cell: at.cell,
                    wrapped,
                    neighbors: NeighborSource::AllBut(exclusions),
                };
                interaction.canonical(&job, detail, forces, each)
            }
            _ => interaction.reference(&model, exclusions, at, forces, each),
        });
        if !forces.iter().all(|f| f.is_finite()) {
            return Err(non_finite::force(forces));
        }
        Ok(totals)
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
        let split = match (part, &self.split) {
            (Part::All, _) => None,
            (_, Some(split)) => Some(SplitWeights::new(&split.options, part == Part::Near)),
            (_, None) => return Err(ForceError::NotSplit),
        };
        self.evaluations += 1;
        let mut each = want.per_particle.then(|| vec![(0.0, DMat3::ZERO); self.n_atoms]);
        let detail = if want.per_particle || want.virial_tensor {
            Detail::Everything
        } else if want.is_nothing() {
            Detail::Forces
        } else {
            Detail::Totals
        };
        let near = part == Part::Near;
        let slots = each.as_deref_mut();
        // A copy of the pointer, which leaves the lists free to change.
        let laws = self.laws.clone();
        let mut totals = with_interaction!(self.model.form, &laws, interaction => match split {
            None => with_whole(interaction, |whole| {
                self.run(whole, false, at, detail, forces, slots)
            }),
            Some(weights) => {
                self.run(&weights.of(interaction), near, at, detail, forces, slots)
            }
        })?;
        // The far part has the whole jump at the cutoff, since the near part is zero there.
        let jump = if near {
            totals.at_cutoff = 0.0;
            0.0
        } else {
            self.model.energy_at_cutoff
        };
        Ok(totals.deliver(want, jump, each))
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties {
            velocity_dependent: false,
            linear: false,
            splits: self.split.is_some() || matches!(self.strategy, Strategy::Nothing),
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
        let near = self.split.as_ref().and_then(|s| s.near.as_ref());
        for listed in whole.into_iter().chain(near) {
            statistics.builds += listed.builds();
            statistics.bytes += listed.bytes();
        }
        match &self.strategy {
            Strategy::Verlet(listed) => statistics.listed_pairs = listed.listed_pairs(),
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
        let taken = with_interaction!(self.model.form, &self.laws, interaction => {
            with_whole(interaction, |whole| listed.advance(whole, steps, kick_drift, clock))
        });
        self.evaluations += taken;
        taken
    }

    fn share(&mut self, team: &Team) -> Result<bool, TooManyRanks> {
        let Strategy::Verlet(listed) = &mut self.strategy else {
            return Ok(false);
        };
        if let Some(near) = self.split.as_mut().and_then(|s| s.near.as_mut()) {
            near.share(team, self.n_atoms)?;
        }
        listed.share(team, self.n_atoms)
    }

    fn halo_on(&self, ranks: usize) -> Option<HaloSize> {
        match &self.strategy {
            Strategy::Verlet(listed) => listed.halo_on(self.n_atoms, ranks),
            _ => None,
        }
    }
}
