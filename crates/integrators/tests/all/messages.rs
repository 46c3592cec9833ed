//! What methods say when they refuse.

use std::sync::Arc;

use crate::measure::KeplerForces;
use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Part,
    Persist, State, StepError, System, Want,
};
use lennard_integrators::fire::FireError;
use lennard_integrators::oscillator::{HarmonicForces, OscillatorConstraint};
use lennard_integrators::{IntegratorOptions, integrators};

fn refusal(method: &str, constraints: usize) -> String {
    let entry = integrators().iter().find(|e| e.spec.name == method).unwrap();
    let mut system = System::atoms(1);
    system.constraints = (0..constraints).map(|_| oscillator_constraint()).collect();
    let mut state =
        State::new(lennard_core::PeriodicBox::boundless(), vec![DVec3::X], vec![DVec3::ZERO]);
    let mut forces = Unsplit;
    let started: Result<(), StepError> =
        entry.build().start(&system, &mut state, &mut forces, 0.1, Want::NOTHING);
    started.unwrap_err().to_string()
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
    let message =
        method.step(&system, &mut state, &mut forces, 0.1, Want::NOTHING).unwrap_err().to_string();
    assert!(
        message.ends_with("the constraint's gradient vanishes or its value is not finite"),
        "{message}"
    );
}

#[test]
fn methods_say_what_is_missing() {
    assert!(
        refusal("velocity-verlet", 1)
            .ends_with("it has constraints, and the method solves for none")
    );
    assert!(
        refusal("spook", 2).ends_with("it has 2 constraints, and the method solves for one so far")
    );
    assert!(refusal("respa", 0).ends_with("its forces do not come in a near and a far part"));
    assert_eq!(
        FireError::VelocityDependentForce.to_string(),
        "forces that depend on velocities cannot be relaxed"
    );
    let not = FireError::NotRelaxed { steps: 7, largest_force: 12.0, wanted: 0.1 };
    assert_eq!(
        not.to_string(),
        "relaxation stopped after 7 steps with a largest force of 1.200e1 (wanted 1.000e-1)"
    );
    let options: IntegratorOptions = toml::from_str("kind = \"respa\"\ninner_steps = 0").unwrap();
    assert_eq!(
        options.check().unwrap_err().to_string(),
        "`inner_steps` = 0 is not allowed: a whole number from 1 to 1000000"
    );
}

#[test]
fn integers_that_are_not_three_a_particle_are_refused() {
    let entry = integrators().iter().find(|e| e.spec.name == "bit-reversible-verlet").unwrap();
    let mut archive = lennard_core::StateArchive::default();
    let mut writer = archive.writer();
    writer.put_f64("started_dt", &[0.1]);
    writer.put_i64("current", &[1, 2, 3, 4]);
    writer.put_i64("previous", &[]);
    let error = entry.build().restore(&archive.reader()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the saved entry `current` does not fit: not three numbers per particle"
    );
}
