use super::*;
use crate::testing::{
    column, context, estimate, fcc, mixture, normal, random_positions, shuffled, view_of,
};
use lennard_core::{DVec3, Own, PeriodicBox};

#[test]
fn an_ideal_gas_scatters_with_one_at_every_wave_number() {
    let context = context(6.0, 100);
    let mut factor = StructureFactor::new(&StructureFactorOptions::default(), &context).unwrap();
    for seed in 0..300 {
        view_of(&context.cell, random_positions(100, 6.0, seed), |view| {
            factor.sample(view);
        });
    }
    let table = &factor.finish(0.0).tables[0];
    let columns = |k: usize| table.columns[k].numbers();
    assert!(columns(0).len() > 40);
    let chi2: f64 = columns(1).iter().zip(columns(2)).map(|(s, e)| ((s - 1.0) / e).powi(2)).sum();
    // χ² over the shells: mean their number m, deviation √(2m); errors from some 40 blocks widen it.
    let m = columns(0).len() as f64;
    assert!((chi2 - m).abs() < 5.0 * (2.0 * m).sqrt(), "{chi2} of {m}");
}

#[test]
fn a_face_centred_lattice_scatters_with_n_at_its_reciprocal_vectors_and_nothing_elsewhere() {
    // Four unit cells a side: a multiple of 4 is a reciprocal vector of the simple cubic lattice; face
    // centring keeps all even or all odd.
    let (cell, positions) = fcc(4, 1.1);
    let n = positions.len();
    let context = BuildContext { cell, n_atoms: n, ..context(1.0, 1) };
    let options = StructureFactorOptions { k_max: 16.0, shells: 60, directions: 800 };
    let factor = StructureFactor::new(&options, &context).unwrap();
    let mut seen = 0;
    let found = factor.vectors.densities(&Own::all_of(positions.len()), &positions, &context.cell);
    for (v, density) in factor.vectors.iter().zip(found) {
        let s = density.length_squared() / n as f64;
        let cubic = v.multiples.iter().all(|m| m % 4 == 0);
        let [h, k, l] = v.multiples.map(|m| (m / 4).rem_euclid(2));
        let bragg = cubic && h == k && k == l;
        seen += usize::from(bragg);
        let exact = if bragg { n as f64 } else { 0.0 };
        // Multiples up to 20 amplify rounding 2⁻⁵³·20 in each of 256 phases.
        assert!((s - exact).abs() < 1e-9 * n as f64, "{v:?}: {s}");
    }
    assert!(seen > 5, "{seen}");
}

#[test]
fn a_negative_multiple_is_summed_as_the_plain_definition_has_it() {
    let context = context(6.0, 30);
    let factor = StructureFactor::new(&StructureFactorOptions::default(), &context).unwrap();
    let positions: Vec<DVec3> =
        random_positions(30, 6.0, 3).into_iter().map(|r| r + DVec3::new(12.0, -6.0, 0.0)).collect();
    let found = factor.vectors.densities(&Own::all_of(positions.len()), &positions, &context.cell);
    assert!(factor.vectors.iter().any(|v| v.multiples[2] < 0));
    for (v, density) in factor.vectors.iter().zip(found) {
        let [re, im] = density.to_array();
        let k = glam::IVec3::from_array(v.multiples).as_dvec3() * (2.0 * PI / 6.0);
        let (c, s) = positions.iter().fold((0.0, 0.0), |(c, s), r| {
            let (sin, cos) = (-k.dot(*r)).sin_cos();
            (c + cos, s + sin)
        });
        assert!((re - c).abs() < 1e-11 && (im - s).abs() < 1e-11);
    }
}

#[test]
fn in_a_box_that_changes_wave_vectors_go_with_it() {
    // A lattice blown up by 4 % has the same factors at wave numbers smaller by as much.
    let (cell, positions) = fcc(3, 1.1);
    let context = BuildContext { cell, n_atoms: positions.len(), ..context(1.0, 1) };
    let measured = |scale: f64| {
        let mut factor =
            StructureFactor::new(&StructureFactorOptions::default(), &context).unwrap();
        let cell = PeriodicBox::new(scale * cell.lengths()).unwrap();
        let scaled = positions.iter().map(|r| scale * *r).collect();
        view_of(&cell, scaled, |view| factor.sample(view));
        let table = factor.finish(0.0).tables.swap_remove(0);
        [0, 1].map(|k| table.columns[k].numbers())
    };
    let ([k, s], [wider_k, wider_s]) = (measured(1.0), measured(1.04));
    for i in 0..k.len() {
        assert!((wider_k[i] * 1.04 / k[i] - 1.0).abs() < 1e-12);
        assert!((wider_s[i] - s[i]).abs() < 1e-6);
    }
}

