//! Sums by cells beside sums over particles one by one.

use lennard_core::random::Streams;
use rand_distr::{Distribution, StandardUniform};

use std::f64::consts::TAU;

use super::*;

const LENGTH: f64 = 37.0;

/// Heights in and beside the box, most of them in a layer.
fn heights(n: usize) -> Vec<DVec3> {
    let mut rng = Streams::new(5).sequential("heights");
    let mut draw = || -> f64 { StandardUniform.sample(&mut rng) };
    let mut height = |i: usize| match i % 10 {
        0 => 3.0 * LENGTH * (draw() - 0.5),
        _ => LENGTH * (0.4 + 0.3 * draw()),
    };
    (0..n).map(|i| DVec3::new(1.0, 2.0, height(i))).collect()
}

/// S_n one by one.
fn one_by_one(waves: usize, positions: &[DVec3]) -> Vec<[f64; 2]> {
    let of_wave = |n: usize| {
        let k = TAU * n as f64 / LENGTH;
        let cosines = positions.iter().map(|r| (k * r.z).cos()).sum();
        let sines = positions.iter().map(|r| (k * r.z).sin()).sum();
        [cosines, sines]
    };
    (1..=waves).map(of_wave).collect()
}

/// Short and long sums over ranges, and numbers of waves that leave the cells with all remainders.
#[test]
fn sums_and_forces_are_those_of_particles_one_by_one() {
    for (n, waves) in [(300, 1), (500, 7), (700, 24), (5000, 30)] {
        let cells = Cells::new(LENGTH, waves);
        let positions = heights(n);
        let wanted = one_by_one(waves, &positions);
        let found = cells.sums(&positions, None);
        // The polynomials are worst for the shortest waves.
        let bar = |wave: usize| {
            let part = (wave + 1) as f64 / waves as f64;
            n as f64 * (5e-8 * part.powi(8) + 1e-12)
        };
        for (wave, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
            for (a, b) in found.iter().zip(wanted) {
                assert!((a - b).abs() < bar(wave), "{wave} of {waves}: {a} {b}");
            }
        }
        // Strengths that fall with the wave number, as the strengths of a tail do.
        let strength = |wave: usize| 0.5_f64.powi(wave as i32);
        let of_wave =
            |(wave, [re, im]): (usize, &[f64; 2])| [strength(wave) * re, -strength(wave) * im];
        let coefficients: Vec<[f64; 2]> = wanted.iter().enumerate().map(of_wave).collect();
        let mut forces = vec![DVec3::ONE; n];
        cells.push(&coefficients, &positions, &mut forces);
        let force_at = |z: f64| -> f64 {
            let all = coefficients.iter().enumerate();
            all.map(|(wave, [a, b])| {
                let k = TAU * (wave + 1) as f64 / LENGTH;
                a * (k * z).sin() + b * (k * z).cos()
            })
            .sum()
        };
        let wanted: Vec<f64> = positions.iter().map(|r| force_at(r.z)).collect();
        let largest = wanted.iter().fold(0.0_f64, |all, f| all.max(f.abs()));
        let far = if waves == 1 { 1e-7 } else { 1e-9 };
        for (force, wanted) in forces.iter().zip(&wanted) {
            assert!((force.z - 1.0 - wanted).abs() < far * largest + 1e-14);
            assert_eq!((force.x, force.y), (1.0, 1.0));
        }
    }
}

/// The order of the particles, and the ranges that they fall into, change no bit.
#[test]
fn moments_depend_on_no_order() {
    let cells = Cells::new(LENGTH, 24);
    let positions = heights(3 * CHUNK + 11);
    let mut turned = positions.clone();
    turned.reverse();
    assert_eq!(cells.sums(&positions, None), cells.sums(&turned, None));
    turned.rotate_left(777);
    assert_eq!(cells.sums(&positions, None), cells.sums(&turned, None));
}

/// Registers give the bits of numbers one by one.
#[test]
fn registers_change_no_bit() {
    let cells = &Cells::new(LENGTH, 24);
    let positions = &heights(501);
    let rows = &in_lanes(
        #[inline(always)]
        || cells.moments(positions),
    );
    assert_eq!(rows, &cells.moments(positions));
    let waves = &in_lanes(
        #[inline(always)]
        || cells.waves_of(rows),
    );
    assert_eq!(waves, &cells.waves_of(rows));
    let rows = &in_lanes(
        #[inline(always)]
        || cells.rows_of(waves),
    );
    assert_eq!(rows, &cells.rows_of(waves));
    let mut forces = [vec![DVec3::ZERO; 501], vec![DVec3::ZERO; 501]];
    let [one, other] = &mut forces;
    in_lanes(
        #[inline(always)]
        || cells.add_forces(rows, positions, one),
    );
    cells.add_forces(rows, positions, other);
    assert_eq!(forces[0], forces[1]);
}

#[test]
fn a_height_that_is_no_number_has_a_force_that_is_none() {
    let cells = Cells::new(LENGTH, 7);
    for bad in [f64::NAN, f64::INFINITY] {
        let positions = [DVec3::ZERO, DVec3::new(0.0, 0.0, bad)];
        let mut forces = [DVec3::ZERO; 2];
        cells.push(&[[1.0, 1.0]; 7], &positions, &mut forces);
        assert!(forces[0].z.is_finite() && forces[1].z.is_nan());
    }
}
