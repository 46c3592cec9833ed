//! An integrator at work: its method, the bath and the barostat that act after its steps, and the checks before them.

use crate::thermostat::act;
use crate::{
    Backend, BathStep, BondSolver, ForceProperties, IntegratorSpec, Momentum, Moving, Parts,
    Persist, Ramp, State, Step, StepError, StepReport, System, Thermostat, Want, persist,
};

/// Advances a state in time by the steps of a method, with or without a heat bath and a barostat after its steps.
///
/// After `start` and after each `step`, positions, velocities, forces and energetics in the state all belong to its time.
pub struct Integrator {
    method: Box<dyn Method>,
    bath: Option<Box<dyn Thermostat>>,
    bonds: Option<Box<dyn BondSolver>>,
    barostat: Option<Box<dyn Barostat>>,
    started_dt: f64,
}

impl Integrator {
    /// The integrator of a method, without a bath.
    #[must_use]
    pub fn new(method: impl Method + 'static) -> Self {
        Self { method: Box::new(method), bath: None, bonds: None, barostat: None, started_dt: 0.0 }
    }

    /// The same method with a bath after its steps.
    #[must_use]
    pub fn with_bath(self, bath: impl Thermostat + 'static) -> Self {
        Self { bath: Some(Box::new(bath)), ..self }
    }

    /// The same method, whose drifts hold rigid bonds by this solver.
    #[must_use]
    pub fn with_bonds(self, bonds: Box<dyn BondSolver>) -> Self {
        Self { bonds: Some(bonds), ..self }
    }

    /// The same method and bath with a barostat after its steps.
    #[must_use]
    pub fn with_barostat(self, barostat: impl Barostat + 'static) -> Self {
        Self { barostat: Some(Box::new(barostat)), ..self }
    }

    /// What became of the changes of the box that a barostat proposed; `None` without one that proposes.
    #[must_use]
    pub fn box_moves(&self) -> Option<BoxMoves> {
        self.barostat.as_ref().map(|barostat| barostat.moves())
    }

    /// What the method declares about itself.
    #[must_use]
    pub fn spec(&self) -> &'static IntegratorSpec {
        self.method.spec()
    }

    /// Whether the motion keeps the total momentum.
    #[must_use]
    pub fn momentum(&self) -> Momentum {
        self.spec().momentum()
    }

    /// Whether particles may hit hard walls under this method.
    #[must_use]
    pub fn takes_hard_walls(&self) -> bool {
        self.method.takes_hard_walls()
    }

    /// Whether unilateral contacts may be solved for in the flight of this method.
    #[must_use]
    pub fn solves_contacts(&self) -> bool {
        self.method.solves_contacts()
    }

    /// Evaluates the forces at the start and prepares any memory; called again where something outside has changed the
    /// state.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail or do not suit the method.
    pub fn start(
        &mut self,
        system: &System,
        state: &mut State,
        forces: &mut dyn Backend,
        dt: f64,
        want: Want,
    ) -> Result<(), StepError> {
        let spec = self.spec();
        check_suited(spec, forces, dt)?;
        let unsuited = |reason| StepError::Unsuited { method: spec.name, reason };
        if forces.properties().bounds_flight && !self.takes_hard_walls() {
            return Err(unsuited(
                "particles would pass its hard walls, which act in drifts".to_owned(),
            ));
        }
        if forces.properties().needs_solved_contacts && !self.solves_contacts() {
            return Err(unsuited(
                "its unilateral contacts are solved for in the step of SPOOK alone".to_owned(),
            ));
        }
        self.method.suits(system, forces.properties()).map_err(unsuited)?;
        if self.barostat.is_some() {
            let allowed = self.method.lets_box_change();
            allowed.map_err(|reason| unsuited(reason.to_owned()))?;
        }
        self.started_dt = dt;
        let want = want | self.method.wants();
        let mut step = Step::new(system, state, forces, spec, dt, want);
        self.method.start(&mut step)
    }

    /// Advances by one step of `dt` and asks the forces at the new time for `want`.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail, the step may not change, or a solver does not converge.
    pub fn step(
        &mut self,
        system: &System,
        state: &mut State,
        forces: &mut dyn Backend,
        dt: f64,
        want: Want,
    ) -> Result<StepReport, StepError> {
        let (_, report) = self.stride(system, state, forces, dt, 1, want)?;
        Ok(report)
    }

    /// Advances by up to `steps` steps of `dt` without a look in between, at least one, with the same bits as
    /// [`Integrator::step`] one by one. Returns how many were taken, and what happened in them. The forces at the new time
    /// are asked for `want` where all were taken.
    ///
    /// # Errors
    /// As [`Integrator::step`], at the step where that would fail.
    pub fn stride(
        &mut self,
        system: &System,
        state: &mut State,
        forces: &mut dyn Backend,
        dt: f64,
        steps: u64,
        want: Want,
    ) -> Result<(u64, StepReport), StepError> {
        let spec = self.spec();
        check_suited(spec, forces, dt)?;
        if spec.fixed_step_only && dt != self.started_dt {
            return Err(StepError::ChangingStep {
                method: spec.name,
                started: self.started_dt,
                asked: dt,
            });
        }
        let first = state.step;
        let at_once = if self.method.fuses_steps() && self.bonds.is_none() {
            self.steps_to_barostat(first, steps)
        } else {
            1
        };
        let mut want = if at_once == steps { want } else { Want::NOTHING };
        want |= self.method.wants();
        if let Some(barostat) = &self.barostat
            && barostat.acts_after(first + at_once)
        {
            want |= barostat.wants();
        }
        let mut step = Step::new(system, state, forces, spec, dt, want);
        step.ahead = at_once - 1;
        step.bath = self.bath.as_mut();
        step.bonds = self.bonds.as_deref_mut();
        self.method.step(&mut step)?;
        step.drifts_hold()?;
        if let Some(bath) = step.bath.take()
            && couple(bath.as_mut(), &mut step)
        {
            self.method.remember(&mut step)?;
        }
        press(self.method.as_mut(), self.barostat.as_deref_mut(), &mut step)?;
        let report = step.finish();
        Ok((state.step - first, report))
    }

    /// Takes `steps` steps of `dt`, as many at once as the method and the forces take; returns the heat that baths put in, ε.
    /// The forces after the last step are asked for `want`.
    ///
    /// # Errors
    /// As [`Integrator::step`], at the step where that would fail.
    pub fn advance(
        &mut self,
        system: &System,
        state: &mut State,
        forces: &mut dyn Backend,
        dt: f64,
        steps: u64,
        want: Want,
    ) -> Result<f64, StepError> {
        let (mut left, mut heat) = (steps, 0.0);
        while left > 0 {
            let (taken, report) = self.stride(system, state, forces, dt, left, want)?;
            report.add_heat_to(&mut heat);
            left -= taken;
        }
        Ok(heat)
    }

    /// Steps from `step` to the next after which the barostat acts, at most `most`.
    fn steps_to_barostat(&self, step: u64, most: u64) -> u64 {
        let Some(barostat) = &self.barostat else {
            return most;
        };
        (1..most).find(|ahead| barostat.acts_after(step + ahead)).unwrap_or(most)
    }
}

