//! What every method of the list refuses, and the names and options by which it goes.

use std::sync::Arc;

use crate::common::{Rig, one};
use crate::measure::{Kepler, KeplerForces, Spoil, Watched, general_methods};
use lennard_core::{DVec3, ForceError, ForceProperties, ForceSum, Integrator, StepError, System};
use lennard_integrators::oscillator::{ExactOscillator, HarmonicForces};
use lennard_integrators::{IntegratorOptions, OscillatorModel, integrators};

/// Forces turn bad after fifty evaluations: by an error.
fn fails(evaluation: u64, _: &mut [DVec3]) -> Result<(), ForceError> {
    if evaluation > 50 { Err(ForceError::NonFiniteForce { particle: 0 }) } else { Ok(()) }
}

/// The same without a word.
fn spoils(evaluation: u64, forces: &mut [DVec3]) -> Result<(), ForceError> {
    if evaluation > 50 {
        forces[0].y = f64::NAN;
    }
    Ok(())
}

#[test]
fn forces_that_are_not_finite_stop_the_run() {
    for entry in general_methods() {
        for (silently, spoil) in [(false, fails as Spoil), (true, spoils)] {
            let forces = Watched { spoil, ..Watched::new(KeplerForces) };
            let mut rig =
                Rig::of(entry.build(), (System::atoms(1), one(DVec3::X, DVec3::Y)), forces, 0.01);
            let result = (0..100).try_for_each(|_| rig.tried().map(drop));
            let name = entry.spec.name;
            assert!(
                matches!(result, Err(StepError::Force(ForceError::NonFiniteForce { particle: 0 }))),
                "{name}, silently {silently}: {result:?}"
            );
        }
    }
}

#[test]
fn forces_that_depend_on_velocities_are_refused_where_the_method_assumes_none() {
    for entry in general_methods() {
        let forces = ForceSum::new(HarmonicForces::new(1.0).with_damping(0.1));
        let start = (System::atoms(1), one(DVec3::X, DVec3::Y));
        let started = Rig::unstarted(entry.build(), start, forces, 0.1).tried_start();
        let name = entry.spec.name;
        if entry.spec.velocity_dependent_forces {
            assert_eq!(started, Ok(()), "{name}");
        } else {
            assert_eq!(started, Err(StepError::VelocityDependentForce { method: name }));
        }
    }
}

#[test]
fn impossible_steps_are_refused() {
    for entry in integrators() {
        for dt in [0.0, -0.01, f64::NAN, f64::INFINITY] {
            let name = entry.spec.name;
            let mut system = System::atoms(1);
            system.exact = Some(Arc::new(ExactOscillator::new(1.0, 0.0, 1.0)));
            let start = (system, one(DVec3::X, DVec3::ZERO));
            let mut rig = Rig::of(entry.build(), start, HarmonicForces::new(1.0), 0.1);
            let before = rig.state.clone();
            rig.dt = dt;
            assert!(matches!(rig.tried(), Err(StepError::BadStep(_))), "{name}");
            assert_eq!(rig.state, before, "{name}: a refused step changed the state");
            assert!(matches!(rig.tried_start(), Err(StepError::BadStep(_))), "{name}");
        }
    }
}

#[test]
fn a_changing_step_is_refused_by_exactly_the_methods_that_say_so() {
    for entry in general_methods() {
        let mut rig = Kepler::for_orders().by(entry, 0.01);
        rig.dt = 0.02;
        let result = rig.tried();
        if entry.spec.fixed_step_only {
            assert_eq!(
                result,
                Err(StepError::ChangingStep {
                    method: entry.spec.name,
                    started: 0.01,
                    asked: 0.02
                })
            );
        } else {
            assert!(result.is_ok(), "{}", entry.spec.name);
        }
    }
}

#[test]
fn names_summaries_and_sources_are_there_and_options_go_by_the_names() {
    let mut names: Vec<_> = integrators().iter().map(|e| e.spec.name).collect();
    for entry in integrators() {
        let spec = entry.spec;
        for text in [spec.summary, spec.equations, spec.source] {
            assert!(text.len() > 20, "{}: {text}", spec.name);
        }
        let text = format!("kind = \"{}\"", spec.name);
        let options: IntegratorOptions = toml::from_str(&text).unwrap();
        assert_eq!(options, entry.default_options.clone());
        assert_eq!(options.name(), spec.name);
        assert_eq!(options.check(), Ok(()));
        // What is written out is read back as the same.
        let written = toml::to_string(&options).unwrap();
        assert_eq!(toml::from_str::<IntegratorOptions>(&written).unwrap(), options);
        let unknown = format!("{text}\nsurprise = 1");
        assert!(toml::from_str::<IntegratorOptions>(&unknown).is_err());
    }
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), integrators().len());
}

#[test]
fn impossible_options_are_named() {
    for (text, key) in [
        ("kind = \"respa\"\ninner_steps = 0", "inner_steps"),
        ("kind = \"implicit-euler\"\ntolerance = 0.0", "tolerance"),
        ("kind = \"implicit-euler\"\nmax_iterations = 0", "max_iterations"),
    ] {
        let options: IntegratorOptions = toml::from_str(text).unwrap();
        assert_eq!(options.check().unwrap_err().key, key);
    }
}

/// Starts every method with forces that act in flights, as far as it can know before its first drift. A method that `takes` them starts, and every other says why not.
fn only_some_start(own: ForceProperties, takes: impl Fn(&Integrator) -> bool, why: &str) -> usize {
    let mut started = 0;
    for entry in general_methods() {
        let mut forces = Watched::new(HarmonicForces::new(1.0));
        forces.properties = forces.properties.with_term(own);
        let mut system = System::atoms(1);
        if entry.oscillator == OscillatorModel::Constraint {
            let spring = lennard_integrators::oscillator::OscillatorConstraint::new(1.0, 0.0);
            system.constraints = vec![Arc::new(spring)];
        }
        let start = (system, one(DVec3::X, DVec3::ZERO));
        let mut rig = Rig::unstarted(entry.build(), start, ForceSum::new(forces), 0.1);
        let found = rig.tried_start();
        if takes(&rig.method) {
            assert!(found.is_ok(), "{}", entry.spec.name);
            started += 1;
            continue;
        }
        let words = found.unwrap_err().to_string();
        assert!(words.contains(why), "{words}");
    }
    started
}

#[test]
fn methods_whose_particles_would_pass_hard_walls_refuse_them() {
    let hits = ForceProperties { bounds_flight: true, ..ForceProperties::default() };
    let why = "particles would pass its hard walls, which act in drifts";
    assert!(only_some_start(hits, Integrator::takes_hard_walls, why) > 1);
}

#[test]
fn spook_alone_takes_unilateral_contacts_and_takes_no_hard_walls() {
    let solved = ForceProperties { needs_solved_contacts: true, ..ForceProperties::default() };
    let why = "its unilateral contacts are solved for in the step of SPOOK alone";
    assert_eq!(only_some_start(solved, Integrator::solves_contacts, why), 1);
    let spook = lennard_integrators::build(&IntegratorOptions::Spook(Default::default()));
    assert!(spook.solves_contacts() && !spook.takes_hard_walls());
}
