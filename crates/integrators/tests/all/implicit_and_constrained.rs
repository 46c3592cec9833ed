//! The methods that solve equations within a step: implicit Euler and SPOOK.

use crate::common::{Cluster, Rig, cluster, free, one};
use crate::measure::{KeplerForces, Watched};
use lennard_core::{
    DVec3, ForceProperties, ForceTerm, Integrator, Masses, Part, State, StepError, System, Want,
};
use lennard_integrators::implicit_euler::{ImplicitEuler, Options};
use lennard_integrators::oscillator::{HarmonicForces, OscillatorConstraint};
use lennard_integrators::{IntegratorOptions, OscillatorModel, build};
use std::sync::Arc;

fn implicit() -> Integrator {
    Integrator::new(ImplicitEuler::new(&Options::default()))
}

/// max |x′ − x − h·v′| and max |v′ − v − h·a(x′)·…|: the equations of the method, from outside.
fn residual(before: &State, after: &State, system: &System, dt: f64) -> f64 {
    let mut forces = vec![DVec3::ZERO; after.len()];
    let at = lennard_core::Configuration::at_rest(&after.cell, &after.positions);
    Cluster.evaluate(at, Part::All, Want::NOTHING, &mut forces).unwrap();
    (0..after.len())
        .map(|i| {
            let a = forces[i] / system.masses.of(i);
            let velocity = after.velocities[i] - before.velocities[i] - dt * a;
            let position = after.positions[i] - before.positions[i] - dt * after.velocities[i];
            (dt * velocity).length().max(position.length())
        })
        .fold(0.0, f64::max)
}

#[test]
fn implicit_euler_solves_its_equations_at_any_step() {
    // At h = 0.5 the step is 30 times velocity Verlet's limit, the Hessian is indefinite, and the
    // cluster's particles would fly through each other.
    for dt in [0.001, 0.01, 0.05, 0.2, 0.5, 2.0] {
        let (positions, velocities) = cluster(4, 2.0, 5);
        let mut system = System::atoms(64);
        system.masses = Masses::Each((0..64).map(|i| 1.0 + f64::from(i % 2)).collect());
        let start = (system, free(positions, velocities));
        let mut rig = Rig::of(implicit(), start, Cluster, dt);
        for step in 0..20 {
            let before = rig.state.clone();
            let report = rig.tried().unwrap_or_else(|e| panic!("dt {dt}, step {step}: {e}"));
            // The tolerance in σ, in components; the vector is longer by up to √3, positions of the
            // order 2·dt·20 round to 1e-14.
            let found = residual(&before, &rig.state, &rig.system, dt);
            assert!(found < 3e-12, "dt {dt}, step {step}: {found:e}");
            assert!(report.residual <= 2e-12);
        }
    }
}

#[test]
fn implicit_euler_that_runs_out_of_iterations_says_so() {
    let options = Options { max_iterations: 1, ..Options::default() };
    let start = (System::atoms(1), one(DVec3::X, DVec3::Y));
    let method = Integrator::new(ImplicitEuler::new(&options));
    let result = Rig::of(method, start, KeplerForces, 0.5).tried();
    assert!(
        matches!(
            result,
            Err(StepError::NotConverged {
                method: "implicit-euler",
                iterations: 1,
                residual,
                wanted
            }) if residual > wanted
        ),
        "{result:?}"
    );
}

#[test]
fn implicit_euler_solves_a_linear_force_in_one_direction() {
    let start = (System::atoms(1), one(DVec3::new(1.0, -2.0, 0.5), DVec3::Y));
    let rig = Rig::of(implicit(), start, Watched::new(HarmonicForces::new(1e6)), 0.1).steps(1);
    let products = rig.forces.first().products;
    // K is a multiple of the identity: one product finds the answer, a second may polish rounding.
    assert!(products <= 2, "{products}");
}

#[test]
fn systems_that_do_not_suit_are_refused_by_name() {
    let constraint = || Arc::new(OscillatorConstraint::spring(1.0, 0.0));
    let mut system = System::atoms(1);
    system.constraints.push(constraint());
    let mut state = one(DVec3::X, DVec3::ZERO);
    let mut start = |o: IntegratorOptions, system: &System| {
        let mut forces = HarmonicForces::new(1.0);
        build(&o).start(system, &mut state, &mut forces, 0.1, Want::NOTHING)
    };
    let unsuited = |r: Result<(), StepError>| matches!(r, Err(StepError::Unsuited { .. }));
    // A constraint that the method would ignore.
    for entry in lennard_integrators::integrators() {
        if entry.oscillator == OscillatorModel::Force {
            assert!(unsuited(start(entry.default_options.clone(), &system)), "{}", entry.spec.name);
        }
    }
    let spook = || IntegratorOptions::Spook(Default::default());
    assert_eq!(start(spook(), &system), Ok(()));
    system.constraints.push(constraint());
    assert!(unsuited(start(spook(), &system)));
    // No exact solution, and forces that do not split.
    let fluid = System::atoms(1);
    assert!(unsuited(start(IntegratorOptions::Analytic(Default::default()), &fluid)));
    let mut unsplit = Watched::new(HarmonicForces::new(1.0).with_damping(0.0));
    assert!(unsplit.properties.splits);
    unsplit.properties = ForceProperties::default();
    let mut state = one(DVec3::X, DVec3::ZERO);
    let refused = build(&IntegratorOptions::Respa(Default::default())).start(
        &fluid,
        &mut state,
        &mut unsplit,
        0.1,
        Want::NOTHING,
    );
    assert!(unsuited(refused));
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
    let mut system = System::atoms(1);
    system.constraints = vec![Arc::new(Nowhere)];
    let start = (system, one(DVec3::X, DVec3::ZERO));
    let method = build(&IntegratorOptions::Spook(Default::default()));
    let stepped = Rig::of(method, start, HarmonicForces::new(1.0), 0.1).tried();
    assert!(matches!(stepped, Err(StepError::Unsuited { method: "spook", .. })));
}