persist!(Integrator { ..method, bath, barostat, started_dt, fixed bonds });

/// Lets the barostat act, and the method remember the positions in the new box.
fn press(
    method: &mut dyn Method,
    barostat: Option<&mut (dyn Barostat + 'static)>,
    step: &mut Step<'_>,
) -> Result<(), StepError> {
    let Some(barostat) = barostat else {
        return Ok(());
    };
    let now = step.parts().state.step;
    if barostat.acts_after(now) && barostat.apply(step)? {
        method.remember(step)?;
    }
    Ok(())
}

/// Refuses a step that is no step, and forces of a kind that the method does not take.
fn check_suited(
    spec: &'static IntegratorSpec,
    forces: &dyn Backend,
    dt: f64,
) -> Result<(), StepError> {
    if !(dt.is_finite() && dt > 0.0) {
        return Err(StepError::BadStep(dt));
    }
    if forces.properties().velocity_dependent && !spec.velocity_dependent_forces {
        return Err(StepError::VelocityDependentForce { method: spec.name });
    }
    Ok(())
}

// What every integrator's file provides: its declaration and one step, written as kicks, drifts and force evaluations.

/// One method of integration: its step as a sequence of operators.
///
/// Contract: after `start` and after each `step`, positions, velocities, forces and energetics of the state all belong to
/// its time.
pub trait Method: Persist + Send {
    /// What the method declares about itself.
    fn spec(&self) -> &'static IntegratorSpec;

    /// Whether the method can run this system with such forces; else the reason.
    ///
    /// The default refuses constraints, which most methods do not solve for.
    ///
    /// # Errors
    /// The reason in words.
    fn suits(&self, system: &System, forces: ForceProperties) -> Result<(), String> {
        let _ = forces;
        without_constraints(system)
    }

    /// Whether particles move by forward [`Step::drift`] alone: hard walls act there and nowhere else.
    ///
    /// The default is that they do not.
    fn takes_hard_walls(&self) -> bool {
        false
    }

    /// Whether the flight of a step comes right after its whole kick, where unilateral contacts are solved for.
    ///
    /// The default is that it does not.
    fn solves_contacts(&self) -> bool {
        false
    }

    /// Whether steps that nothing looks at may be taken at once.
    ///
    /// Each is a kick, a drift and a kick, with friction and noise in the middle of the drift or without
    /// ([`Step::friction_and_noise`]). The default is what the declaration says.
    fn fuses_steps(&self) -> bool {
        self.spec().is_kick_drift_kick
    }

    /// Evaluates the forces at the start and remembers what the steps need.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail.
    fn start(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        s.forces_at_start()?;
        self.remember(s)
    }

    /// Takes positions or velocities of other times from the present state, whose forces are known. This happens at the
    /// start, and after a bath has changed the velocities. The default remembers nothing.
    ///
    /// # Errors
    /// [`StepError`] where the state does not suit the method.
    fn remember(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let _ = s;
        Ok(())
    }

    /// What the method itself wants of the forces at the end of each step. The default wants forces alone.
    fn wants(&self) -> Want {
        Want::NOTHING
    }

    /// Whether the box may change between steps; else the reason. The default lets it change.
    ///
    /// # Errors
    /// The reason in words, for a method that keeps forces or positions of other times.
    fn lets_box_change(&self) -> Result<(), &'static str> {
        Ok(())
    }

    /// One step.
    ///
    /// # Errors
    /// [`StepError`] where the forces fail or a solver does not converge.
    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError>;
}

