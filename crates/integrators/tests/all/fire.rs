//! Relaxation of starts that lie too close together.

use crate::common::{Cluster, add_pairs, scattered};
use lennard_core::{DVec3, PeriodicBox};
use lennard_integrators::fire::{FireError, FireOptions, relax};
use lennard_integrators::oscillator::HarmonicForces;

fn closest_pair(points: &[DVec3]) -> f64 {
    let mut closest = f64::INFINITY;
    for i in 0..points.len() {
        for j in 0..i {
            closest = closest.min((points[i] - points[j]).length());
        }
    }
    closest
}

#[test]
fn a_random_start_with_huge_forces_relaxes() {
    // 100 particles at ρ = 0.8, pairs as close as 0.1 σ: forces of the order 48·10¹³.
    let mut points = scattered(100, 5.0, 0.1, 1);
    assert!(closest_pair(&points) < 0.3);
    relax(&PeriodicBox::boundless(), &mut points, &mut Cluster, &FireOptions::default()).unwrap();
    let mut forces = vec![DVec3::ZERO; points.len()];
    add_pairs(&points, (1.0, 1.0), 1, &mut forces);
    assert!(forces.iter().all(|f| f.length() <= 10.0));
    // The pair force alone passes 10 ε/σ below r = 1.04 σ; neighbors can hold a pair closer, not far.
    assert!(closest_pair(&points) > 0.85, "{}", closest_pair(&points));
}

#[test]
fn relaxation_finds_the_minimum_of_a_pair() {
    let mut points = vec![DVec3::ZERO, DVec3::new(0.6, 0.5, 0.4)];
    let options = FireOptions { largest_force: 1e-9, ..FireOptions::default() };
    relax(&PeriodicBox::boundless(), &mut points, &mut Cluster, &options).unwrap();
    // r = 2^{1/6}, U = −1; U″ = 57.1 there, so a force of 1e-9 leaves 2e-11 in r.
    assert!((closest_pair(&points) - 2.0_f64.powf(1.0 / 6.0)).abs() < 1e-10);
    let energy = add_pairs(&points, (1.0, 1.0), 1, &mut [DVec3::ZERO; 2]);
    assert!((energy + 1.0).abs() < 1e-14);
}

#[test]
fn no_particle_moves_farther_than_allowed() {
    // Forty pairs far apart all overlap, the first by far the most. Mixing gives it a share of the
    // motion of all others. This share alone would carry it beyond the limit.
    let mut points: Vec<DVec3> = (0..40)
        .flat_map(|pair| {
            let apart = if pair == 0 { 0.01 } else { 0.5 };
            let first = DVec3::Y * (20.0 * f64::from(pair));
            [first, first + DVec3::X * apart]
        })
        .collect();
    let before = points.clone();
    let options = FireOptions { max_steps: 7, ..FireOptions::default() };
    let failed = relax(&PeriodicBox::boundless(), &mut points, &mut Cluster, &options);
    assert!(matches!(failed, Err(FireError::NotRelaxed { steps: 7, .. })));
    let moved = |i: usize| (points[i] - before[i]).length();
    for i in 0..points.len() {
        // Seven steps of at most 0.05 σ, up to rounding.
        assert!(moved(i) <= 7.0 * 0.05 * (1.0 + 1e-12), "{i}: {}", moved(i));
    }
    assert!(moved(0) > 0.3);
}

#[test]
fn what_cannot_be_relaxed_is_refused() {
    let mut same_place = vec![DVec3::ONE; 2];
    assert!(matches!(
        relax(&PeriodicBox::boundless(), &mut same_place, &mut Cluster, &FireOptions::default()),
        Err(FireError::Force(_))
    ));
    let mut damped = HarmonicForces::new(1.0).with_damping(0.1);
    assert!(matches!(
        relax(&PeriodicBox::boundless(), &mut [DVec3::ONE], &mut damped, &FireOptions::default()),
        Err(FireError::VelocityDependentForce)
    ));
}

#[test]
fn a_configuration_without_large_forces_is_left_alone() {
    let mut points = vec![DVec3::ZERO, DVec3::X * 1.2];
    let before = points.clone();
    let steps =
        relax(&PeriodicBox::boundless(), &mut points, &mut Cluster, &FireOptions::default());
    assert_eq!((steps, points), (Ok(0), before));
}
