//! Every loop against the reference loop, and the invariants that all of them share.

use crate::common::*;
use lennard_core::{
    Array, DVec3, ForceError, ForceTerm, Part, PeriodicBox, Persist, StateArchive, Want,
};
use lennard_forcefield::*;
use proptest::prelude::*;

fn forms() -> Vec<ForceFieldOptions> {
    let mut all = Vec::new();
    for potential in PotentialOptions::examples() {
        for &kind in TruncationKind::ALL {
            let truncation = TruncationOptions::new(kind, 2.5);
            if Model::new(&potential, &truncation).is_err() {
                continue;
            }
            all.push(ForceFieldOptions {
                potential,
                truncation,
                ..ForceFieldOptions::default()
            });
        }
    }
    all
}

fn want_each() -> Want {
    Want {
        per_particle: true,
        ..Want::TOTALS
    }
}

/// Moves every particle a little, each in its own direction.
fn moved(positions: &[DVec3], by: f64) -> Vec<DVec3> {
    let shake = scatter(positions.len(), DVec3::splat(2.0), 0.7);
    positions
        .iter()
        .zip(&shake)
        .map(|(r, s)| *r + (*s - DVec3::ONE).normalize_or_zero() * by)
        .collect()
}

#[test]
fn every_kernel_agrees_with_the_reference_after_the_particles_have_moved() {
    // Boxes as long along all axes are not stretched to σ in mixed precision.
    for cells in [[9, 8, 7], [8; 3]] {
        agree_after_a_move(cells);
    }
}

fn agree_after_a_move(cells: [usize; 3]) {
    let (cell, start) = liquid(cells, 0.8442, 0.15);
    let positions = moved(&start, 0.1);
    for base in forms() {
        let (wanted, totals) = reference(&base, cell, &positions);
        let sizes = magnitudes(&base, cell, &positions);
        let rms =
            (wanted.iter().map(|f| f.length_squared()).sum::<f64>() / wanted.len() as f64).sqrt();
        for kernel in kernels() {
            let options = ForceFieldOptions {
                kernel,
                neighbor: verlet(Some(0.3)),
                ..base
            };
            let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
            all(&mut forces, cell, &start, Want::NOTHING);
            let (found, energetics) = all(&mut forces, cell, &positions, want_each());
            assert_eq!(
                forces.statistics().builds,
                1,
                "the list was used after a move"
            );
            one_by_one(&options, cell, &positions, &found).unwrap_or_else(|e| panic!("{e}"));
            let mut squares = 0.0;
            for ((f, w), (size, stiffness)) in found.iter().zip(&wanted).zip(&sizes) {
                if kernel.precision == Precision::Double {
                    // Rounding of the sums, and of coordinates of some 10 σ through the stiffness.
                    let bound = 1e-13 * size + 8e-15 * stiffness;
                    assert!((*f - *w).length() <= bound, "{options:?}: {f} against {w}");
                }
                squares += (*f - *w).length_squared();
            }
            let error = (squares / wanted.len() as f64).sqrt() / rms;
            let (limit, relative) = match kernel.precision {
                Precision::Double => (1e-14, 1e-13),
                // Pairs in f32, whose last place is 6e-8, with factors up to 13 in the force.
                Precision::Mixed => (3e-6, 3e-6),
            };
            assert!(error <= limit, "{options:?}: RMS error {error:e}");
            let scale = |e: &lennard_core::Energetics| {
                let each = e.per_particle.as_ref().unwrap();
                each.iter().map(|(u, _)| u.abs()).sum::<f64>()
            };
            let size = scale(&totals);
            assert!(
                (energetics.potential_energy.unwrap() - totals.potential_energy.unwrap()).abs()
                    <= relative * size
            );
            assert!(
                (energetics.conserved_potential.unwrap() - totals.conserved_potential.unwrap())
                    .abs()
                    <= relative * size
            );
            assert_eq!(energetics.pairs, totals.pairs, "{options:?}");
            // The virial cancels between attraction and repulsion: judge by Σ r·|F|, a few times larger.
            let strength: f64 = sizes.iter().map(|s| s.0).sum();
            let difference = energetics.virial.unwrap() - totals.virial.unwrap();
            let worst = difference
                .to_cols_array()
                .map(f64::abs)
                .into_iter()
                .fold(0.0, f64::max);
            assert!(
                worst <= relative * strength,
                "{options:?}: {worst:e} of {strength:e}"
            );
            let stiffness: f64 = sizes.iter().map(|s| s.1).sum();
            assert!(
                (energetics.laplacian.unwrap() - totals.laplacian.unwrap()).abs()
                    <= relative * stiffness
            );
            let mine = energetics.per_particle.unwrap();
            for ((u, w), (u0, w0)) in mine.iter().zip(totals.per_particle.as_ref().unwrap()) {
                assert!((u - u0).abs() <= 30.0 * relative * (1.0 + u0.abs()));
                let d = (*w - *w0)
                    .to_cols_array()
                    .map(f64::abs)
                    .into_iter()
                    .fold(0.0, f64::max);
                assert!(
                    d <= 30.0 * relative * (1.0 + strength / mine.len() as f64),
                    "{d}"
                );
            }
        }
    }
}

