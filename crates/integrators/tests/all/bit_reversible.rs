//! The bit-reversible method returns exactly, to the last bit.

use crate::common::{Cluster, cluster};
use crate::measure::run;
use lennard_core::{
    DVec3, ForceError, Integrator, Persist, State, StateArchive, StepError, System, Want,
};
use lennard_integrators::bit_reversible_verlet::{BitReversibleVerlet, Options};
use lennard_integrators::oscillator::HarmonicForces;
use lennard_integrators::{IntegratorOptions, build};

fn method() -> Integrator {
    Integrator::new(BitReversibleVerlet::new(&Options::default()))
}

/// The positions as whole multiples of the grid spacing, as they are saved.
fn grid_positions(integrator: &Integrator) -> Vec<i64> {
    let mut archive = StateArchive::default();
    integrator.save(&mut archive.writer());
    archive.reader().i64("current").unwrap().to_vec()
}

fn reverse(state: &mut State) {
    for v in &mut state.velocities {
        *v = -*v;
    }
}

/// Runs forward, turns the velocities round, and runs back with the same method object or a fresh one.
fn there_and_back(integrator: &mut Integrator, offset: DVec3, steps: u64) -> (State, State, State) {
    let (mut positions, velocities) = cluster(3, 0.8, 11);
    for x in &mut positions {
        *x += offset;
    }
    let system = System::atoms(27);
    let mut state = State::new(lennard_core::PeriodicBox::boundless(), positions, velocities);
    let dt = 0.004;
    integrator.start(&system, &mut state, &mut Cluster, dt, Want::NOTHING).unwrap();
    let start = state.clone();
    for _ in 0..steps {
        integrator.step(&system, &mut state, &mut Cluster, dt, Want::NOTHING).unwrap();
    }
    let turning_point = state.clone();
    reverse(&mut state);
    run(integrator, &system, &mut Cluster, &mut state, dt, steps, |_, _| {}).unwrap();
    reverse(&mut state);
    (start, turning_point, state)
}

#[test]
fn it_returns_to_its_start_to_the_last_bit() {
    let (start, turning_point, end) = there_and_back(&mut method(), DVec3::ZERO, 20_000);
    assert_eq!(end.positions, start.positions);
    assert_eq!(end.velocities, start.velocities);
    assert_eq!(end.forces, start.forces);
    // It did go somewhere: the cluster has melted or moved meanwhile.
    let moved = (turning_point.positions[0] - start.positions[0]).length();
    assert!(moved > 0.1, "{moved}");
}

#[test]
fn it_returns_exactly_even_where_the_grid_is_finer_than_a_double() {
    // At 1000 σ a double is 2⁻⁴³, the grid 2⁻⁴⁸: the integers remember what the doubles cannot.
    let offset = DVec3::new(1000.3, -777.7, 512.5);
    let (start, _, end) = there_and_back(&mut method(), offset, 5_000);
    assert_eq!(end.positions, start.positions);
    assert_eq!(end.velocities, start.velocities);
}

#[test]
fn velocity_verlet_does_not_return_exactly() {
    let mut verlet = build(&IntegratorOptions::VelocityVerlet(Default::default()));
    let (start, _, end) = there_and_back(&mut verlet, DVec3::ZERO, 20_000);
    assert_ne!(end.positions, start.positions);
}

#[test]
fn it_returns_exactly_through_a_checkpoint() {
    let (positions, velocities) = cluster(3, 0.8, 12);
    let system = System::atoms(27);
    let mut state = State::new(lennard_core::PeriodicBox::boundless(), positions, velocities);
    let dt = 0.004;
    let mut there = method();
    run(&mut there, &system, &mut Cluster, &mut state, dt, 1, |_, _| {}).unwrap();
    let start = grid_positions(&there);
    let want = Want::NOTHING;
    for _ in 0..500 {
        there.step(&system, &mut state, &mut Cluster, dt, want).unwrap();
    }
    let mut archive = StateArchive::default();
    lennard_core::Persist::save(&there, &mut archive.writer());
    let mut back = method();
    lennard_core::Persist::restore(&mut back, &archive.reader()).unwrap();
    reverse(&mut state);
    run(&mut back, &system, &mut Cluster, &mut state, dt, 500, |_, _| {}).unwrap();
    assert_eq!(grid_positions(&back), start);
}

#[test]
fn a_particle_that_leaves_the_grid_is_an_error() {
    // A repelling spring doubles the distance every 0.7 τ: 4096 σ come soon.
    let mut state =
        State::new(lennard_core::PeriodicBox::boundless(), vec![DVec3::X], vec![DVec3::X]);
    let result = run(
        &mut method(),
        &System::atoms(1),
        &mut HarmonicForces::new(-1.0),
        &mut state,
        0.1,
        1000,
        |_, _| {},
    );
    assert!(
        matches!(result, Err(StepError::Force(ForceError::NonFinitePosition { particle: 0 }))),
        "{result:?}"
    );
    let last = state.positions[0].x;
    assert!(last > 1000.0 && last.is_finite());
    // So is one that starts outside.
    let mut far =
        State::new(lennard_core::PeriodicBox::boundless(), vec![DVec3::X * 1e9], vec![DVec3::ZERO]);
    let mut forces = HarmonicForces::new(1.0);
    let refused = method().start(&System::atoms(1), &mut far, &mut forces, 0.1, Want::NOTHING);
    assert!(matches!(refused, Err(StepError::Unsuited { .. })));
}
