//! One step under way: the operators that every method is made of.

use std::ops::Range;

use crate::parallel::all_pieces;
use crate::{
    Backend, BondSolver, BoundDrift, Configuration, DVec3, Drifted, Energetics, Flight, ForceError,
    FrictionAndNoise, FusedBath, FusedSteps, IntegratorSpec, Momentum, Moving, Own, Part, State,
    StepError, StepReport, System, Thermostat, Want, rigid,
};

/// A step of a method: what its kicks, drifts and force evaluations act on.
///
/// Fractions are parts of the step h. A kick waits for the drift that may follow, so that both take one pass over memory.
pub struct Step<'a> {
    system: &'a System,
    state: &'a mut State,
    backend: &'a mut dyn Backend,
    spec: &'static IntegratorSpec,
    dt: f64,
    want: Want,
    /// Steps that may be taken besides this one without a look in between.
    pub(crate) ahead: u64,
    /// The bath after the steps.
    pub(crate) bath: Option<&'a mut Box<dyn Thermostat>>,
    /// Friction and noise in the middle of the step, and of the further steps.
    noise: Option<FrictionAndNoise>,
    /// The kick that was not given yet, as a fraction of the step.
    waiting_kick: Option<f64>,
    /// The part of the step by which positions have drifted.
    drifted: f64,
    started: f64,
    report: StepReport,
    /// What holds rigid bonds, where the system has some.
    pub(crate) bonds: Option<&'a mut (dyn BondSolver + 'static)>,
    /// Why a drift could not hold bonds, or solve for contacts.
    failed_drift: Option<StepError>,
}

/// What belongs to a step, for operators that are neither a kick nor a drift.
pub struct Parts<'a> {
    /// Masses, constraints and the exact solution.
    pub system: &'a System,
    /// Positions, velocities and forces.
    pub state: &'a mut State,
    /// The forces.
    pub backend: &'a mut dyn Backend,
}

impl<'a> Step<'a> {
    /// A step of `dt` τ that begins at a state, and whose forces deliver `want` at its end.
    #[must_use]
    pub fn new(
        system: &'a System,
        state: &'a mut State,
        backend: &'a mut dyn Backend,
        spec: &'static IntegratorSpec,
        dt: f64,
        want: Want,
    ) -> Self {
        Self {
            started: state.time,
            system,
            state,
            backend,
            spec,
            dt,
            want,
            ahead: 0,
            bath: None,
            noise: None,
            waiting_kick: None,
            drifted: 0.0,
            report: StepReport::default(),
            bonds: None,
            failed_drift: None,
        }
    }