/// Refuses a system with constraints or rigid bonds.
///
/// # Errors
/// The reason in words.
pub fn without_constraints(system: &System) -> Result<(), String> {
    rigid_bonds_alone(system)?;
    if system.molecules.are_rigid() {
        return Err("it has rigid bonds, and the method has no form that holds them".to_owned());
    }
    Ok(())
}

/// Refuses a system with constraints other than rigid bonds: what a method says whose kicks and drifts hold them.
///
/// # Errors
/// The reason in words.
pub fn rigid_bonds_alone(system: &System) -> Result<(), String> {
    if system.constraints.is_empty() {
        Ok(())
    } else {
        Err("it has constraints, and the method solves for none".to_owned())
    }
}

// A bath at work after a step.

/// Scales the velocities by the factor of a bath, where it acts after this step, and counts the heat. Returns whether it did.
pub fn couple(bath: &mut dyn Thermostat, s: &mut Step<'_>) -> bool {
    let (n_dof, dt) = (s.n_dof(), s.dt());
    let Parts { system, state, .. } = s.parts();
    if !bath.acts_after(state.step) {
        return false;
    }
    let at =
        BathStep { kinetic: system.kinetic_energy(&state.velocities), n_dof, dt, step: state.step };
    let Some((factor, heat)) = act(bath, at) else {
        return false;
    };
    Moving::of(state).scale(factor);
    s.add_heat(heat);
    true
}

// Barostats: operators between steps that change the box.

/// What a barostat declares about itself.
#[derive(Debug, Clone, Copy)]
pub struct BarostatSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The equation of motion of the box, in plain text.
    pub equation: &'static str,
    /// Name of the only thermostat that it goes with; `None` where each canonical one suits.
    pub thermostat: Option<&'static str>,
    /// Author, title, equation.
    pub source: &'static str,
}

/// What a barostat holds, and what it has to know of the fluid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureBath {
    /// Pressure P₀, ε/σ³.
    pub pressure: Ramp,
    /// Temperature T₀ of the bath beside it, ε/k_B.
    pub temperature: Ramp,
    /// c_P = V²·P_tail of the homogeneous tail beyond the cutoff, ε·σ³; 0 without tail.
    pub tail: f64,
    /// Estimate of the isothermal compressibility κ, σ³/ε: it sets the pace alone.
    pub compressibility: f64,
}

/// Proposed and accepted changes of the box.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BoxMoves {
    /// Changes proposed.
    pub tried: u64,
    /// Changes accepted.
    pub accepted: u64,
}

crate::persist!(BoxMoves { [tried, accepted] as "moves" });

impl BoxMoves {
    /// The accepted part of the proposed changes; not a number where none was proposed.
    #[must_use]
    pub fn acceptance(&self) -> f64 {
        self.accepted as f64 / self.tried as f64
    }
}

/// Couples the box to a pressure after a step.
pub trait Barostat: Persist + Send {
    /// Whether the barostat acts after this step. It then finds what it [`wants`](Barostat::wants) in the state.
    fn acts_after(&self, step: u64) -> bool;

    /// What the barostat wants of the forces at the end of a step after which it acts.
    fn wants(&self) -> Want {
        Want::ENERGY_AND_VIRIAL
    }

    /// Changes box and positions, with the forces of the new state, and counts the work ([`Step::add_heat`]).
    ///
    /// The work is the change of U_s + V·P_tail, so that E + V·P_tail − Σ heat is conserved. Returns whether the box changed.
    ///
    /// # Errors
    /// [`StepError`] where the forces of the new state fail.
    fn apply(&mut self, step: &mut Step<'_>) -> Result<bool, StepError>;

    /// The changes so far.
    fn moves(&self) -> BoxMoves;
}