/// The factors of a face-centred lattice with noise, in which `of` tells the species of each place and `order` the particles.
fn factors_of_mixture(
    of: impl Fn(usize) -> usize,
    order: impl Fn(Vec<DVec3>, u64) -> Vec<DVec3>,
) -> Findings {
    let (cell, lattice) = fcc(4, 1.1);
    let n = lattice.len();
    let context = BuildContext { cell, n_atoms: n, species: mixture(n, of), ..context(1.0, 1) };
    let mut factor = StructureFactor::new(&StructureFactorOptions::default(), &context).unwrap();
    for seed in 0..200 {
        let places = lattice.iter().enumerate();
        let moved = places.map(|(i, r)| *r + 0.15 * normal(5, seed, i)).collect();
        view_of(&cell, order(moved, seed), |view| factor.sample(view));
    }
    factor.finish(0.0)
}

#[test]
fn in_a_mixture_of_names_concentration_fluctuates_as_in_an_ideal_mixture() {
    let findings = factors_of_mixture(|i| usize::from(i % 5 == 0), |r, seed| shuffled(&r, seed));
    let column = |name: &str| column(&findings, name);
    let (all, mixed, error) =
        (column("structure_factor"), column("structure_factor_CC"), column("standard_error_CC"));
    let (cross, cross_error) = (column("structure_factor_NC"), column("standard_error_NC"));
    let n = 256.0;
    let x = 52.0 / n;
    let (mut chi2, mut chi2_cross) = (0.0, 0.0);
    for k in 0..all.len() {
        // Labels drawn without putting back: x₁x₂·(N − S)/(N − 1).
        let exact = x * (1.0 - x) * (n - all[k]) / (n - 1.0);
        chi2 += ((mixed[k] - exact) / error[k]).powi(2);
        chi2_cross += (cross[k] / cross_error[k]).powi(2);
    }
    // Mean m, deviation √(2m); errors from some 50 blocks widen it.
    let m = all.len() as f64;
    for chi2 in [chi2, chi2_cross] {
        assert!((chi2 - m).abs() < 6.0 * (2.0 * m).sqrt(), "{chi2} of {m}");
    }
    let found = estimate(&findings, "concentration_fluctuations");
    assert!((found.mean - 1.0).abs() < 4.0 * found.standard_error && found.standard_error < 0.2);
    assert!(!findings.remarks_in_words().contains("gather"));
}

#[test]
fn factors_of_species_make_up_the_factors_of_number_and_concentration() {
    let findings = factors_of_mixture(|i| usize::from(i % 3 == 0), |r, _| r);
    let column = |name: &str| column(&findings, name);
    let x = [170.0 / 256.0, 86.0 / 256.0];
    let root = f64::sqrt(x[0] * x[1]);
    let (a, ab, b) = (
        column("structure_factor_A_A"),
        column("structure_factor_A_B"),
        column("structure_factor_B_B"),
    );
    let (all, cross, mixed) =
        (column("structure_factor"), column("structure_factor_NC"), column("structure_factor_CC"));
    for k in 0..all.len() {
        let [s, t] = x;
        let number = s * a[k] + t * b[k] + 2.0 * root * ab[k];
        let mixture = s * t * (t * a[k] + s * b[k] - 2.0 * root * ab[k]);
        let both = s * t * (a[k] - b[k] + (t - s) / root * ab[k]);
        let scale = 1e-11 * (1.0 + all[k]);
        assert!((all[k] - number).abs() < scale, "{k}");
        assert!((mixed[k] - mixture).abs() < scale, "{k}");
        assert!((cross[k] - both).abs() < scale, "{k}");
    }
}

#[test]
fn species_that_have_parted_are_told() {
    // The lattice is filled from one side to the other: half of the box is A.
    let findings = factors_of_mixture(|i| usize::from(i >= 128), |r, _| r);
    let said = findings.remarks_in_words();
    assert!(said.contains("the species gather: over 6.2 σ"), "{said}");
}
