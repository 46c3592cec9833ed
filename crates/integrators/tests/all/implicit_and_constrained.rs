//! The methods that solve equations within a step: implicit Euler and SPOOK.

use crate::common::{Cluster, cluster};
use crate::measure::{CountingForces, KeplerForces};
use glam::DVec2;
use lennard_core::{
    Backend, DVec3, ForceTerm, Integrator, Masses, Part, Persist, State, StepError, System, Want,
};
use lennard_integrators::implicit_euler::{ImplicitEuler, Options};
use lennard_integrators::oscillator::{HarmonicForces, OscillatorConstraint};
use lennard_integrators::spook::damped_oscillator_map;
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
        let mut state = State::new(lennard_core::PeriodicBox::boundless(), positions, velocities);
        let mut integrator = implicit();
        integrator.start(&system, &mut state, &mut Cluster, dt, Want::NOTHING).unwrap();
        for step in 0..20 {
            let before = state.clone();
            let report = integrator
                .step(&system, &mut state, &mut Cluster, dt, Want::NOTHING)
                .unwrap_or_else(|e| panic!("dt {dt}, step {step}: {e}"));
            // The tolerance in σ, in components; the vector is longer by up to √3, positions of the
            // order 2·dt·20 round to 1e-14.
            let found = residual(&before, &state, &system, dt);
            assert!(found < 3e-12, "dt {dt}, step {step}: {found:e}");
            assert!(report.residual <= 2e-12);
        }
    }
}

#[test]
fn implicit_euler_loses_energy_at_every_step() {
    // Each step minimises ½(y − x̂)²/h² + U(y), and staying put would give it E: so E cannot rise.
    let (positions, velocities) = cluster(3, 1.0, 6);
    let system = System::atoms(27);
    let mut state = State::new(lennard_core::PeriodicBox::boundless(), positions, velocities);
    let mut integrator = implicit();
    let energy =
        |s: &State| system.kinetic_energy(&s.velocities) + s.energetics.potential_energy.unwrap();
    integrator.start(&system, &mut state, &mut Cluster, 0.02, Want::ENERGY).unwrap();
    let start = energy(&state);
    let mut last = start;
    for _ in 0..200 {
        integrator.step(&system, &mut state, &mut Cluster, 0.02, Want::ENERGY).unwrap();
        let now = energy(&state);
        assert!(now < last);
        last = now;
    }
    assert!(last < start - 1.0);
}

#[test]
fn implicit_euler_that_runs_out_of_iterations_says_so() {
    let mut integrator =
        Integrator::new(ImplicitEuler::new(&Options { max_iterations: 1, ..Options::default() }));
    let mut state =
        State::new(lennard_core::PeriodicBox::boundless(), vec![DVec3::X], vec![DVec3::Y]);
    let system = System::atoms(1);
    integrator.start(&system, &mut state, &mut KeplerForces, 0.5, Want::NOTHING).unwrap();
    let result = integrator.step(&system, &mut state, &mut KeplerForces, 0.5, Want::NOTHING);
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
    let mut forces = CountingForces::new(HarmonicForces::new(1e6));
    let mut state = State::new(
        lennard_core::PeriodicBox::boundless(),
        vec![DVec3::new(1.0, -2.0, 0.5)],
        vec![DVec3::Y],
    );
    let system = System::atoms(1);
    let mut integrator = implicit();
    integrator.start(&system, &mut state, &mut forces, 0.1, Want::NOTHING).unwrap();
    integrator.step(&system, &mut state, &mut forces, 0.1, Want::NOTHING).unwrap();
    // K is a multiple of the identity: one product finds the answer, a second may polish rounding.
    assert!(forces.products <= 2, "{}", forces.products);
}

const H: f64 = 0.0167;

#[test]
fn spook_reproduces_its_closed_form_for_one_damped_oscillator() {
    for stiffness in [1.0, 100.0, 4.0 / (H * H) + 1.0, 1e9, f64::INFINITY] {
        for damping_time in [0.0, 0.01, 1.0] {
            for mass in [1.0, 2.5] {
                let compliance = 1.0 / stiffness;
                let constraint = OscillatorConstraint::new(compliance, damping_time);
                let mut system = System::atoms(1);
                system.masses = Masses::Uniform(mass);
                system.constraints.push(Arc::new(constraint));
                let (x, v) = (0.7, -1.3);
                let mut state = State::new(
                    lennard_core::PeriodicBox::boundless(),
                    vec![DVec3::X * x],
                    vec![DVec3::X * v],
                );
                let mut spook = build(&IntegratorOptions::Spook(Default::default()));
                let mut free = HarmonicForces::new(0.0);
                spook.start(&system, &mut state, &mut free, H, Want::NOTHING).unwrap();
                spook.step(&system, &mut state, &mut free, H, Want::NOTHING).unwrap();

                // B2, term by term.
                let gamma = 1.0 / (1.0 + 4.0 * damping_time / H);
                let stiff = 4.0 * gamma * compliance * mass / (H * H);
                let v_next = (-4.0 / H * gamma * x + gamma * v + stiff * v) / (1.0 + stiff);
                let lambda = mass * v_next - mass * v;
                // A few roundings of terms of the order 4x/h = 170.
                let scale = 4.0 / H;
                assert!((state.velocities[0].x - v_next).abs() < 1e-15 * scale);
                assert!((state.positions[0].x - (x + H * v_next)).abs() < 1e-15 * scale);
                let mut archive = lennard_core::StateArchive::default();
                spook.save(&mut archive.writer());
                let [multiplier] = archive.reader().f64s("multiplier").unwrap();
                assert!((multiplier - lambda).abs() < 1e-15 * mass * scale);
                let map = damped_oscillator_map(compliance, damping_time, mass, H);
                let end = map * DVec2::new(x, v);
                assert!((end.y - v_next).abs() < 1e-15 * scale);
            }
        }
    }
}

#[test]
fn systems_that_do_not_suit_are_refused_by_name() {
    let constraint = || Arc::new(OscillatorConstraint::spring(1.0, 0.0));
    let mut system = System::atoms(1);
    system.constraints.push(constraint());
    let mut state =
        State::new(lennard_core::PeriodicBox::boundless(), vec![DVec3::X], vec![DVec3::ZERO]);
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
    let mut damped = HarmonicForces::new(1.0).with_damping(0.0);
    assert!(damped.properties().splits);
    let mut unsplit = Unsplit(&mut damped);
    let mut state =
        State::new(lennard_core::PeriodicBox::boundless(), vec![DVec3::X], vec![DVec3::ZERO]);
    let refused = build(&IntegratorOptions::Respa(Default::default())).start(
        &fluid,
        &mut state,
        &mut unsplit,
        0.1,
        Want::NOTHING,
    );
    assert!(unsuited(refused));
}

/// Forces that hide that they split.
struct Unsplit<'a>(&'a mut HarmonicForces);

lennard_core::remembers_nothing!(Unsplit<'_>);

impl ForceTerm for Unsplit<'_> {
    fn evaluate(
        &mut self,
        at: lennard_core::Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<lennard_core::Energetics, lennard_core::ForceError> {
        self.0.evaluate(at, part, want, forces)
    }
    fn properties(&self) -> lennard_core::ForceProperties {
        lennard_core::ForceProperties::default()
    }
}

impl Backend for Unsplit<'_> {}
