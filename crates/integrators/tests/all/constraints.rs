//! Constraints, forces and saved numbers that a method refuses.

use std::sync::Arc;

use crate::measure::KeplerForces;
use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Part,
    State, StepError, System, Want,
};
use lennard_integrators::integrators;
use lennard_integrators::oscillator::{HarmonicForces, OscillatorConstraint};

fn refusal(method: &str, constraints: usize) -> StepError {
    let entry = integrators().iter().find(|e| e.spec.name == method).unwrap();
    let mut system = System::atoms(1);
    system.constraints = (0..constraints).map(|_| oscillator_constraint()).collect();
    let mut state =
        State::new(lennard_core::PeriodicBox::boundless(), vec![DVec3::X], vec![DVec3::ZERO]);
    let mut forces = Unsplit;
    entry.build().start(&system, &mut state, &mut forces, 0.1, Want::NOTHING).unwrap_err()
}

/// Forces that come in one piece.
struct Unsplit;

lennard_core::remembers_nothing!(Unsplit);

impl ForceTerm for Unsplit {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        KeplerForces.evaluate(at, part, want, forces)
    }
    fn properties(&self) -> ForceProperties {
        ForceProperties { splits: false, ..KeplerForces.properties() }
    }
}

impl Backend for Unsplit {}

fn oscillator_constraint() -> Arc<dyn lennard_core::Constraint> {
    Arc::new(OscillatorConstraint::new(1.0, 0.0))
}

/// A constraint whose gradient vanishes and whose value is no number.
#[derive(Debug)]
struct Nowhere;

impl lennard_core::Constraint for Nowhere {
    fn value(&self, _positions: &[DVec3]) -> f64 {
        f64::NAN
    }
    fn gradient(&self, _positions: &[DVec3], _out: &mut Vec<(usize, DVec3)>) {}
    fn compliance(&self) -> f64 {
        0.0
    }
    fn damping_time(&self) -> f64 {
        0.0
    }
}

#[test]
fn a_constraint_that_cannot_be_solved_for_is_refused_at_the_step() {
    let entry = integrators().iter().find(|e| e.spec.name == "spook").unwrap();
    let mut system = System::atoms(1);
    system.constraints = vec![Arc::new(Nowhere)];
    let mut state =
        State::new(lennard_core::PeriodicBox::boundless(), vec![DVec3::X], vec![DVec3::ZERO]);
    let mut forces = HarmonicForces::new(1.0);
    let mut method = entry.build();
    method.start(&system, &mut state, &mut forces, 0.1, Want::NOTHING).unwrap();
    let stepped = method.step(&system, &mut state, &mut forces, 0.1, Want::NOTHING);
    assert!(matches!(stepped, Err(StepError::Unsuited { method: "spook", .. })));
}

#[test]
fn methods_refuse_constraints_and_forces_that_they_do_not_solve_for() {
    for (method, constraints) in [("velocity-verlet", 1), ("spook", 2), ("respa", 0)] {
        assert!(matches!(refusal(method, constraints), StepError::Unsuited { .. }), "{method}");
    }
}
