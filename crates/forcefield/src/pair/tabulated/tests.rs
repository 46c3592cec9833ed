//! Tables of the 12-6 potential against the formula, and files that are no table.

use super::*;
use crate::pair::{LennardJones, PairPotential, Side};

/// U and F of Lennard-Jones.
fn lennard_jones(r: f64) -> (f64, f64) {
    let pair = LennardJones {}.on(Side::Inside, r * r);
    (48.0 * pair.energy, 48.0 * pair.force * r)
}

/// A text of rows with U and F of a function, over [from, to] in steps of `step`.
fn text(from: f64, to: f64, step: f64, of: impl Fn(f64) -> (f64, f64)) -> String {
    let rows = ((to - from) / step).round() as u32;
    let row = |k| {
        let r = from + step * f64::from(k);
        let (u, f) = of(r);
        format!("{r} {u} {f}\n")
    };
    (0..=rows).map(row).collect()
}

/// U and F of a table.
fn looked_up(table: &Tabulated, r: f64) -> (f64, f64) {
    let pair = table.at(r * r);
    (pair.energy, r * pair.force)
}

#[test]
fn a_table_of_lennard_jones_is_the_formula_within_its_stated_error() {
    for (step, worst) in [(0.02, 1e-2), (0.005, 1e-4), (0.001, 1e-6)] {
        let table = Tabulated::parse(&text(0.7, 4.0, step, lennard_jones)).unwrap();
        let mut largest = Deviation::default();
        let from = table.range.0;
        for k in 0..20_000 {
            let r = from + (4.0 - from) * f64::from(k) / 20_000.0;
            let ((u, f), (exact_u, exact_f)) = (looked_up(&table, r), lennard_jones(r));
            largest = largest.or((exact_u, u - exact_u), (exact_f, f - exact_f));
        }
        let stated = table.error;
        // It states what is there: not less, and not ten times as much.
        let holds = |found: f64, stated: f64| found <= stated && stated < 10.0 * found;
        assert!(holds(largest.energy, stated.energy), "{largest:?} {stated:?}");
        assert!(holds(largest.force, stated.force), "{largest:?} {stated:?}");
        assert!(stated.force < worst, "{stated:?}");
    }
}

#[test]
fn below_the_table_a_line_in_r2_goes_on() {
    let table = Tabulated::parse(&text(0.8, 3.0, 0.01, lennard_jones)).unwrap();
    let (at, below) = (looked_up(&table, 0.8), looked_up(&table, 0.4));
    assert!((at.1 / 0.8 - below.1 / 0.4).abs() < 1e-9 * at.1, "F/r is constant");
    assert!(below.0 > at.0);
}

#[test]
fn integrals_beyond_a_cutoff_are_those_of_the_formula() {
    let table = Tabulated::parse(&text(0.7, 6.0, 0.005, lennard_jones)).unwrap();
    let whole = LennardJones {}.tail_energy(2.5) - LennardJones {}.tail_energy(6.0);
    assert!((table.integral(2.5) / whole - 1.0).abs() < 1e-7);
    assert!((table.exponent_at_end() - 6.0).abs() < 1e-3);
}

/// U and F at a distance.
type Law = fn(f64) -> (f64, f64);

fn refused(text: &str, words: &str) {
    let refusal = Tabulated::parse(text).unwrap_err();
    assert!(refusal.found.contains(words), "{refusal:?}");
    assert!(!refusal.allowed.is_empty());
}

#[test]
fn files_that_are_no_table_are_refused_with_the_line() {
    let good = text(0.8, 3.0, 0.01, lennard_jones);
    refused("", "0 rows");
    refused("# r U F\n1 2 3\n", "1 rows");
    refused("1.0 2.0\n", "line 1: `1.0 2.0`");
    refused("1.0 2.0 nan\n", "line 1");
    refused("1.0 2.0 inf\n", "line 1");
    refused("1.0 2.0 3.0 4.0\n", "line 1");
    refused("0.0 2.0 3.0\n", "with r = 0");
    let swapped = good.replacen("0.9 ", "0.5 ", 1);
    assert_ne!(swapped, good);
    refused(&swapped, "r = 0.5 after");
    let wrong: [(&str, Law); 4] = [
        ("sign", |r| (lennard_jones(r).0, -lennard_jones(r).1)),
        ("factor", |r| (lennard_jones(r).0, 1.05 * lennard_jones(r).1)),
        ("over r", |r| (lennard_jones(r).0, lennard_jones(r).1 / r)),
        ("shift", |r| (lennard_jones(r).0, lennard_jones(r).1 + 0.5)),
    ];
    for (what, of) in wrong {
        let refusal = Tabulated::parse(&text(0.8, 3.0, 0.01, of)).unwrap_err();
        assert!(refusal.found.contains("slope of U"), "{what}: {refusal:?}");
    }
    let one_wrong = good.replacen("\n1.5 -", "\n1.5 ", 1);
    assert_ne!(one_wrong, good);
    // r = 1.5 is line 71. The rows beside it fail, with a U or an F that is right.
    refused(&one_wrong, "line 71: U = ");
    let force = good.lines().nth(70).and_then(|line| line.rsplit(' ').next());
    let other = good.replacen(force.unwrap(), "-1.0", 1);
    refused(&other, "line 71: F = -1 ");
}
