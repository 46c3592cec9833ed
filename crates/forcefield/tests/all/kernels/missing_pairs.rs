//! No pair inside the cutoff is missed.

use super::*;

#[test]
fn no_pair_of_very_many_particles_is_missed_where_many_moved_far() {
    // So many particles that displacements are packed, from the second look on.
    let (cell, start) = liquid([52, 51, 50], 0.8442, 0.2);
    let n = start.len();
    let noise = scatter(n, DVec3::splat(2.0), 0.7);
    let moved = |most: f64| -> Vec<DVec3> {
        let push = |k: usize| {
            let way = if k.is_multiple_of(17) { most } else { 0.09 };
            way * (noise[k] - DVec3::ONE).normalize()
        };
        start.iter().enumerate().map(|(k, r)| *r + push(k)).collect()
    };
    for precision in [Precision::Double, Precision::Mixed] {
        let options = ForceFieldOptions {
            potential: PotentialOptions::SoftSphere(SoftSphere { exponent: 4 }),
            kernel: KernelOptions { precision, ..KernelOptions::default() },
            neighbor: verlet(Some(0.25)),
            ..ForceFieldOptions::default()
        };
        let at = conditions(cell, n);
        let mut forces = build(&options, &at).unwrap();
        all(&mut forces, cell, &start, Want::NOTHING);
        for most in [0.13, 0.2, 0.36] {
            let later = moved(most);
            let f = all(&mut forces, cell, &later, Want::NOTHING).0;
            let expected = all(&mut build(&options, &at).unwrap(), cell, &later, Want::NOTHING).0;
            // Rounding may decide at the very cutoff, where the force jumps by 0.04.
            let differ = |i: &usize| (f[*i] - expected[*i]).length() > 0.02;
            for i in (0..n).filter(differ) {
                let r = |j: &DVec3| cell.minimum_image(later[i] - *j).length();
                let at_the_cutoff = later.iter().any(|j| (r(j) - 2.5).abs() < 1e-6);
                assert!(at_the_cutoff, "particle {i}, {precision:?}, {most}");
            }
        }
        if precision == Precision::Mixed {
            assert_eq!(forces.statistics().builds, 1, "the missing pairs were inserted");
        }
    }
}

#[test]
fn no_pair_is_missed_along_a_trajectory() {
    let (cell, mut positions) = liquid([8, 8, 8], 0.8442, 0.1);
    let n = positions.len();
    for kernel in kernels() {
        let options = ForceFieldOptions {
            kernel,
            neighbor: verlet(Some(0.25)),
            ..ForceFieldOptions::default()
        };
        let mut forces = build(&options, &conditions(cell, n)).unwrap();
        let mut velocities = scatter(n, DVec3::splat(3.0), 0.1);
        let mean = velocities.iter().sum::<DVec3>() / n as f64;
        velocities.iter_mut().for_each(|v| *v -= mean);
        let dt = 0.004;
        let (mut f, _) = all(&mut forces, cell, &positions, Want::NOTHING);
        let (mut before, mut age) = (1, 0);
        for step in 0..150 {
            for ((r, v), f) in positions.iter_mut().zip(&mut velocities).zip(&f) {
                *v += 0.5 * dt * *f;
                *r += dt * *v;
            }
            let (next, found) = all(&mut forces, cell, &positions, Want::ENERGY);
            f = next;
            for (v, f) in velocities.iter_mut().zip(&f) {
                *v += 0.5 * dt * *f;
            }
            // A list lacks a pair most likely just before it expires.
            let builds = forces.statistics().builds;
            age = if builds > before { 0 } else { age + 1 };
            before = builds;
            if age >= 6 || step % 10 == 0 {
                assert_eq!(found.pairs, reference(&options, cell, &positions).1.pairs);
            }
        }
        let statistics = forces.statistics();
        assert!(statistics.builds > 3, "{statistics:?}");
    }
}

#[test]
fn a_pair_that_comes_from_beyond_the_list_is_not_missed_and_others_do_not_cost_a_build() {
    // Two particles move by 0.16 σ each, more than half the skin of 0.3: from 2.81 to 2.49 σ apart, or past each other.
    let cell = PeriodicBox::new(DVec3::splat(30.0)).unwrap();
    let mut start = scatter(500, cell.lengths() - DVec3::splat(6.0), 0.4);
    let (a, b) = (DVec3::splat(27.0), DVec3::splat(27.0) + DVec3::X * 2.81);
    start.extend([a, b]);
    let n = start.len();
    for kernel in kernels() {
        // Cluster lists insert the pair. Other lists are built again.
        let inserts = kernel.precision == Precision::Mixed;
        for (direction, builds) in [(DVec3::X, if inserts { 1 } else { 2 }), (DVec3::Y, 1)] {
            let options = ForceFieldOptions {
                potential: PotentialOptions::SoftSphere(SoftSphere { exponent: 4 }),
                kernel,
                neighbor: verlet(Some(0.3)),
                ..ForceFieldOptions::default()
            };
            let mut forces = build(&options, &conditions(cell, n)).unwrap();
            all(&mut forces, cell, &start, Want::NOTHING);
            let mut positions = start.clone();
            positions[n - 2] += 0.16 * direction;
            positions[n - 1] -= 0.16 * direction;
            let (_, found) = all(&mut forces, cell, &positions, Want::ENERGY);
            assert_eq!(found.pairs, reference(&options, cell, &positions).1.pairs);
            assert_eq!(forces.statistics().builds, builds, "{options:?}");
        }
    }
}
