use super::*;
use crate::testing::{context, fcc, random_positions, view_of};

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
    let chi2: f64 = columns(1)
        .iter()
        .zip(columns(2))
        .map(|(s, e)| ((s - 1.0) / e).powi(2))
        .sum();
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
    let context = BuildContext {
        cell,
        n_atoms: n,
        ..context(1.0, 1)
    };
    let options = StructureFactorOptions {
        k_max: 16.0,
        shells: 60,
        directions: 800,
    };
    let factor = StructureFactor::new(&options, &context).unwrap();
    let mut seen = 0;
    for (v, [re, im]) in factor
        .vectors
        .iter()
        .zip(factor.densities(&positions, &context.cell))
    {
        let s = (re * re + im * im) / n as f64;
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
    let positions: Vec<DVec3> = random_positions(30, 6.0, 3)
        .into_iter()
        .map(|r| r + DVec3::new(12.0, -6.0, 0.0))
        .collect();
    let found = factor.densities(&positions, &context.cell);
    assert!(factor.vectors.iter().any(|v| v.multiples[2] < 0));
    for (v, [re, im]) in factor.vectors.iter().zip(found) {
        let k = glam::IVec3::from_array(v.multiples).as_dvec3() * (2.0 * PI / 6.0);
        let (c, s) = positions.iter().fold((0.0, 0.0), |(c, s), r| {
            let (sin, cos) = (-k.dot(*r)).sin_cos();
            (c + cos, s + sin)
        });
        assert!((re - c).abs() < 1e-11 && (im - s).abs() < 1e-11);
    }
}

#[test]
fn a_range_without_a_wave_vector_is_refused() {
    let options = StructureFactorOptions {
        k_max: 0.1,
        ..StructureFactorOptions::default()
    };
    let error = StructureFactor::new(&options, &context(6.0, 30)).unwrap_err();
    assert_eq!(error.key(), "k_max");
}

#[test]
fn in_a_box_that_changes_wave_vectors_go_with_it() {
    // A lattice blown up by 4 % has the same factors at wave numbers smaller by as much.
    let (cell, positions) = fcc(3, 1.1);
    let context = BuildContext {
        cell,
        n_atoms: positions.len(),
        ..context(1.0, 1)
    };
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