    /// The step h in τ.
    #[must_use]
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// The system.
    #[must_use]
    pub fn system(&self) -> &'a System {
        self.system
    }

    /// Degrees of freedom n_dof of this motion: three less where the method conserves the total momentum.
    #[must_use]
    pub fn n_dof(&self) -> f64 {
        self.system.n_dof(self.spec.momentum())
    }

    /// Whether the method conserves the total momentum.
    #[must_use]
    pub fn momentum(&self) -> Momentum {
        self.spec.momentum()
    }

    /// The kick B: v ← v + fraction·h·F/m.
    pub fn kick(&mut self, fraction: f64) {
        self.give_waiting_kick();
        self.waiting_kick = Some(fraction);
    }

    /// The drift A: x ← x + fraction·h·v. Rigid bonds have their length afterwards.
    pub fn drift(&mut self, fraction: f64) {
        if self.backend.boundary().is_some() {
            return self.fly(fraction);
        }
        self.drifted += fraction;
        let h = fraction * self.dt;
        if self.bonds.is_some() {
            return self.drift_with_bonds(h);
        }
        let (moving, masses) = (Moving::of(self.state), &self.system.masses);
        match self.waiting_kick.take() {
            Some(kick) => moving.kick_and_drift(masses, kick * self.dt, h),
            None => moving.drift(h),
        }
    }

    /// The drift by `h` that holds bonds.
    fn drift_with_bonds(&mut self, h: f64) {
        let Some(bonds) = &mut self.bonds else {
            return;
        };
        let state = &mut *self.state;
        let moving = BoundDrift {
            positions: &mut state.positions,
            velocities: &mut state.velocities,
            forces: &state.forces,
            kick: self.waiting_kick.take().map(|kick| kick * self.dt),
            h,
        };
        let drifted = bonds.drift(self.system, moving);
        self.note(drifted);
    }

    /// Notes what happened in a drift; a failure ends the step where it can fail next.
    fn note(&mut self, drifted: Result<Drifted, StepError>) {
        match drifted {
            Ok(drifted) => {
                self.report.iterations += drifted.iterations;
                self.report.residual = self.report.residual.max(drifted.residual);
                self.report.heat += drifted.heat;
            }
            Err(e) => self.failed_drift = self.failed_drift.take().or(Some(e)),
        }
    }

    /// Takes the part along rigid bonds off the velocities, where an operator has put one there.
    pub fn project_velocities(&mut self) {
        self.give_waiting_kick();
        let state = &mut *self.state;
        rigid::project_velocities(self.system, &state.positions, &mut state.velocities);
    }

    /// The drift between walls: flight from hit to hit.
    fn fly(&mut self, fraction: f64) {
        self.give_waiting_kick();
        let state = &mut *self.state;
        if let Some(boundary) = self.backend.boundary() {
            let drifted = boundary.fly(Flight {
                cell: &state.cell,
                positions: &mut state.positions,
                velocities: &mut state.velocities,
                forces: &state.forces,
                masses: &self.system.masses,
                h: fraction * self.dt,
                step: state.step,
                is_later: self.drifted > 0.0,
            });
            self.note(drifted);
        }
        self.drifted += fraction;
    }

    /// Arrives at the end of the step and evaluates the forces there, with what is wanted besides.
    ///
    /// Where nothing looks at the steps that follow, a backend may take some of them first.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail.
    pub fn forces(&mut self) -> Result<(), StepError> {
        self.arrive();
        if self.ahead > 0 {
            self.fused_steps();
        }
        self.evaluate_here(self.want)
    }

    /// Evaluates the forces inside the step, at the time to which the positions have drifted.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail.
    pub fn inner_forces(&mut self) -> Result<(), StepError> {
        let time = self.started + self.drifted * self.dt;
        self.evaluate(time, Want::NOTHING)
    }

    /// Evaluates the forces before the first step, at the state as it is.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail.
    pub fn forces_at_start(&mut self) -> Result<(), StepError> {
        self.evaluate_here(self.want)
    }

    /// Evaluates one part of the forces at the current positions into an array of the caller. `share` is the part of the
    /// step that is over; at the end (1) the totals that are wanted come with it.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail.
    pub fn part_of_forces(
        &mut self,
        part: Part,
        share: f64,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, StepError> {
        self.give_waiting_kick();
        self.drifts_hold()?;
        self.report.force_evaluations += 1;
        let at = Configuration {
            cell: &self.state.cell,
            positions: &self.state.positions,
            velocities: None,
            time: self.started + share * self.dt,
        };
        let found = self.backend.evaluate(at, part, want, forces)?;
        check_finite(self.system.own(), forces)?;
        Ok(found)
    }

    /// Advances the clock to the end of the step: everything after it belongs to the new time.
    pub fn arrive(&mut self) {
        self.give_waiting_kick();
        tick(self.state, self.dt);
    }

    /// What the forces are wanted to deliver at the end of the step.
    #[must_use]
    pub fn want(&self) -> Want {
        self.want
    }

    /// System, state and forces, for other operators. A kick that waits is given first.
    pub fn parts(&mut self) -> Parts<'_> {
        self.give_waiting_kick();
        Parts { system: self.system, state: &mut *self.state, backend: &mut *self.backend }
    }

    /// Counts energy in ε that a bath puts in.
    pub fn add_heat(&mut self, heat: f64) {
        self.report.heat += heat;
    }

    /// Notes what an inner solver did: iterations, and the residual in its own norm.
    pub fn solved(&mut self, iterations: u32, residual: f64) {
        self.report.iterations += iterations;
        self.report.residual = residual;
    }

    /// Counts force evaluations that a solver made by itself.
    pub fn count_evaluations(&mut self, evaluations: u32) {
        self.report.force_evaluations += evaluations;
    }

    /// Ends the step and returns what happened in it.
    pub fn finish(mut self) -> StepReport {
        self.give_waiting_kick();
        self.report
    }

    fn give_waiting_kick(&mut self) {
        let Some(kick) = self.waiting_kick.take() else {
            return;
        };
        let (state, system, h) = (&mut *self.state, self.system, kick * self.dt);
        match &self.bonds {
            Some(bonds) if bonds.has_velocity_stage() && system.molecules.are_rigid() => {
                let State { positions, velocities, forces, .. } = state;
                rigid::kick_and_project(system, positions, velocities, forces, h);
            }
            _ => Moving::of(state).kick(&system.masses, h),
        }
    }

    /// Fails where bonds could not be held, or contacts not solved for, in a drift of this step.
    ///
    /// # Errors
    /// The error of the solver.
    pub(crate) fn drifts_hold(&mut self) -> Result<(), StepError> {
        self.failed_drift.take().map_or(Ok(()), Err)
    }

    fn evaluate_here(&mut self, want: Want) -> Result<(), StepError> {
        self.evaluate(self.state.time, want)
    }

    fn evaluate(&mut self, time: f64, want: Want) -> Result<(), StepError> {
        self.give_waiting_kick();
        self.drifts_hold()?;
        self.report.force_evaluations += 1;
        let state = &mut *self.state;
        let at = Configuration {
            cell: &state.cell,
            positions: &state.positions,
            // Only methods made for it may feed velocities to a force.
            velocities: self.spec.velocity_dependent_forces.then_some(state.velocities.as_slice()),
            time,
        };
        state.energetics = self.backend.evaluate(at, Part::All, want, &mut state.forces)?;
        check_finite(self.system.own(), &state.forces)?;
        Ok(())
    }
}