/// Elements behind the last candidate of a search must be near to nothing.
///
/// The largest single is a whole number of boxes of 12 σ and of 15 σ, and not of 13 σ. It once seemed near in such boxes.
#[test]
fn small_boxes_of_any_side_agree_with_the_reference() {
    for side in [12.0, 13.0, 15.0] {
        let k = 9;
        let (cell, start) = liquid([k, k, k], (k as f64 / side).powi(3), 0.3);
        // Each of several builds leaves other elements behind the candidates.
        for step in 0..4 {
            let positions = moved(&start, 0.2 * f64::from(step));
            let base = ForceFieldOptions {
                truncation: TruncationOptions::new(TruncationKind::Cut, 3.5),
                ..ForceFieldOptions::default()
            };
            let (wanted, totals) = reference(&base, cell, &positions);
            for kernel in kernels() {
                let options = ForceFieldOptions {
                    kernel,
                    neighbor: verlet(Some(0.5)),
                    ..base
                };
                let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
                let (found, energetics) = all(&mut forces, cell, &positions, want_each());
                assert_eq!(energetics.pairs, totals.pairs, "{side} σ, {kernel:?}");
                for (i, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
                    let most = 1e-4 * (1.0 + wanted.length());
                    let apart = (*found - *wanted).length();
                    assert!(apart < most, "{side} σ, {kernel:?}, particle {i}: {apart}");
                }
            }
        }
    }
}

