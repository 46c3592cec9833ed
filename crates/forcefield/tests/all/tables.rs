//! A table of Lennard-Jones beside the formula, as scenes use both.

use crate::common::*;
use lennard_core::{DVec3, Want};
use lennard_forcefield::*;

fn options() -> Table {
    match table() {
        PotentialOptions::Table(table) => table,
        other => panic!("{other:?}"),
    }
}

#[test]
fn forces_of_a_liquid_are_the_formulas_within_the_stated_error() {
    let (cell, positions) = liquid([9, 8, 7], 0.8442, 0.15);
    let (of_energy, of_force) = options().stated_errors().unwrap();
    assert!(of_force < 1e-4, "{of_force}");
    for &kind in TruncationKind::ALL {
        let truncation = TruncationOptions::new(kind, 2.5);
        let formula = ForceFieldOptions { truncation, ..ForceFieldOptions::default() };
        let (wanted, totals) = reference(&formula, cell, &positions);
        let sizes = magnitudes(&formula, cell, &positions);
        let tabulated = ForceFieldOptions { potential: table(), ..formula };
        let mut forces = build(&tabulated, &conditions(cell, positions.len())).unwrap();
        let (found, energetics) = all(&mut forces, cell, &positions, Want::TOTALS);
        // Some 65 neighbors have a stated error of 1 + |F| each; a weight of the truncation adds its slope times U.
        for ((f, w), (size, _)) in found.iter().zip(&wanted).zip(&sizes) {
            let bound = of_force * (100.0 + size) + 10.0 * of_energy * 100.0;
            assert!((*f - *w).length() <= bound, "{kind:?}: {f} against {w}");
        }
        let apart = energetics.potential_energy.unwrap() - totals.potential_energy.unwrap();
        let pairs = totals.pairs.unwrap() as f64;
        assert!(apart.abs() <= 4.0 * of_energy * pairs, "{kind:?}: {apart}");
        assert_eq!(energetics.pairs, totals.pairs);
    }
}

#[test]
fn the_force_of_a_table_is_the_slope_of_its_energy() {
    for &kind in TruncationKind::ALL {
        let model = Model::new(&table(), &TruncationOptions::new(kind, 2.5)).unwrap();
        for k in 0..1000 {
            let r = 0.8 + 1.69 * f64::from(k) / 1000.0;
            let u = |r: f64| model.eval(r * r).energy;
            let h = 1e-5 * r;
            let slope = (u(r + h) - u(r - h)) / (2.0 * h);
            let pair = model.eval(r * r);
            let bound = 1e-6 * (1.0 + pair.curvature.abs());
            assert!((slope + pair.force * r).abs() < bound, "{kind:?} at {r}");
        }
    }
}

#[test]
fn the_tail_is_that_of_lennard_jones() {
    let tail = |potential| {
        let options = ForceFieldOptions { potential, ..ForceFieldOptions::default() };
        tail_correction(&options, 864, 1000.0).unwrap()
    };
    let (found, wanted) = (tail(table()), tail(PotentialOptions::default()));
    assert!((found.energy / wanted.energy - 1.0).abs() < 1e-4, "{found:?} {wanted:?}");
    assert!((found.virial / wanted.virial - 1.0).abs() < 1e-4, "{found:?} {wanted:?}");
}

#[test]
fn a_table_names_rows_checksum_errors_and_tail() {
    let words = table().in_words();
    for part in ["lennard-jones.table", "661 rows", "checksum", "spline within", "tail r^-6"] {
        assert!(words.contains(part), "{words}");
    }
}

fn refused(options: Table, truncation: TruncationOptions, key: &str) -> String {
    let options = ForceFieldOptions {
        potential: PotentialOptions::Table(options),
        truncation,
        ..ForceFieldOptions::default()
    };
    let cell = lennard_core::PeriodicBox::new(DVec3::splat(12.0)).unwrap();
    let error = check(&options, &conditions(cell, 864)).unwrap_err();
    assert_eq!(error.key(), key);
    error.allowed()
}

#[test]
fn what_a_table_cannot_be_is_refused_with_its_key() {
    let cut = TruncationOptions::new(TruncationKind::Cut, 2.5);
    let shift = TruncationOptions::new(TruncationKind::Shift, 2.5);
    let beyond = TruncationOptions::new(TruncationKind::Shift, 4.5);
    let of = |change: fn(&mut Table)| {
        let mut table = options();
        change(&mut table);
        table
    };
    refused(of(|t| t.file = None), shift, "potential.kind");
    refused(options(), beyond, "potential.file");
    let without = of(|t| t.tail_exponent = None);
    let allowed = refused(without, cut, "potential.file");
    assert!(allowed.contains("tail_exponent"), "{allowed}");
    refused(of(|t| t.tail_exponent = Some(9)), cut, "potential.tail_exponent");
    let nowhere = of(|t| t.file = Some(TablePath::from("no/such.table".to_owned())));
    refused(nowhere, shift, "potential.file");
    let changed: Table = toml::from_str(&format!(
        "file = {:?}\nchecksum = \"00000000\"",
        options().file.unwrap().path()
    ))
    .unwrap();
    let allowed = refused(changed, shift, "potential.file");
    assert!(allowed.contains("00000000"), "{allowed}");
    assert!(toml::from_str::<Table>("checksum = \"0\"").is_err());
}

#[test]
fn a_table_comes_back_from_its_text_with_its_checksum() {
    let moved = table().with_file(options().file.unwrap()).unwrap();
    let text = toml::to_string(&moved).unwrap();
    assert!(text.contains("checksum = \""), "{text}");
    assert_eq!(toml::from_str::<PotentialOptions>(&text).unwrap(), moved);
}
