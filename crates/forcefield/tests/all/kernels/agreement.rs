//! Every loop agrees with the reference loop.

use super::*;

#[test]
fn every_kernel_agrees_with_the_reference_after_the_particles_have_moved() {
    // Boxes as long along all axes are not stretched to σ in mixed precision.
    for cells in [[9, 8, 7], [8; 3]] {
        agree_after_a_move(cells, 1, forms());
    }
}

#[test]
fn every_kernel_agrees_with_the_reference_in_mixtures() {
    agree_after_a_move([9, 8, 7], 3, forms());
    // Other numbers of species take the same loops over other tables, which many species make dear.
    for (cells, species) in [([8; 3], 2), ([7; 3], lennard_core::MOST_SPECIES)] {
        agree_after_a_move(cells, species, some_forms(species));
    }
}

/// More pairs than a particle of the liquid has.
const MOST_PAIRS: f64 = 100.0;

/// The forms that loops compile in, and a few of the others: loops sum these from rows, whatever the form.
fn some_forms(species: usize) -> Vec<ForceFieldOptions> {
    let mut some = forms();
    let mut of_rows = 0;
    some.retain(|form| {
        let is_of_rows = off_by_rows(form, species) > 0.0;
        of_rows += usize::from(is_of_rows);
        !is_of_rows || of_rows % 4 == 1
    });
    some
}

