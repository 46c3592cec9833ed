//! The identities that a planar tail obeys.

use lennard_core::random::Streams;
use lennard_forcefield::TruncationKind;
use rand_distr::{Distribution, StandardUniform};

use super::*;

const SIDES: DVec3 = DVec3::new(7.0, 8.0, 21.0);

fn options(r_cut: f64) -> ForceFieldOptions {
    ForceFieldOptions {
        truncation: TruncationOptions {
            tail_correction: false,
            ..TruncationOptions::new(TruncationKind::Cut, r_cut)
        },
        ..ForceFieldOptions::default()
    }
}

fn tail(sides: DVec3) -> PlanarTail {
    PlanarTail::new(&options(2.5), &PeriodicBox::new(sides).unwrap()).unwrap()
}

/// Places in parts of the box: most of them in a slab.
fn places(n: usize) -> Vec<DVec3> {
    let mut rng = Streams::new(9).sequential("places");
    let mut draw = || -> f64 { StandardUniform.sample(&mut rng) };
    (0..n)
        .map(|i| {
            let (x, y, z) = (draw(), draw(), draw());
            DVec3::new(x, y, if i % 5 == 0 { z } else { 0.35 + 0.4 * z })
        })
        .collect()
}

fn evaluate(sides: DVec3, places: &[DVec3]) -> (Energetics, Vec<DVec3>) {
    let cell = PeriodicBox::new(sides).unwrap();
    let positions: Vec<DVec3> = places.iter().map(|r| *r * sides).collect();
    let mut forces = vec![DVec3::ONE; places.len()];
    let at = Configuration::at_rest(&cell, &positions);
    let want = Want::TOTALS;
    let found = tail(sides).evaluate(at, Part::All, want, &mut forces);
    (found.unwrap(), forces)
}

fn energy(sides: DVec3, places: &[DVec3]) -> f64 {
    evaluate(sides, places).0.conserved_potential.unwrap()
}

#[test]
fn forces_virial_and_laplacian_are_derivatives_of_the_energy() {
    let places = places(61);
    let (found, forces) = evaluate(SIDES, &places);
    let scale = found.conserved_potential.unwrap().abs();
    let h = 1e-4;
    let mut curvature = 0.0;
    for (i, force) in forces.iter().enumerate() {
        let moved = |h: f64| {
            let mut moved = places.clone();
            moved[i].z += h / SIDES.z;
            energy(SIDES, &moved)
        };
        let (up, down) = (moved(h), moved(-h));
        assert_eq!((force.x, force.y), (0.0, 0.0));
        assert!((force.z + (up - down) / (2.0 * h)).abs() < 1e-9 * scale, "{i}");
        curvature += (up - 2.0 * energy(SIDES, &places) + down) / (h * h);
    }
    // Rounding of a second difference.
    assert!((found.laplacian.unwrap() - curvature).abs() < 1e-5 * scale);
    let virial = found.virial.unwrap();
    for (axis, unit) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
        let scaled = |h: f64| energy(SIDES * (DVec3::ONE + h * unit), &places);
        // A fourth-order difference, with waves that are as many on both sides.
        let h = 1e-4;
        let slope =
            (8.0 * (scaled(h) - scaled(-h)) - (scaled(2.0 * h) - scaled(-2.0 * h))) / (12.0 * h);
        let own = virial.col(axis)[axis];
        assert!((own + slope).abs() < 1e-9 * scale, "{axis}: {own} {slope}");
    }
}

#[test]
fn momentum_is_kept_and_one_force_alone_is_the_same() {
    let places = places(200);
    let (_, forces) = evaluate(SIDES, &places);
    let sum: DVec3 = forces.iter().sum();
    let size: f64 = forces.iter().map(|f| f.z.abs()).sum();
    assert!(sum.length() < 1e-13 * size, "{sum}");
    let cell = PeriodicBox::new(SIDES).unwrap();
    let positions: Vec<DVec3> = places.iter().map(|r| *r * SIDES).collect();
    let at = Configuration::at_rest(&cell, &positions);
    for i in [0, 7, 199] {
        assert_eq!(tail(SIDES).force_on(i, at), forces[i]);
    }
}

#[test]
fn a_homogeneous_fluid_has_the_usual_tail() {
    // Evenly spaced layers have no wave that is shorter than their distance.
    let n = 640;
    let even: Vec<DVec3> = (0..n).map(|i| DVec3::new(0.1, 0.2, i as f64 / n as f64)).collect();
    let (found, forces) = evaluate(SIDES, &even);
    let volume = SIDES.element_product();
    let mut usual = options(2.5);
    usual.truncation.tail_correction = true;
    let usual = tail_correction(&usual, n, volume).unwrap();
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    near(found.potential_energy.unwrap(), usual.energy);
    near(found.conserved_potential.unwrap(), usual.pressure * volume);
    near(found.scalar_virial().unwrap(), usual.virial);
    let virial = found.virial.unwrap();
    near(virial.x_axis.x, virial.z_axis.z);
    assert!(forces.iter().all(|f| f.z.abs() < 1e-11));
}

#[test]
fn energy_of_few_particles_is_the_sum_over_pairs_and_images() {
    // φ(ξ) = 4π·(m⁻¹⁰/5 − m⁻⁴/2) + π·(r_c² − ξ²)₊·u(r_c), m = max(ξ, r_c), summed over images along z.
    let r = 2.5_f64;
    let at_cutoff = 4.0 * (r.powi(-12) - r.powi(-6));
    let phi = |x: f64, with_shift: bool| {
        let m = x.abs().max(r);
        let shift = if with_shift { at_cutoff } else { 0.0 };
        4.0 * std::f64::consts::PI * (0.2 * m.powi(-10) - 0.5 * m.powi(-4))
            + std::f64::consts::PI * (r * r - x * x).max(0.0) * shift
    };
    // Smooth layers: the sum over waves ends, and kinks of single particles would need more of them.
    let layers = 200;
    let weight = |i: usize| 1.0 + (TAU * i as f64 / layers as f64).cos();
    let wave = weight(0) / 2.0;
    let sides = DVec3::new(1.0, 1.0, SIDES.z);
    let tail = tail(sides);
    // N particles with the density 1 + cos(2πz/L): |S_1| = N/2, and no other wave.
    let n = layers as f64;
    let waves = Waves(
        (0..tail.n_modes()).map(|k| [if k == 0 { 0.5 * n * wave } else { 0.0 }, 0.0]).collect(),
    );
    let volume = sides.element_product();
    let found = tail.energetics(&waves, layers, volume, Want::TOTALS);
    let place = |i: usize| SIDES.z * i as f64 / layers as f64;
    let mut sums = [0.0; 2];
    for i in 0..layers {
        for j in 0..layers {
            for image in -10..=10 {
                let x = place(i) - place(j) + f64::from(image) * SIDES.z;
                for (sum, with_shift) in sums.iter_mut().zip([false, true]) {
                    *sum += 0.5 * weight(i) * weight(j) * phi(x, with_shift);
                }
            }
        }
    }
    // Layers and images are summed with a finite width and end: a part in 10⁴.
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    near(found.potential_energy.unwrap(), sums[0]);
    near(found.conserved_potential.unwrap(), sums[1]);
}