fn tick(state: &mut State, dt: f64) {
    state.step += 1;
    state.time += dt;
}

/// Refuses forces that are not finite, whatever the forces themselves reported.
///
/// One running sum is enough: what is not finite never becomes finite again.
///
/// # Errors
/// [`ForceError::NonFiniteForce`] for the first particle, on all ranks.
pub fn check_finite(own: &Own, forces: &[DVec3]) -> Result<(), ForceError> {
    let is_finite = |range: Range<usize>| forces[range].iter().sum::<DVec3>().is_finite();
    let first = match all_pieces(forces.len(), is_finite) {
        true => None,
        // Finite forces may have a sum that overflows: absurd, but each force is finite.
        false => forces.iter().position(|f| !f.is_finite()),
    };
    own.agree(match first {
        Some(i) => Err(ForceError::NonFiniteForce { particle: own.first() + i }),
        None => Ok(()),
    })
}

// Steps that are taken at once with the step under way, and the bath and the noise that belong to each of them.

impl Step<'_> {
    /// Friction and noise O of the whole step: counts the kinetic energy gained as heat. They stand between two half drifts,
    /// once in a step.
    pub fn friction_and_noise(&mut self, noise: &FrictionAndNoise) {
        // The heat is then what friction and noise put in, without the part that rigid bonds take off before them.
        self.project_velocities();
        self.noise = Some(*noise);
        let (state, system) = (&mut *self.state, self.system);
        let of_step = noise.in_step(state.step, self.dt);
        let mut heat = Moving::of(state).noise(&of_step, &system.masses, system.own());
        if system.molecules.are_rigid() {
            let before = system.kinetic_energy(&state.velocities);
            rigid::project_velocities(system, &state.positions, &mut state.velocities);
            heat += system.kinetic_energy(&state.velocities) - before;
        }
        self.add_heat(heat);
    }

    pub(super) fn fused_steps(&mut self) {
        let (n_dof, dt) = (self.n_dof(), self.dt);
        let state = &mut *self.state;
        let before = self.bath.as_ref().map(|bath| bath.copy());
        let is_noise = self.noise.is_some();
        let bath = match (self.noise, self.bath.as_deref_mut()) {
            (Some(noise), _) => Some(FusedBath::noise(noise, dt, state.step)),
            (None, bath) => {
                bath.map(|bath| FusedBath::scaling(bath.as_mut(), n_dof, dt, state.step))
            }
        };
        let mut steps = FusedSteps {
            cell: &state.cell,
            positions: &mut state.positions,
            velocities: &mut state.velocities,
            forces: &mut state.forces,
            masses: &self.system.masses,
            dt,
            steps: self.ahead,
            first: state.step,
            bath,
        };
        let taken = self.backend.advance(&mut steps);
        let bath = steps.bath;
        if taken > 0 {
            let mut heats = bath.map(FusedBath::into_heats).unwrap_or_default();
            if is_noise {
                // The noise of this step came first, and the last noise belongs to the step that ends next.
                heats.insert(0, self.report.heat);
                self.report.heat = heats.pop().unwrap_or_default();
            }
            self.report.earlier_heats = heats;
        } else if let (Some(bath), Some(before)) = (&mut self.bath, before) {
            **bath = before;
        }
        for _ in 0..taken {
            tick(state, self.dt);
        }
        self.report.force_evaluations += taken as u32;
        if taken < self.ahead {
            self.want = Want::NOTHING;
        }
        self.ahead = 0;
    }
}