fn agree_after_a_move(cells: [usize; 3], species: usize, forms: Vec<ForceFieldOptions>) {
    let (cell, start) = liquid(cells, 0.8442, 0.15);
    let positions = moved(&start, 0.1);
    for base in forms {
        let mixture = mixture_or_one(species, base.truncation.r_cut, start.len());
        let mixture = mixture.as_ref();
        let (wanted, totals) = reference_of(&base, mixture, cell, &positions);
        let sizes = magnitudes_of(&base, mixture, cell, &positions);
        let rms =
            (wanted.iter().map(|f| f.length_squared()).sum::<f64>() / wanted.len() as f64).sqrt();
        let rows = off_by_rows(&base, species);
        for kernel in kernels() {
            let options = ForceFieldOptions { kernel, neighbor: verlet(Some(0.3)), ..base };
            let mut forces = built(&options, mixture, cell, start.len());
            all(&mut forces, cell, &start, Want::NOTHING);
            let (found, energetics) = all(&mut forces, cell, &positions, want_each());
            assert_eq!(forces.statistics().builds, 1, "the list was used after a move");
            one_by_one(&options, mixture, cell, &positions, &found)
                .unwrap_or_else(|e| panic!("{e}"));
            let mut squares = 0.0;
            for ((f, w), (size, stiffness)) in found.iter().zip(&wanted).zip(&sizes) {
                if kernel.precision == Precision::Double {
                    // Rounding of the sums, and of coordinates of some 10 σ through the stiffness.
                    let bound = 1e-13 * size + 8e-15 * stiffness + rows * (size + MOST_PAIRS);
                    assert!((*f - *w).length() <= bound, "{options:?}: {f} against {w}");
                }
                squares += (*f - *w).length_squared();
            }
            let error = (squares / wanted.len() as f64).sqrt() / rms;
            let (limit, relative) = match kernel.precision {
                Precision::Double => (1e-14 + rows, 1e-13 + 10.0 * rows),
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
            let traces = [&energetics, &totals].map(|e| e.scalar_virial().unwrap());
            assert!(
                (traces[0] - traces[1]).abs() <= relative * strength,
                "{options:?}: {traces:?} of {strength:e}"
            );
            let difference = energetics.virial.unwrap() - totals.virial.unwrap();
            let worst = difference.to_cols_array().map(f64::abs).into_iter().fold(0.0, f64::max);
            assert!(worst <= relative * strength, "{options:?}: {worst:e} of {strength:e}");
            let stiffness: f64 = sizes.iter().map(|s| s.1).sum();
            assert!(
                (energetics.laplacian.unwrap() - totals.laplacian.unwrap()).abs()
                    <= (relative + 1e3 * rows) * stiffness
            );
            let mine = energetics.per_particle.unwrap();
            for ((u, w), (u0, w0)) in mine.iter().zip(totals.per_particle.as_ref().unwrap()) {
                assert!((u - u0).abs() <= 30.0 * relative * (1.0 + u0.abs()));
                let d = (*w - *w0).to_cols_array().map(f64::abs).into_iter().fold(0.0, f64::max);
                assert!(d <= 30.0 * relative * (1.0 + strength / mine.len() as f64), "{d}");
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
                let options = ForceFieldOptions { kernel, neighbor: verlet(Some(0.5)), ..base };
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
fn forces_add_up_to_zero() {
    let (cell, positions) = liquid([10, 10, 10], 0.8442, 0.2);
    for kernel in kernels() {
        let options = ForceFieldOptions { kernel, ..ForceFieldOptions::default() };
        let mut forces = build(&options, &conditions(cell, positions.len())).unwrap();
        let (f, _) = all(&mut forces, cell, &positions, Want::NOTHING);
        let size: f64 = magnitudes(&options, cell, &positions).iter().map(|m| m.0).sum();
        // A full list computes each pair twice: antisymmetric to the bit, but summed in other orders.
        let bound = match kernel.precision {
            Precision::Double => 1e-15 * size,
            // Each particle's force is rounded on its own: 6e-8 times a factor of 13 of r⁻¹³, in quadrature.
            Precision::Mixed => 8e-7 * size / (f.len() as f64).sqrt(),
        };
        let total = f.iter().sum::<DVec3>();
        assert!(total.length() <= bound, "{kernel:?}: {total} over {bound:e}");
    }
}

#[test]
fn mixed_precision_does_not_suffer_far_from_the_origin() {
    let (cell, positions) = liquid([9, 9, 9], 0.8442, 0.15);
    let far: Vec<DVec3> = positions.iter().map(|r| *r + DVec3::new(1e4, -1e4, 1e4)).collect();
    let options = ForceFieldOptions::default();
    let (wanted, _) = reference(&options, cell, &far);
    let rms = (wanted.iter().map(|f| f.length_squared()).sum::<f64>() / wanted.len() as f64).sqrt();
    for kernel in kernels() {
        let options = ForceFieldOptions { kernel, ..options };
        let mut forces = build(&options, &conditions(cell, far.len())).unwrap();
        let (found, _) = all(&mut forces, cell, &far, Want::NOTHING);
        let squares: f64 = found.iter().zip(&wanted).map(|(a, b)| (*a - *b).length_squared()).sum();
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
fn near_and_far_parts_add_up_to_the_whole_force() {
    parts_add_up_to_the_whole_force(1, ListMode::Verlet, forms());
    // Loops over all pairs and over species take the rows of a form as the lists do.
    parts_add_up_to_the_whole_force(2, ListMode::Verlet, some_forms(2));
    for species in [1, 2] {
        parts_add_up_to_the_whole_force(species, ListMode::Direct, some_forms(species));
    }
    let (cell, start) = liquid([9, 8, 8], 0.8442, 0.15);
    let mut whole = build(&ForceFieldOptions::default(), &conditions(cell, start.len())).unwrap();
    assert_eq!(
        evaluate(&mut whole, cell, &start, Part::Near, Want::NOTHING).unwrap_err(),
        ForceError::NotSplit
    );
}

fn parts_add_up_to_the_whole_force(species: usize, mode: ListMode, forms: Vec<ForceFieldOptions>) {
    let (cell, start) = liquid([9, 8, 8], 0.8442, 0.15);
    let positions = moved(&start, 0.1);
    for base in forms {
        let r_cut = Model::new(&base.potential, &base.truncation).unwrap().r_cut;
        let mixture = mixture_or_one(species, base.truncation.r_cut, start.len());
        let mixture = mixture.as_ref();
        let sizes = magnitudes_of(&base, mixture, cell, &positions);
        for kernel in kernels() {
            let options = ForceFieldOptions {
                kernel,
                neighbor: NeighborOptions { mode, skin: None },
                split: Some(SplitOptions { r_split: 0.7 * r_cut, width: 0.15 * r_cut }),
                ..base
            };
            let mut forces = built(&options, mixture, cell, start.len());
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
                assert!((a - b).abs() <= relative * size, "{options:?}: {a} {b} of {size}");
            }
            assert_eq!(sum.pairs, e_all.pairs);
            assert!(near.iter().any(|n| n.length() > 0.0));
            if base.potential == (PotentialOptions::default()) {
                assert!(far.iter().any(|f| f.length() > 1e-3));
            }
        }
    }
}
