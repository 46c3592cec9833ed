//! The force provider: one dynamic call per evaluation, everything behind it chosen beforehand.

use std::time::Instant;

use glam::{DMat3, DVec3};
use lennard_core::{
    Backend, Configuration, Energetics, ForceError, ForceProperties, ForceStatistics, ForceTerm,
    FusedSteps, Masses, Part, PeriodicBox, Persist, RestoreError, StateReader, StateWriter, Want,
};

use crate::clock::Clock;
use crate::error::ForceFieldError;
use crate::form::{Model, SplitWeights, with_form};
use crate::listed::{Listed, not_finite, not_finite_force};
use crate::options::{ForceFieldOptions, SplitOptions};
use crate::plan::{Conditions, ForcePlan, Search, decide};
use crate::pure::{self, Nearby, PureJob};
use crate::reference;
use crate::simd::{Pace, PerParticle, Wanted};
use crate::sums::Totals;
use crate::truncation::PairForm;

/// How pairs are found, with what that needs.
enum Strategy {
    Reference,
    Direct { wrapped: Vec<DVec3> },
    Verlet(Box<Listed>),
}

/// Near and far parts.
struct Split {
    options: SplitOptions,
    /// A short list for the near part; without one it runs over what the whole force runs over.
    near: Option<Box<Listed>>,
}

/// Forces between pairs of particles.
pub struct PairForces {
    cell: PeriodicBox,
    n_atoms: usize,
    model: Model,
    strategy: Strategy,
    split: Option<Split>,
    plan: ForcePlan,
    evaluations: u64,
    clock: Clock,
}

/// Builds the forces that the options describe, for these conditions.
///
/// # Errors
/// [`ForceFieldError`] where an option is out of range, does not fit the box, or does not go with another.
pub fn build(o: &ForceFieldOptions, c: &Conditions) -> Result<PairForces, ForceFieldError> {
    let decision = decide(o, c)?;
    let plan = decision.plan;
    let listed = |r_cut| {
        let level = decision.level;
        Box::new(Listed::new(
            c.cell,
            r_cut,
            plan.skin,
            level,
            decision.listed,
        ))
    };
    let strategy = match plan.search {
        Search::Reference => Strategy::Reference,
        Search::Direct => Strategy::Direct {
            wrapped: Vec::new(),
        },
        Search::Verlet => Strategy::Verlet(listed(decision.model.r_cut)),
    };
    let split = o.split.map(|options| Split {
        options,
        near: matches!(strategy, Strategy::Verlet(_)).then(|| listed(options.r_split)),
    });
    Ok(PairForces {
        cell: c.cell,
        n_atoms: c.n_atoms,
        model: decision.model,
        strategy,
        split,
        plan,
        evaluations: 0,
        clock: Clock::default(),
    })
}

impl PairForces {
    /// What was decided at the build, and why.
    #[must_use]
    pub fn plan(&self) -> &ForcePlan {
        &self.plan
    }

    /// Builds the list at these positions whether it is due or not; gives whether there is one.
    pub(crate) fn rebuild(&mut self, positions: &[DVec3]) -> Result<bool, ForceError> {
        match &mut self.strategy {
            Strategy::Verlet(listed) => listed.build(positions).map(|()| true),
            Strategy::Reference | Strategy::Direct { .. } => Ok(false),
        }
    }

    /// Lanes computed in one evaluation.
    pub(crate) fn lanes(&self) -> u64 {
        match &self.strategy {
            Strategy::Verlet(listed) => listed.lanes(),
            Strategy::Direct { .. } => 2 * all_pairs(self.n_atoms),
            Strategy::Reference => all_pairs(self.n_atoms),
        }
    }