#[test]
fn forces_have_the_same_bits_with_and_without_energetics() {
    let (cell, positions) = liquid([8, 8, 8], 0.8442, 0.15);
    for base in forms() {
        for kernel in kernels() {
            for neighbor in [
                verlet(None),
                NeighborOptions {
                    mode: ListMode::Direct,
                    skin: None,
                },
            ] {
                let options = ForceFieldOptions {
                    kernel,
                    neighbor,
                    ..base
                };
                let mut forces = build(&options, &conditions(cell, positions.len())).unwrap();
                let (plain, none) = all(&mut forces, cell, &positions, Want::NOTHING);
                assert_eq!(none, lennard_core::Energetics::default());
                for want in [Want::ENERGY, Want::TOTALS, want_each()] {
                    assert_eq!(
                        all(&mut forces, cell, &positions, want).0,
                        plain,
                        "{options:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_same_bits_come_from_any_number_of_threads() {
    // Few particles, with one copy per thread, and many. Lists are built again on the way.
    for (sides, many) in [([12, 11, 10], false), ([14, 13, 12], true)] {
        let (cell, start) = liquid(sides, 0.8442, 0.15);
        assert_eq!(start.len() > 2048, many);
        for kernel in kernels() {
            let run = || {
                let options = ForceFieldOptions {
                    kernel,
                    ..ForceFieldOptions::default()
                };
                let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
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
                assert!(
                    in_threads(threads, run) == one,
                    "{threads} threads, {kernel:?}"
                );
            }
        }
    }
}

#[test]
fn forces_add_up_to_zero() {
    let (cell, positions) = liquid([10, 10, 10], 0.8442, 0.2);
    for kernel in kernels() {
        let options = ForceFieldOptions {
            kernel,
            ..ForceFieldOptions::default()
        };
        let mut forces = build(&options, &conditions(cell, positions.len())).unwrap();
        let (f, _) = all(&mut forces, cell, &positions, Want::NOTHING);
        let size: f64 = magnitudes(&options, cell, &positions)
            .iter()
            .map(|m| m.0)
            .sum();
        // A full list computes each pair twice: antisymmetric to the bit, but summed in other orders.
        let bound = match kernel.precision {
            Precision::Double => 1e-15 * size,
            // Each particle's force is rounded on its own: 6e-8 times a factor of 13 of r⁻¹³, in quadrature.
            Precision::Mixed => 8e-7 * size / (f.len() as f64).sqrt(),
        };
        let total = f.iter().sum::<DVec3>();
        assert!(
            total.length() <= bound,
            "{kernel:?}: {total} over {bound:e}"
        );
    }
}

#[test]
fn mixed_precision_does_not_suffer_far_from_the_origin() {
    let (cell, positions) = liquid([9, 9, 9], 0.8442, 0.15);
    let far: Vec<DVec3> = positions
        .iter()
        .map(|r| *r + DVec3::new(1e4, -1e4, 1e4))
        .collect();
    let options = ForceFieldOptions::default();
    let (wanted, _) = reference(&options, cell, &far);
    let rms = (wanted.iter().map(|f| f.length_squared()).sum::<f64>() / wanted.len() as f64).sqrt();
    for kernel in kernels() {
        let options = ForceFieldOptions { kernel, ..options };
        let mut forces = build(&options, &conditions(cell, far.len())).unwrap();
        let (found, _) = all(&mut forces, cell, &far, Want::NOTHING);
        let squares: f64 = found
            .iter()
            .zip(&wanted)
            .map(|(a, b)| (*a - *b).length_squared())
            .sum();
        let error = (squares / wanted.len() as f64).sqrt() / rms;
        // Double: the last place of 1e4 is 2e-12, times a stiffness some 30 times the force.
        let limit = match kernel.precision {
            Precision::Double => 2e-10,
            Precision::Mixed => 3e-6,
        };
        assert!(error <= limit, "{kernel:?}: {error:e}");
    }
}

#[test]
fn canonical_forces_are_a_pure_function_of_the_positions() {
    let (cell, start) = liquid([9, 8, 8], 0.8442, 0.15);
    let target = moved(&start, 0.1);
    let bits = |skin: Option<f64>, mode, threads, before: &[DVec3]| {
        let options = ForceFieldOptions {
            canonical: true,
            neighbor: NeighborOptions { mode, skin },
            ..ForceFieldOptions::default()
        };
        in_threads(threads, || {
            let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
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
    let small: Vec<DVec3> = small
        .iter()
        .map(|r| cell.wrap((*r * 1024.0).round() / 1024.0))
        .collect();
    let shifted: Vec<DVec3> = small
        .iter()
        .enumerate()
        .map(|(i, r)| *r + 8.0 * DVec3::new(i as f64 % 3.0, -(i as f64 % 5.0), 1.0))
        .collect();
    let options = ForceFieldOptions {
        canonical: true,
        ..ForceFieldOptions::default()
    };
    let mut forces = build(&options, &conditions(cell, small.len())).unwrap();
    let a = all(&mut forces, cell, &small, Want::NOTHING).0;
    assert!(a == all(&mut forces, cell, &shifted, Want::NOTHING).0);
}

#[test]
fn near_and_far_parts_add_up_to_the_whole_force() {
    let (cell, start) = liquid([9, 8, 8], 0.8442, 0.15);
    let positions = moved(&start, 0.1);
    for base in forms() {
        let r_cut = Model::new(&base.potential, &base.truncation).unwrap().r_cut;
        for kernel in kernels() {
            for mode in [ListMode::Verlet, ListMode::Direct] {
                let options = ForceFieldOptions {
                    kernel,
                    neighbor: NeighborOptions { mode, skin: None },
                    split: Some(SplitOptions {
                        r_split: 0.7 * r_cut,
                        width: 0.15 * r_cut,
                    }),
                    ..base
                };
                let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
                assert!(forces.properties().splits);
                for part in [Part::Near, Part::Far, Part::All] {
                    evaluate(&mut forces, cell, &start, part, Want::NOTHING).unwrap();
                }
                let get = |forces: &mut PairForces, part| {
                    evaluate(forces, cell, &positions, part, Want::TOTALS).unwrap()
                };
                let (near, e_near) = get(&mut forces, Part::Near);
                let (far, e_far) = get(&mut forces, Part::Far);
                let (whole, e_all) = get(&mut forces, Part::All);
                let relative = match kernel.precision {
                    Precision::Double => 1e-13,
                    Precision::Mixed => 1e-5,
                };
                let sizes = magnitudes(&base, cell, &positions);
                for (((n, f), w), (size, _)) in near.iter().zip(&far).zip(&whole).zip(&sizes) {
                    assert!((*n + *f - *w).length() <= relative * size, "{options:?}");
                }
                let sum = e_near.plus(&e_far);
                let size: f64 = sizes.iter().map(|s| s.0).sum();
                for (a, b) in [
                    (sum.potential_energy, e_all.potential_energy),
                    (sum.conserved_potential, e_all.conserved_potential),
                    (sum.scalar_virial(), e_all.scalar_virial()),
                ] {
                    let (a, b) = (a.unwrap(), b.unwrap());
                    assert!(
                        (a - b).abs() <= relative * size,
                        "{options:?}: {a} {b} of {size}"
                    );
                }
                assert_eq!(sum.pairs, e_all.pairs);
                assert!(near.iter().any(|n| n.length() > 0.0));
                if base.potential == (PotentialOptions::default()) {
                    assert!(far.iter().any(|f| f.length() > 1e-3));
                }
            }
        }
    }
    let mut whole = build(
        &ForceFieldOptions::default(),
        &conditions(cell, start.len()),
    )
    .unwrap();
    assert_eq!(
        evaluate(&mut whole, cell, &start, Part::Near, Want::NOTHING).unwrap_err(),
        ForceError::NotSplit
    );
}

#[test]
fn a_restart_continues_with_the_same_bits() {
    let (cell, start) = liquid([9, 8, 8], 0.8442, 0.15);
    for kernel in kernels() {
        let options = ForceFieldOptions {
            kernel,
            neighbor: verlet(Some(0.4)),
            split: Some(SplitOptions {
                r_split: 1.6,
                width: 0.3,
            }),
            ..ForceFieldOptions::default()
        };
        let at = conditions(cell, start.len());
        let parts = [Part::All, Part::Near, Part::Far];
        let mut one = build(&options, &at).unwrap();
        for part in parts {
            evaluate(&mut one, cell, &start, part, Want::NOTHING).unwrap();
        }
        let mut archive = StateArchive::default();
        one.save(&mut archive.writer());
        let mut other = build(&options, &at).unwrap();
        other.restore(&archive.reader()).unwrap();
        let later = moved(&start, 0.15);
        for part in parts {
            let a = evaluate(&mut one, cell, &later, part, Want::TOTALS).unwrap();
            let b = evaluate(&mut other, cell, &later, part, Want::TOTALS).unwrap();
            assert!(a == b, "{part:?}");
        }
        let (a, b) = (one.statistics(), other.statistics());
        assert_eq!((a.builds, a.evaluations), (b.builds, b.evaluations));
        // New forces build their list at other positions and sum in another order.
        let mut fresh = build(&options, &at).unwrap();
        let a = all(&mut one, cell, &later, Want::NOTHING).0;
        assert!(
            a != all(&mut fresh, cell, &later, Want::NOTHING).0,
            "the test can tell orders apart"
        );
    }
}

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
        start
            .iter()
            .enumerate()
            .map(|(k, r)| *r + push(k))
            .collect()
    };
    for precision in [Precision::Double, Precision::Mixed] {
        let options = ForceFieldOptions {
            potential: PotentialOptions::SoftSphere(SoftSphere { exponent: 4 }),
            kernel: KernelOptions {
                precision,
                ..KernelOptions::default()
            },
            neighbor: verlet(Some(0.25)),
            ..ForceFieldOptions::default()
        };
        let at = conditions(cell, n);
        let mut forces = build(&options, &at).unwrap();
        all(&mut forces, cell, &start, Want::NOTHING);
        for most in [0.13, 0.2, 0.36] {
            let later = moved(most);
            let f = all(&mut forces, cell, &later, Want::NOTHING).0;
            let expected = all(
                &mut build(&options, &at).unwrap(),
                cell,
                &later,
                Want::NOTHING,
            )
            .0;
            // Rounding may decide at the very cutoff, where the force jumps by 0.04.
            let differ = |i: &usize| (f[*i] - expected[*i]).length() > 0.02;
            for i in (0..n).filter(differ) {
                let r = |j: &DVec3| cell.minimum_image(later[i] - *j).length();
                let at_the_cutoff = later.iter().any(|j| (r(j) - 2.5).abs() < 1e-6);
                assert!(at_the_cutoff, "particle {i}, {precision:?}, {most}");
            }
        }
        if precision == Precision::Mixed {
            assert_eq!(
                forces.statistics().builds,
                1,
                "the missing pairs were inserted"
            );
        }
    }
}

#[test]
fn pairs_that_were_inserted_since_the_build_are_part_of_a_restart() {
    let (cell, start) = liquid([16, 16, 16], 0.8442, 0.15);
    // One particle in 33 moves by more than half the skin toward others.
    let push = |r: &DVec3, k: usize| {
        let direction = DVec3::from((*r * 12.9898).to_array().map(f64::sin)).normalize();
        if k.is_multiple_of(33) {
            0.295 * direction
        } else {
            -0.145 * direction
        }
    };
    let pushed = |at: &[DVec3]| -> Vec<DVec3> {
        at.iter()
            .enumerate()
            .map(|(k, r)| *r + push(r, k))
            .collect()
    };
    let later = pushed(&start);
    for kernel in kernels()
        .into_iter()
        .filter(|k| k.precision == Precision::Mixed)
    {
        let options = ForceFieldOptions {
            potential: PotentialOptions::SoftSphere(SoftSphere { exponent: 4 }),
            kernel,
            neighbor: verlet(Some(0.3)),
            ..ForceFieldOptions::default()
        };
        let at = conditions(cell, start.len());
        let mut one = build(&options, &at).unwrap();
        all(&mut one, cell, &start, Want::NOTHING);
        let (_, found) = all(&mut one, cell, &later, Want::ENERGY);
        assert_eq!(found.pairs, reference(&options, cell, &later).1.pairs);
        assert_eq!(
            one.statistics().builds,
            1,
            "the missing pairs were inserted"
        );
        let mut archive = StateArchive::default();
        one.save(&mut archive.writer());
        let (name, named) = archive
            .arrays
            .iter()
            .find(|(name, _)| name.ends_with("named"))
            .unwrap();
        let Array::U64(places) = named else {
            panic!("{named:?}")
        };
        assert!(places.len() >= 16, "{} places", places.len());

        let restored = |named: Option<Vec<u64>>| {
            let mut archive = archive.clone();
            match named {
                Some(places) => archive.arrays.insert(name.clone(), Array::U64(places)),
                None => archive.arrays.remove(name),
            };
            let mut other = build(&options, &at).unwrap();
            other.restore(&archive.reader()).map(|()| other)
        };
        // Inserted pairs decide the order of the sums, even after they have moved apart.
        let mut same = restored(Some(places.clone())).unwrap();
        let mut without = restored(None).unwrap();
        let mut differ = false;
        for share in [0.3, 0.5, 0.7, 0.8] {
            let again: Vec<DVec3> = start
                .iter()
                .zip(&later)
                .map(|(a, b)| a.lerp(*b, share))
                .collect();
            let expected = all(&mut one, cell, &again, Want::NOTHING).0;
            assert!(expected == all(&mut same, cell, &again, Want::NOTHING).0);
            differ |= expected != all(&mut without, cell, &again, Want::NOTHING).0;
        }
        assert!(differ, "{kernel:?}: inserted pairs change nothing");
        for wrong in [vec![0, 1, 2], vec![0, 4096], vec![3, 3], vec![5, 4]] {
            let error = restored(Some(wrong)).err().unwrap().to_string();
            assert!(
                error.contains("no pairs of 4096 slots that this list can take"),
                "{error}"
            );
        }
    }
}

#[test]
fn the_count_of_builds_continues_after_a_restart_from_this_version_and_the_last() {
    let (cell, start) = liquid([8, 8, 8], 0.8442, 0.1);
    let options = ForceFieldOptions {
        neighbor: verlet(Some(0.3)),
        ..ForceFieldOptions::default()
    };
    let at = conditions(cell, start.len());
    let mut forces = build(&options, &at).unwrap();
    all(&mut forces, cell, &start, Want::NOTHING);
    let mut archive = StateArchive::default();
    forces.save(&mut archive.writer());
    assert_eq!(archive.arrays["list/counters"], Array::U64(vec![1]));
    for wrong in [vec![], vec![cell.lengths(); 2], vec![DVec3::NEG_ONE]] {
        let said = match wrong[..] {
            [_] => "`list/built_box` does not fit: a box side must be".to_owned(),
            _ => format!(
                "`list/built_box` does not fit: {} boxes, wanted 1",
                wrong.len()
            ),
        };
        let mut archive = archive.clone();
        archive
            .arrays
            .insert("list/built_box".into(), Array::Vec3(wrong));
        let mut other = build(&options, &at).unwrap();
        let error = other.restore(&archive.reader()).unwrap_err().to_string();
        assert!(error.contains(&said), "{error}");
    }
    let mut restored = |counters: &[u64]| {
        let counters = Array::U64(counters.to_vec());
        archive.arrays.insert("list/counters".into(), counters);
        let mut other = build(&options, &at).unwrap();
        let found = other.restore(&archive.reader());
        found.map(|()| other.statistics().builds)
    };
    assert_eq!(restored(&[7]).unwrap(), 7);
    assert_eq!(restored(&[7, 0]).unwrap(), 7);
    for wrong in [&[][..], &[1, 2, 3]] {
        let error = restored(wrong).unwrap_err().to_string();
        let said = format!(
            "`list/counters` does not fit: {} numbers, wanted 1",
            wrong.len()
        );
        assert!(error.contains(&said), "{error}");
    }
}

#[test]
fn a_number_that_is_not_finite_is_an_error_that_names_the_particle() {
    let (cell, start) = liquid([8, 8, 8], 0.8442, 0.1);
    let mut strategies: Vec<ForceFieldOptions> = kernels()
        .into_iter()
        .map(|kernel| ForceFieldOptions {
            kernel,
            neighbor: verlet(None),
            ..ForceFieldOptions::default()
        })
        .collect();
    let base = ForceFieldOptions::default();
    strategies.push(ForceFieldOptions {
        canonical: true,
        ..base
    });
    strategies.push(ForceFieldOptions {
        neighbor: NeighborOptions {
            mode: ListMode::Direct,
            skin: None,
        },
        ..base
    });
    strategies.push(ForceFieldOptions {
        kernel: KernelOptions {
            kernel: Kernel::Reference,
            ..KernelOptions::default()
        },
        ..base
    });
    for options in strategies {
        for warm in [false, true] {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
                if warm {
                    all(&mut forces, cell, &start, Want::NOTHING);
                }
                let mut positions = start.clone();
                positions[137].y = bad;
                for threads in [1, 3] {
                    let error = in_threads(threads, || {
                        evaluate(&mut forces, cell, &positions, Part::All, Want::NOTHING)
                    });
                    assert_eq!(
                        error.unwrap_err(),
                        ForceError::NonFinitePosition { particle: 137 }
                    );
                }
            }
            // Far away is no reason to hang, to panic or to read elsewhere.
            for far in [1e6, -1e9, 1e15, 1e300, -1.7e308] {
                let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
                if warm {
                    all(&mut forces, cell, &start, Want::NOTHING);
                }
                let mut positions = start.clone();
                positions[5].x = far;
                let _ = evaluate(&mut forces, cell, &positions, Part::All, Want::TOTALS);
            }
            let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
            if warm {
                all(&mut forces, cell, &start, Want::NOTHING);
            }
            let mut positions = start.clone();
            positions[200] = positions[33];
            let error = evaluate(&mut forces, cell, &positions, Part::All, Want::NOTHING);
            assert_eq!(
                error.unwrap_err(),
                ForceError::NonFiniteForce { particle: 33 },
                "{options:?}"
            );
            // The forces are usable again.
            all(&mut forces, cell, &start, Want::TOTALS);
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

/// Checks every force of a kernel against the sum over all pairs, within its tolerance.
fn one_by_one(
    options: &ForceFieldOptions,
    cell: PeriodicBox,
    positions: &[DVec3],
    found: &[DVec3],
) -> Result<(), TestCaseError> {
    let all_pairs = AllPairs::new(options).unwrap();
    for (i, f) in found.iter().enumerate() {
        let wanted = all_pairs.force_on(i, &cell, positions);
        let off = (*f - wanted.force).length();
        prop_assert!(
            off <= wanted.tolerance,
            "{options:?}: {f} against {wanted:?}"
        );
    }
    Ok(())
}

#[test]
fn the_force_that_checks_is_that_of_the_reference_and_shows_one_pair_at_a_plain_cutoff() {
    let (cell, positions) = liquid([9, 8, 7], 0.8442, 0.07);
    let far: Vec<DVec3> = positions.iter().map(|r| *r + DVec3::splat(1e4)).collect();
    for (positions, loosened) in [(&positions, 1.0), (&far, 1e3)] {
        for base in forms() {
            let (wanted, _) = reference(&base, cell, positions);
            for precision in [Precision::Double, Precision::Mixed] {
                let mut options = base;
                options.kernel.precision = precision;
                let all_pairs = AllPairs::new(&options).unwrap();
                for (i, w) in wanted.iter().enumerate() {
                    let found = all_pairs.force_on(i, &cell, positions);
                    assert!((found.force - *w).length() <= 1e-10 * (1.0 + w.length()) * loosened);
                    let is_plain = matches!(
                        base.truncation.kind,
                        TruncationKind::Cut | TruncationKind::Shift
                    );
                    if base.potential == (PotentialOptions::default()) && is_plain {
                        // F(2.5 σ) = 0.039 ε/σ.
                        let part = match precision {
                            Precision::Double => 1e-5,
                            Precision::Mixed => 0.3,
                        };
                        assert!(found.tolerance < part * 0.039, "{found:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_pair_as_near_to_the_cutoff_as_rounding_may_count_or_not_and_any_other_counts() {
    let cell = PeriodicBox::new(DVec3::splat(12.0)).unwrap();
    let options = ForceFieldOptions {
        truncation: TruncationOptions::new(TruncationKind::Shift, 2.5),
        ..ForceFieldOptions::default()
    };
    let at = |r: f64| {
        // Through a side of the box.
        let pair = [DVec3::new(11.0, 5.0, 5.0), DVec3::new(11.0 + r, 5.0, 5.0)];
        AllPairs::new(&options).unwrap().force_on(0, &cell, &pair)
    };
    for r in [2.5 - 1e-9, 2.5 + 1e-9] {
        assert!(at(r).tolerance < 1e-10, "{r}: {:?}", at(r));
    }
    assert!((at(2.5 - 1e-9).force.length() - 0.039).abs() < 1e-3);
    assert_eq!(at(2.5 + 1e-9).force, DVec3::ZERO);
    for r in [2.5 - 1e-15, 2.5, 2.5 + 1e-15] {
        assert!(at(r).tolerance > 0.038, "{r}: {:?}", at(r));
    }
}

/// A configuration of any shape: gas, liquid, a disturbed crystal, or a lump in a vacuum.
#[derive(Debug, Clone)]
struct Shape {
    n: usize,
    /// Sides of the box, in cutoffs.
    sides: [f64; 3],
    /// Skin as a share of the largest that the box allows.
    skin_share: f64,
    /// Share of each side that particles fill.
    filling: f64,
    /// Whether particles stand on a grid, and how much they are disturbed, in distances of the grid.
    crystal: Option<f64>,
    seed: f64,
    origin: f64,
}

/// Boxes from two cutoffs on, which is the smallest that there can be.
fn shapes(longest: f64) -> impl Strategy<Value = Shape> {
    let side = prop_oneof![Just(2.0), 2.0_f64..7.0, 2.0_f64..longest];
    let cube = side.clone().prop_map(|side| [side; 3]);
    let sides = prop_oneof![1 => cube, 2 => prop::array::uniform3(side)];
    let skin = prop_oneof![Just(0.0), Just(1.0), 0.0_f64..0.3, 0.0_f64..=1.0];
    let n = prop_oneof![1_usize..10, 1_usize..400];
    (
        n,
        sides,
        skin,
        0.05_f64..=1.0,
        prop::option::of(0.0_f64..0.3),
        0.0_f64..1000.0,
        -30.0_f64..30.0,
    )
        .prop_map(
            |(n, sides, skin_share, filling, crystal, seed, origin)| Shape {
                n,
                sides,
                skin_share,
                filling,
                crystal,
                seed,
                origin,
            },
        )
}

impl Shape {
    fn positions(&self, lengths: DVec3) -> Vec<DVec3> {
        let filled = lengths * self.filling;
        let random = scatter(self.n, DVec3::ONE, self.seed);
        let across = (self.n as f64).cbrt().ceil() as usize;
        let step = filled / across as f64;
        let place = |(i, random): (usize, &DVec3)| match self.crystal {
            None => *random * filled,
            Some(disturbed) => {
                let [x, y, z] = [i % across, i / across % across, i / across / across];
                (DVec3::new(x as f64, y as f64, z as f64) + disturbed * *random) * step
            }
        };
        let at = random.iter().enumerate().map(place);
        at.map(|r| r + DVec3::splat(self.origin)).collect()
    }
}

/// Rounding of coordinates relative to the cluster center, up to 3 + 2.5 σ away: twice half a unit in the last place,
/// 2.4e-7 σ each.
const SEEN: f64 = 5e-7;

/// One particle in this many moves by more than half the skin: so few that the list looks ahead of them.
const MOVED_FAR: usize = 40;

/// Compares every kernel with the reference after its list was built and the particles have moved.
///
/// They move by just under half the skin, and some of them by up to the whole skin.
fn agrees_with_the_reference(shape: &Shape) -> Result<(), TestCaseError> {
    let r_cut = 2.5;
    // A last place more: at exactly two cutoffs, rounding must not make the box too small.
    let lengths = DVec3::from(shape.sides) * r_cut * (1.0 + 1e-15);
    let cell = PeriodicBox::new(lengths).unwrap();
    let skin = (shape.skin_share * (cell.largest_cutoff() - r_cut)).max(0.0);
    let start = shape.positions(lengths);
    let near = moved(&start, 0.49 * skin);
    agrees_there(shape.n, cell, skin, (&start, &near), true)?;
    let mut far = near;
    for (k, place) in (0..shape.n).step_by(MOVED_FAR).skip(1).enumerate() {
        let share = 0.9 + 0.02 * (k % 5) as f64;
        far[place] = moved(&start, share * skin)[place];
    }
    agrees_there(shape.n, cell, skin, (&start, &far), false)
}

/// Compares the kernels after a move from `start` to `positions`; `lasts` says whether the list must last that long.
fn agrees_there(
    n: usize,
    cell: PeriodicBox,
    skin: f64,
    (start, positions): (&[DVec3], &[DVec3]),
    lasts: bool,
) -> Result<(), TestCaseError> {
    let r_cut = 2.5;
    let lengths = cell.lengths();
    // A soft potential: random positions overlap.
    let potential = PotentialOptions::SoftSphere(SoftSphere { exponent: 4 });
    let judged = |kind| {
        let base = ForceFieldOptions {
            potential,
            truncation: TruncationOptions::new(kind, r_cut),
            neighbor: verlet(Some(skin)),
            ..ForceFieldOptions::default()
        };
        let sizes = magnitudes(&base, cell, positions);
        (base, reference(&base, cell, positions), sizes)
    };
    // Fixed-point coordinates can carry a pair across the cutoff, where a shifted potential's force jumps
    // by more than any rounding: mixed precision is judged where the force ends at zero.
    let sharp = judged(TruncationKind::Shift);
    let smooth = judged(TruncationKind::ForceShift);
    // Last places of coordinates, and of fixed point in the longest side.
    let (place, unit) = (2e-15 * lengths.max_element(), 1e-9 * lengths.max_element());
    for kernel in kernels() {
        let (base, (wanted, totals), sizes) = match kernel.precision {
            Precision::Double => &sharp,
            Precision::Mixed => &smooth,
        };
        let options = ForceFieldOptions { kernel, ..*base };
        let mut forces = build(&options, &conditions(cell, n)).unwrap();
        all(&mut forces, cell, start, Want::NOTHING);
        let (found, energetics) = all(&mut forces, cell, positions, Want::ENERGY);
        one_by_one(&options, cell, positions, &found)?;
        let (options_sharp, found_sharp) = {
            let options = ForceFieldOptions { kernel, ..sharp.0 };
            let mut forces = build(&options, &conditions(cell, n)).unwrap();
            (options, all(&mut forces, cell, positions, Want::NOTHING).0)
        };
        one_by_one(&options_sharp, cell, positions, &found_sharp)?;
        if lasts && skin > 1e-9 {
            prop_assert_eq!(forces.statistics().builds, 1);
        }
        if kernel.precision == Precision::Double {
            prop_assert_eq!(energetics.pairs, totals.pairs);
        }
        for ((f, w), (size, stiffness)) in found.iter().zip(wanted).zip(sizes) {
            let bound = match kernel.precision {
                Precision::Double => 1e-13 * size + (1e-13 + place) * stiffness,
                Precision::Mixed => 1e-6 * size + (SEEN + unit) * stiffness + 1e-6,
            };
            prop_assert!(
                (*f - *w).length() <= bound,
                "{:?}: {} against {}, bound {:e}",
                options,
                f,
                w,
                bound
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    #[ignore = "a hundred thousand configurations take some minutes: cargo xtask physics"]
    fn a_hundred_thousand_shapes_agree_with_the_reference(shape in shapes(20.0)) {
        agrees_with_the_reference(&shape)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_shape_agrees_with_the_reference(shape in shapes(20.0)) {
        agrees_with_the_reference(&shape)?;
    }

    #[test]
    fn forces_do_not_depend_on_the_skin_the_order_or_the_place(
        skin in 0.0_f64..1.0,
        shift in prop::array::uniform3(-50.0_f64..50.0),
        stride in 1_usize..500,
    ) {
        let (cell, positions) = liquid([8, 8, 8], 0.8442, 0.15);
        let n = positions.len();
        // A permutation: multiplication by an odd number modulo 512.
        let order: Vec<usize> = (0..n).map(|i| i * (2 * stride + 1) % n).collect();
        let moved: Vec<DVec3> = order.iter().map(|i| positions[*i] + DVec3::from(shift)).collect();
        for kernel in kernels() {
            let get = |skin, at: &[DVec3]| {
                let options = ForceFieldOptions { kernel, neighbor: verlet(Some(skin)), ..ForceFieldOptions::default() };
                all(&mut build(&options, &conditions(cell, n)).unwrap(), cell, at, Want::NOTHING).0
            };
            let wanted = get(0.3, &positions);
            let sizes = magnitudes(&ForceFieldOptions::default(), cell, &positions);
            // Double: shifted coordinates of 60 σ have a last place of 7e-15 each.
            let (relative, here, absolute) = match kernel.precision {
                Precision::Double => (1e-14, 0.0, 2e-14),
                Precision::Mixed => (1e-6, SEEN, SEEN),
            };
            for (i, (a, b)) in get(skin, &positions).iter().zip(&wanted).enumerate() {
                prop_assert!((*a - *b).length() <= relative * sizes[i].0 + here * sizes[i].1);
            }
            for (k, f) in get(skin, &moved).iter().enumerate() {
                let i = order[k];
                let bound = relative * sizes[i].0 + absolute * sizes[i].1;
                prop_assert!((*f - wanted[i]).length() <= bound, "{} against {}", f, wanted[i]);
            }
        }
    }
}
