//! The bits of forces: with and without energetics, on any number of threads, and canonical.

use lennard_core::Exclusions;

use super::exclusions::{chains, exclusions};
use super::*;

#[test]
fn forces_have_the_same_bits_with_and_without_energetics_and_totals_with_and_without_others() {
    // Clusters of four leave three particles over.
    let (cell, mut positions) = liquid([8, 8, 8], 0.8442, 0.15);
    positions.pop();
    let cases = forms().into_iter().flat_map(|base| [(base, 1), (base, 3)]);
    for (base, species) in cases {
        let mixture = mixture_or_one(species, base.truncation.r_cut, positions.len());
        for kernel in kernels() {
            for neighbor in [verlet(None), NeighborOptions { mode: ListMode::Direct, skin: None }] {
                let options = ForceFieldOptions { kernel, neighbor, ..base };
                let mut forces = built(&options, mixture.as_ref(), cell, positions.len());
                let (plain, none) = all(&mut forces, cell, &positions, Want::NOTHING);
                assert_eq!(none, lennard_core::Energetics::default());
                let mut totals = Vec::new();
                for want in [Want::TOTALS, Want::VIRIAL_TENSOR | Want::TOTALS, want_each()] {
                    let (found, energetics) = all(&mut forces, cell, &positions, want);
                    assert_eq!(found, plain, "{options:?}");
                    totals.push(lennard_core::Energetics {
                        virial: None,
                        per_particle: None,
                        ..energetics
                    });
                }
                assert!(totals[0].laplacian.is_some());
                assert!(
                    totals.iter().all(|t| *t == totals[0]),
                    "totals do not depend on what else is wanted: {options:?}: {totals:?}"
                );
            }
        }
    }
}

#[test]
fn long_lists_have_the_same_bits_too() {
    // Lists of clusters have more than 32 blocks. A loop that takes one member after another converts 32 of them at a time, where
    // a cluster is small beside the box. Some portions end among the blocks of chains with pairs that are left out.
    let (sites, cells) = (5, [12, 12, 12]);
    let atoms = (liquid([20, 20, 20], 0.8442, 0.15), Exclusions::default(), 4.5);
    for ((cell, positions), exclusions, r_cut) in
        [atoms, (chains(cells, 0.85, sites), exclusions(sites), 4.5)]
    {
        let truncation = TruncationOptions::new(TruncationKind::Cut, r_cut);
        let base = ForceFieldOptions { truncation, exclusions, ..ForceFieldOptions::default() };
        let pairs = reference(&base, cell, &positions).1.pairs;
        for kernel in kernels() {
            let options = ForceFieldOptions { kernel, ..base };
            let mut forces = built(&options, None, cell, positions.len());
            let (plain, _) = all(&mut forces, cell, &positions, Want::NOTHING);
            let (with_totals, totals) = all(&mut forces, cell, &positions, Want::TOTALS);
            assert_eq!(plain, with_totals, "{kernel:?} {r_cut}");
            // Many bundles end with a cluster of fewer than four: what it lacks has no part in totals.
            let each = all(&mut forces, cell, &positions, want_each()).1;
            let of_each = lennard_core::Energetics { virial: None, per_particle: None, ..each };
            assert_eq!(totals, of_each, "{kernel:?} {r_cut}");
            let miscounted = totals.pairs.unwrap().abs_diff(pairs.unwrap());
            assert!(miscounted <= 4, "{kernel:?} {r_cut}: {miscounted}");
        }
    }
}

#[test]
fn the_same_bits_come_from_any_number_of_threads() {
    // Few particles, with one copy per thread, and many. Lists are built again on the way.
    let cases = [
        ([12, 11, 10], 1, false),
        ([14, 13, 12], 1, true),
        ([12, 11, 10], 2, false),
        ([14, 13, 12], 3, true),
    ];
    for (sides, species, many) in cases {
        let (cell, start) = liquid(sides, 0.8442, 0.15);
        let mixture = mixture_or_one(species, 2.5, start.len());
        assert_eq!(start.len() > 2048, many);
        for kernel in kernels() {
            let run = || {
                let options = ForceFieldOptions { kernel, ..ForceFieldOptions::default() };
                let mut forces = built(&options, mixture.as_ref(), cell, start.len());
                (0..4)
                    .flat_map(|k| {
                        let positions = moved(&start, 0.06 * f64::from(k));
                        [Want::NOTHING, want_each()]
                            .map(|want| all(&mut forces, cell, &positions, want))
                    })
                    .collect::<Vec<_>>()
            };
            let one = in_threads(1, run);
            for threads in [2, 3, 8] {
                assert!(in_threads(threads, run) == one, "{threads} threads, {kernel:?}");
            }
        }
    }
}