    fn run<F: PairForm>(
        &mut self,
        form: F,
        near: bool,
        positions: &[DVec3],
        wanted: Wanted,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Result<Totals, ForceError> {
        let short = match &mut self.split {
            Some(Split {
                near: Some(list), ..
            }) if near => Some(list),
            _ => None,
        };
        if let Some(listed) = short {
            return listed.evaluate(form, positions, wanted, forces, each, &mut self.clock);
        }
        // The near part ends before r_cut and is zero from there on.
        let model = self.model;
        match &mut self.strategy {
            Strategy::Verlet(listed) => {
                listed.evaluate(form, positions, wanted, forces, each, &mut self.clock)
            }
            Strategy::Direct { wrapped } => {
                let start = Instant::now();
                if !positions.iter().all(|r| r.is_finite()) {
                    return Err(not_finite(positions));
                }
                pure::wrap(&self.cell, positions, wrapped);
                let job = PureJob {
                    form,
                    r_cut: model.r_cut,
                    cell: &self.cell,
                    wrapped,
                    nearby: Nearby::All,
                };
                let chunks = job.run(forces, each);
                self.clock.force += start.elapsed().as_secs_f64();
                if chunks.iter().any(|c| c.broken) {
                    return Err(not_finite_force(forces));
                }
                Ok(Totals::of_chunks(&chunks))
            }
            Strategy::Reference => {
                let start = Instant::now();
                if !positions.iter().all(|r| r.is_finite()) {
                    return Err(not_finite(positions));
                }
                let totals =
                    reference::evaluate(&form, &model, &self.cell, positions, forces, each);
                self.clock.force += start.elapsed().as_secs_f64();
                if !forces.iter().all(|f| f.is_finite()) {
                    return Err(not_finite_force(forces));
                }
                Ok(totals)
            }
        }
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
            "the provider was built for another number of particles"
        );
        let split = match (part, &self.split) {
            (Part::All, _) => None,
            (_, Some(split)) => Some(SplitWeights::new(&split.options, part == Part::Near)),
            (_, None) => return Err(ForceError::NotSplit),
        };
        self.evaluations += 1;
        let mut each = want
            .per_particle
            .then(|| vec![(0.0, DMat3::ZERO); self.n_atoms]);
        let wanted = if want.per_particle {
            Wanted::Each
        } else if want.is_nothing() {
            Wanted::Forces
        } else {
            Wanted::Totals
        };
        let near = part == Part::Near;
        let (positions, slot) = (at.positions, each.as_deref_mut());
        let totals = with_form!(self.model.form, form => match split {
            None => self.run(form, near, positions, wanted, forces, slot),
            Some(weights) => self.run(weights.of(form), near, positions, wanted, forces, slot),
        })?;
        // The far part carries the whole jump at the cutoff: the near part is zero there.
        let jump = if near {
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
            splits: self.split.is_some(),
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
            statistics.builds += listed.criterion().builds();
            statistics.bytes += listed.bytes();
        }
        match &self.strategy {
            Strategy::Verlet(listed) => statistics.listed_pairs = listed.listed_pairs(),
            Strategy::Direct { wrapped } => {
                statistics.bytes = 24 * wrapped.capacity() as u64;
                statistics.listed_pairs = all_pairs(self.n_atoms);
            }
            Strategy::Reference => statistics.listed_pairs = all_pairs(self.n_atoms),
        }
        statistics
    }
}

fn all_pairs(n: usize) -> u64 {
    let n = n as u64;
    n * (n - 1) / 2
}

impl Backend for PairForces {
    fn advance(&mut self, mut stride: FusedSteps<'_>) -> u64 {
        let Masses::Uniform(mass) = stride.masses else {
            return 0;
        };
        let pace = Pace {
            half_kick: 0.5 * stride.dt / mass,
            dt: stride.dt,
        };
        let Strategy::Verlet(listed) = &mut self.strategy else {
            return 0;
        };
        let clock = &mut self.clock;
        let taken =
            with_form!(self.model.form, form => listed.stride(form, &mut stride, pace, clock));
        self.evaluations += taken;
        taken
    }
}

impl Persist for PairForces {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_u64("evaluations", &[self.evaluations]);
        to.put_f64("seconds", &[self.clock.force, self.clock.neighbor]);
        if let Strategy::Verlet(listed) = &self.strategy {
            listed.save(&mut to.section("list"));
        }
        if let Some(near) = self.split.as_ref().and_then(|s| s.near.as_ref()) {
            near.save(&mut to.section("near_list"));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        if let Strategy::Verlet(listed) = &mut self.strategy {
            listed.restore(&from.section("list"), self.n_atoms)?;
        }
        if let Some(near) = self.split.as_mut().and_then(|s| s.near.as_mut()) {
            near.restore(&from.section("near_list"), self.n_atoms)?;
        }
        [self.evaluations] = from.u64s("evaluations")?;
        [self.clock.force, self.clock.neighbor] = from.f64s("seconds")?;
        Ok(())
    }
}
