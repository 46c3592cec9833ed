use lennard_core::{DVec3, Own, team_of_threads};

use super::*;
use crate::bond_order::harmonics::NOTHING;
use crate::testing::{context, fcc, normal, random_positions};

/// All vectors whose coordinates are these numbers in any order and with any signs.
fn signed(numbers: [f64; 3]) -> Vec<DVec3> {
    let mut found: Vec<DVec3> = Vec::new();
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for signs in 0..8_u32 {
            let sign = |k: u32| if signs >> k & 1 == 0 { 1.0 } else { -1.0 };
            let v = DVec3::from_array(order.map(|k| numbers[k]));
            let v = v * DVec3::new(sign(0), sign(1), sign(2));
            if found.iter().all(|other| other.distance(v) > 1e-9) {
                found.push(v);
            }
        }
    }
    found
}

/// The twelve neighbors in a hexagonal crystal: six in the plane, three above and three below in the same places.
fn hexagonal() -> Vec<DVec3> {
    let at = |degrees: f64, r: f64, z: f64| {
        let angle = degrees.to_radians();
        DVec3::new(r * angle.cos(), r * angle.sin(), z)
    };
    let mut all: Vec<DVec3> = (0..6).map(|k| at(60.0 * f64::from(k), 1.0, 0.0)).collect();
    for z in [-1.0, 1.0] {
        let (r, z) = (1.0 / 3.0_f64.sqrt(), z * (2.0_f64 / 3.0).sqrt());
        all.extend((0..3).map(|k| at(30.0 + 120.0 * f64::from(k), r, z)));
    }
    all
}

#[test]
fn perfect_shells_have_their_invariants() {
    // Steinhardt, Nelson and Ronchetti 1983 have these to a few digits; ten digits by exact sums over the shells.
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let icosahedron: Vec<DVec3> = signed([0.0, 1.0, golden])
        .into_iter()
        // Even permutations alone.
        .filter(|v| {
            let a = v.abs();
            (a.x < 0.5 && a.y < a.z) || (a.y < 0.5 && a.z < a.x) || (a.z < 0.5 && a.x < a.y)
        })
        .collect();
    let (diagonal, axis) = (signed([1.0, 1.0, 1.0]), signed([0.0, 0.0, 2.0]));
    let both: Vec<DVec3> = diagonal.iter().chain(&axis).copied().collect();
    let shells = [
        (
            signed([0.0, 1.0, 1.0]),
            12,
            [0.190_940_654_0, -0.159_317_373_1, 0.574_524_259_7, -0.013_160_600_7],
        ),
        (hexagonal(), 12, [0.097_222_222_2, 0.134_097_046_9, 0.484_761_685_2, -0.012_441_959_5]),
        (diagonal, 8, [0.509_175_077_2, -0.159_317_373_1, 0.628_539_361_1, 0.013_160_600_7]),
        (both, 14, [0.036_369_648_4, 0.159_317_373_1, 0.510_688_230_9, 0.013_160_600_7]),
        (axis, 6, [0.763_762_615_8, 0.159_317_373_1, 0.353_553_390_6, 0.013_160_600_7]),
        (icosahedron, 12, [0.0, 0.0, 0.663_324_958_1, -0.169_753_895_0]),
    ];
    let [four, six] = [Harmonics::new(4), Harmonics::new(6)];
    // A rotation changes nothing.
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
    for (shell, neighbors, expected) in shells {
        assert_eq!(shell.len(), neighbors);
        for turn in [glam::DQuat::IDENTITY, turn] {
            let mut moments = [NOTHING; 2];
            for bond in &shell {
                four.add(&mut moments[0], turn * *bond);
                six.add(&mut moments[1], turn * *bond);
            }
            let [a, b] = moments.map(|m| m.map(|c| c.map(|x| x / neighbors as f64)));
            let found = [four.q(&a), four.w(&a), six.q(&b), six.w(&b)];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-8, "{neighbors}: {found} {expected}");
            }
        }
    }
}

#[test]
fn a_crystal_is_solid_to_the_last_particle_and_random_places_are_not() {
    let (cell, lattice) = fcc(5, 1.1);
    let n = lattice.len();
    let order = BondOrder::new(
        &BondOrderOptions::default(),
        &BuildContext { cell, n_atoms: n, ..context(1.0, 1) },
    )
    .unwrap();
    let row = order.look(&cell, &lattice);
    for (k, expected) in [
        (0, 0.190_940_654),
        (1, 0.574_524_259_7),
        (5, 0.574_524_259_7),
        (7, 0.574_524_259_7),
        (10, 1.0),
        (11, 12.0),
    ] {
        assert!((row[k] - expected).abs() < 1e-8, "{k}: {}", row[k]);
    }
    let shaken: Vec<DVec3> = (0..n).map(|i| lattice[i] + 0.05 * normal(3, 0, i)).collect();
    assert!(solid_share(&cell, &shaken) > 0.95);
    let side = cell.lengths().x;
    let random = random_positions(n, side, 4);
    assert!(solid_share(&cell, &random) < 0.05);
    // Q₆ of random bonds is of order 1/√(bonds).
    let row = order.look(&cell, &random);
    assert!(row[1] < 0.06 && row[7] < row[5], "{row:?}");
}

#[test]
fn half_a_crystal_is_half_solid() {
    let (cell, lattice) = fcc(6, 1.1);
    let half = 0.5 * cell.lengths().z;
    let side = cell.lengths().x;
    let random = random_positions(lattice.len(), side, 5);
    let crystal = lattice.iter().copied().filter(|r| r.z < half);
    let both: Vec<DVec3> = crystal.chain(random.into_iter().filter(|r| r.z >= half)).collect();
    let share = solid_share(&cell, &both);
    assert!((0.4..0.55).contains(&share), "{share}");
}

#[test]
fn blocks_count_the_solid_particles_of_the_whole() {
    let (cell, lattice) = fcc(8, 1.1);
    // Displacements at which some particles are solid-like and others are not.
    let shaken: Vec<DVec3> =
        (0..lattice.len()).map(|i| lattice[i] + 0.16 * normal(7, 0, i)).collect();
    let own = Own::all_of(shaken.len());
    let whole = solid_by_blocks(&own, &cell, &shaken, [1, 1]);
    assert!((200..1800).contains(&whole), "{whole} of {}", shaken.len());
    let found = [[1, 6], [3, 1], [2, 4]].map(|b| solid_by_blocks(&own, &cell, &shaken, b));
    assert_eq!(found, [whole; 3]);
    for (ranks, blocks) in [(2, [1, 1]), (2, [1, 3]), (3, [2, 2])] {
        let found = team_of_threads(ranks, |team| {
            let own = Own::of_rank(&team, shaken.len());
            solid_by_blocks(&own, &cell, &shaken[own.numbers()], blocks)
        });
        assert_eq!(found, vec![whole; ranks]);
    }
}