#[test]
fn forces_of_a_particle_do_not_depend_on_how_many_particles_lie_beyond_its_neighbors() {
    // Slots of one block lie farther apart than 32,767 where particles crowd beside, and across the faces of the box.
    let (cell, start) = liquid([64, 60, 60], 0.3, 0.1);
    let apart = start[1].z - start[0].z;
    let crowd = |r: &DVec3| {
        let at = *r / cell.lengths();
        let moves = (0.1..0.3).contains(&at.x) && at.y < 0.5;
        let shift = DVec3::new((0.4 * cell.lengths().x / apart).round() + 0.5, 0.5, 0.5) * apart;
        if moves { *r + shift } else { *r }
    };
    let crowded: Vec<DVec3> = start.iter().map(crowd).collect();
    let changed: Vec<usize> = (0..start.len()).filter(|i| start[*i] != crowded[*i]).collect();
    assert!(changed.len() > start.len() / 12);
    // Bundles beside the regions that lose or win some have other neighbors.
    let margin = DVec3::splat(9.0) / cell.lengths();
    let is_apart = |r: &DVec3| {
        let at = *r / cell.lengths();
        let beside = |from: f64, to: f64| (from - margin.x..to + margin.x).contains(&at.x);
        let is_beside = beside(0.1, 0.3) || beside(0.5, 0.72);
        !is_beside || (0.53 + margin.y..1.0 - margin.y).contains(&at.y)
    };
    let compared: Vec<usize> = (0..start.len()).filter(|i| is_apart(&start[*i])).collect();
    assert!(compared.len() > start.len() / 3);
    for kernel in kernels() {
        let options = ForceFieldOptions { kernel, ..ForceFieldOptions::default() };
        let [before, after] = [&start, &crowded].map(|positions| {
            let mut forces = built(&options, None, cell, positions.len());
            let (forces, energetics) = all(&mut forces, cell, positions, want_each());
            (forces, energetics.per_particle.unwrap())
        });
        for i in &compared {
            let [a, b] = [&before, &after].map(|(forces, each)| (forces[*i], each[*i]));
            assert_eq!(a, b, "particle {i}, {kernel:?}");
        }
        let differ = changed.iter().filter(|i| before.0[**i] != after.0[**i]).count();
        assert!(differ > changed.len() / 2);
    }
}

#[test]
fn canonical_forces_are_a_pure_function_of_the_positions() {
    for species in [1, 2] {
        canonical_forces_are_pure(species);
    }
}

fn canonical_forces_are_pure(species: usize) {
    let (cell, start) = liquid([9, 8, 8], 0.8442, 0.15);
    let mixture = mixture_or_one(species, 2.5, start.len());
    let target = moved(&start, 0.1);
    let bits = |skin: Option<f64>, mode, threads, before: &[DVec3]| {
        let options = ForceFieldOptions {
            canonical: true,
            neighbor: NeighborOptions { mode, skin },
            ..ForceFieldOptions::default()
        };
        in_threads(threads, || {
            let mut forces = built(&options, mixture.as_ref(), cell, start.len());
            all(&mut forces, cell, before, Want::NOTHING);
            all(&mut forces, cell, &target, Want::NOTHING).0
        })
    };
    let wanted = bits(None, ListMode::Direct, 1, &start);
    for (skin, threads) in [(0.0, 1), (0.21, 2), (0.4, 3), (0.7, 8)] {
        for before in [&start, &target, &moved(&start, 0.3)] {
            let found = bits(Some(skin), ListMode::Verlet, threads, before);
            assert!(found == wanted, "skin {skin}, {threads} threads");
        }
    }
    // Shifting a particle by whole boxes of a power-of-two side changes no bit either.
    let cell = PeriodicBox::new(DVec3::splat(8.0)).unwrap();
    let (_, small) = liquid([7, 7, 7], 343.0 / 512.0, 0.1);
    let small: Vec<DVec3> =
        small.iter().map(|r| cell.wrap((*r * 1024.0).round() / 1024.0)).collect();
    let shifted: Vec<DVec3> = small
        .iter()
        .enumerate()
        .map(|(i, r)| *r + 8.0 * DVec3::new(i as f64 % 3.0, -(i as f64 % 5.0), 1.0))
        .collect();
    let options = ForceFieldOptions { canonical: true, ..ForceFieldOptions::default() };
    let mut forces = build(&options, &conditions(cell, small.len())).unwrap();
    let a = all(&mut forces, cell, &small, Want::NOTHING).0;
    assert!(a == all(&mut forces, cell, &shifted, Want::NOTHING).0);
}
