//! Rows of every form against its formula.

use super::*;
use crate::interaction::NearPart;
use crate::options::SplitOptions;
use crate::pair::{Model, PotentialOptions, TruncationKind, TruncationOptions};

/// Every form that runs take by rows, and some that they need not.
fn models() -> Vec<(String, Model)> {
    let mut all = Vec::new();
    for potential in PotentialOptions::examples() {
        for &kind in TruncationKind::ALL {
            if let Ok(model) = Model::new(&potential, &TruncationOptions::new(kind, 2.5)) {
                all.push((format!("{potential:?}, {}", kind.name()), model));
            }
        }
    }
    all
}

/// U and −U′/r of a row in double precision.
fn looked_up(rows: &RowsOf<f64>, [scale, law, half]: [f64; 3], s: f64) -> (f64, f64) {
    let scaled = s * scale;
    let held = scaled.max(rows.lowest).min(rows.highest);
    let number = held.to_bits() >> rows.shift;
    let before = rows.first_of(law).to_bits() - <f64 as Number>::COUNTS_FROM.to_bits();
    let at = (number + before - rows.first) as usize;
    let d = scaled - f64::from_bits(number << rows.shift);
    let [u, g0, g1, g2, g3] = unfolded(rows.rows[at].0);
    let integral = g0 + d * (g1 / 2.0 + d * (g2 / 3.0 + d * g3 / 4.0));
    (u - half * d * integral, g0 + d * (g1 + d * (g2 + d * g3)))
}

/// The largest |ΔU|/max(|U|, 1) and |ΔF|/max(|F|, 1) from 1e-3 σ to the end of a law.
fn largest(rows: &PairRows, law: &LawOfRows<'_>) -> (f64, f64) {
    let constants = rows.constants(0);
    let (mut of_energy, mut of_force) = (0.0_f64, 0.0_f64);
    let points = 40_000;
    for k in 0..=points {
        let r = 1e-3 * (law.end2.sqrt() / 1e-3).powf(f64::from(k) / f64::from(points));
        let s = (r * r).min(law.end2);
        let exact = (law.on)(Side::of(s, law.joint2), s);
        let (energy, force) = looked_up(&rows.wide, constants, s);
        of_energy = of_energy.max((energy - exact.energy).abs() / exact.energy.abs().max(1.0));
        let exact_force = r * exact.force;
        of_force = of_force.max((r * force - exact_force).abs() / exact_force.abs().max(1.0));
    }
    (of_energy, of_force)
}

fn holds(name: &str, law: &LawOfRows<'_>) {
    let rows =
        PairRows::new(std::slice::from_ref(law)).unwrap_or_else(|(_, r)| panic!("{name} at {r}"));
    let (of_energy, of_force) = largest(&rows, law);
    assert!(of_energy <= 1.1e-10 && of_force <= 1.1e-9, "{name}: {of_energy:e} {of_force:e}");
}

#[test]
fn rows_of_every_form_hold_their_tolerance_at_every_distance() {
    for (name, model) in models() {
        holds(&name, &LawOfRows::of(&model.form, model.r_cut));
    }
}

#[test]
fn rows_of_the_near_part_hold_it_too_unless_a_second_joint_lies_in_it() {
    let split = |r_split: f64| NearPart::new(&SplitOptions { r_split, width: 0.2 * r_split });
    for (name, model) in models() {
        let r_split = 0.7 * model.r_cut;
        let law = split(r_split).law(&model.form, model.r_cut, 1.0);
        match model.form.joint2().filter(|joint2| joint2.sqrt() < r_split) {
            None => holds(&format!("near part of {name}"), &law),
            Some(joint2) => {
                let (number, r) = PairRows::new(&[law]).unwrap_err();
                assert_eq!(number, 0);
                assert!((r / joint2.sqrt() - 1.0).abs() < 0.02, "{name}: {r} at {joint2}");
            }
        }
    }
}

#[test]
fn any_number_has_a_row_and_a_pair_at_no_distance_has_no_finite_force() {
    let options = PotentialOptions::default();
    let model = Model::new(&options, &TruncationOptions::new(TruncationKind::Switch, 2.5)).unwrap();
    let rows = PairRows::new(&[LawOfRows::of(&model.form, model.r_cut)]).unwrap();
    let constants = rows.constants(0);
    for s in [-1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300] {
        let _ = looked_up(&rows.wide, constants, s);
    }
    assert!(!looked_up(&rows.wide, constants, 0.0).1.is_finite());
    assert!(looked_up(&rows.wide, constants, 1e-8).1.is_finite());
}

#[test]
fn rows_of_several_laws_are_the_rows_of_each() {
    let model = |r_cut| {
        let truncation = TruncationOptions::new(TruncationKind::Switch, r_cut);
        Model::new(&PotentialOptions::default(), &truncation).unwrap()
    };
    let models = [model(2.5), model(3.1)];
    let laws = models.each_ref().map(|m| LawOfRows::of(&m.form, m.r_cut));
    let rows = PairRows::new(&laws).unwrap();
    for (k, law) in laws.iter().enumerate() {
        for r in [0.9_f64, 1.3, 2.1, 2.49] {
            let exact = (law.on)(Side::of(r * r, law.joint2), r * r);
            let (energy, force) = looked_up(&rows.wide, rows.constants(k), r * r);
            assert!((energy - exact.energy).abs() < 1e-10 * exact.energy.abs().max(1.0));
            assert!((force - exact.force).abs() < 1e-9 * exact.force.abs().max(1.0));
        }
    }
}
