//! The numbers of the study: each against theory, with a tolerance that its cause explains.

use std::sync::LazyLock;

use super::groups::entry;
use super::map::StepMap;
use super::oscillator::{Spring, excursion, measured_map};
use super::*;
use crate::Silent;
use crate::claims::{Claim, Source};
use lennard_observables::Verdict;
use lennard_observables::{Cell, Value};

/// The quick oscillator part, run once for all tests.
static QUICK: LazyLock<Measured> =
    LazyLock::new(|| oscillator(true, &mut Silent).expect("every method runs on the oscillator"));

/// The claims about the oscillator.
fn claims() -> Vec<Claim> {
    crate::claims::judged(TEXT.claims, &QUICK.numbers).unwrap()
}

/// The numbers of some columns of a table, row by row, with the names in another column.
fn rows<const N: usize>(table: &str, name: &str, columns: [&str; N]) -> Vec<(String, [f64; N])> {
    let table = QUICK.tables.iter().find(|t| t.name == table).unwrap();
    let names = table.columns.iter().find(|c| c.name == name).unwrap();
    let columns = columns.map(|name| table.numbers(name).unwrap());
    let row = |(i, cell): (usize, &Cell)| match &cell.value {
        Value::Words(name) => (name.clone(), columns.each_ref().map(|column| column[i])),
        other => panic!("{other:?} is no name"),
    };
    names.cells.iter().enumerate().map(row).collect()
}

fn limit(method: &str) -> Option<f64> {
    let limits = rows("limits", "method", ["limit measured"]);
    let found = limits.iter().find(|(name, _)| name == method);
    found.map(|(_, [limit])| *limit).filter(|limit| !limit.is_nan())
}

#[test]
fn every_method_has_the_limit_of_its_declared_map() {
    let columns = ["limit measured", "limit by theory", "map differs by"];
    for (method, [measured, theory, differs]) in rows("limits", "method", columns) {
        // The window of `blanes-moan` opens so slowly that its edge is seen 6·10⁻⁶ late.
        let is_same = (measured - theory).abs() <= 1e-5 * theory;
        assert!(is_same || measured.is_nan() && theory.is_nan(), "{method}: {measured} {theory}");
        // Runs with the largest radii grow a thousandfold per step, from a start on a grid.
        assert!(differs < 1e-9, "{method}: {differs}");
    }
    assert_eq!(limit("explicit-euler"), Some(0.0));
    assert_eq!(limit("implicit-euler"), None);
    assert_eq!(limit("spook"), None);
}

#[test]
fn spook_turns_by_twice_the_arctangent_and_swings_by_the_root_at_every_finite_stiffness() {
    let spook = entry("spook").unwrap();
    // At ωh = 2 a step is a quarter of a turn, and no sample comes near a crest.
    for omega_h in [0.01, 0.1, 1.0, 2.1, 6.3, 50.0, 1000.0] {
        let map = measured_map(spook, omega_h, 1.0).unwrap();
        let theta = map.phase().expect("never real");
        // Near its ends the arc cosine behind an angle loses half the digits.
        let tolerance = 1e-13 * (1.0 / omega_h + omega_h).powi(2);
        assert!((theta - 2.0 * (0.5 * omega_h).atan()).abs() < tolerance, "ωh = {omega_h}");
        assert!((map.radius() - 1.0).abs() < 1e-12 * (1.0 + omega_h));
        let far =
            excursion(spook, Spring::Stiffness(omega_h * omega_h), 1.0, 100_000, f64::INFINITY);
        let amplitude = 1.0_f64.hypot(0.5 * omega_h);
        // The samples come within 10⁻³ of a crest in phase.
        assert!((far.unwrap().largest / amplitude - 1.0).abs() < 1e-6, "ωh = {omega_h}");
    }
}

#[test]
fn declared_maps_and_long_runs_agree_on_every_fate() {
    let columns =
        ["growth of halves", "radius by theory", "amplitude by theory", "amplitude measured"];
    for (method, [growth, radius, theory, measured]) in rows("stiffnesses", "method", columns) {
        assert_eq!(growth.is_finite(), radius < 1.0 + 1e-9, "{method}");
        // A run that grows has neither.
        let has_both = measured.is_finite() && theory.is_finite();
        let is_same = (measured / theory - 1.0).abs() < 1e-5;
        assert!(is_same || !has_both, "{method}: {measured} {theory}");
    }
}

#[test]
fn where_a_map_has_one_eigenvector_displacements_are_two_n_plus_one() {
    let columns = ["deviation from 2n + 1", "last |x|", "radius by theory"];
    for (run, [off, last, radius]) in rows("at-infinity", "run", columns) {
        // Rounding splits the double eigenvalue −1 by some 10⁻⁸: (n·10⁻⁸)² over 20 000 steps.
        if run == "k = inf, tau/h = 0" || run == "k = 4m/h²" {
            assert!(off < 1e-6, "{run}: {off}");
        } else if run.starts_with("k = inf") {
            assert!(radius < 1.0 && last < 1e-100, "{run}: {radius} {last}");
        }
    }
}

#[test]
fn large_stiffnesses_swing_by_the_root() {
    let columns = ["amplitude by theory", "amplitude measured"];
    for (run, [theory, measured]) in rows("at-infinity", "run", columns) {
        // The crest is sampled within half the angle that a beat advances, 2/(ωh)² of it.
        let omega_h = 2.0 * (theory * theory - 1.0).sqrt();
        let is_good = (measured / theory - 1.0).abs() < 2.0 / omega_h.powi(2) + 1e-7;
        assert!(is_good || theory.is_nan(), "{run}: {theory} {measured}");
    }
}

#[test]
fn measured_orders_are_the_declared_ones() {
    for (name, [theory, order]) in rows("orders", "name", ["order by theory", "order measured"]) {
        // Rounding alone has no order, and the rules of a changing step have a test of their own.
        let is_rounding = order.is_nan() && theory == 0.0;
        assert!(theory.is_nan() || is_rounding || (order - theory).abs() < 0.05, "{name}: {order}");
    }
}

#[test]
fn two_claims_of_the_manual_fail_where_a_map_has_one_eigenvector() {
    let claims = claims();
    let failing = claims.iter().filter(|c| c.verdict == Verdict::Differs);
    let failing: Vec<_> = failing.map(|c| (c.source, c.statement.as_str())).collect();
    let limit = "k ≤ 4m/h²: semi-implicit Euler is stable, the limit itself included";
    let rigid = "k = ∞, τ = 0: SPOOK does not diverge";
    assert_eq!(failing, [(Source::Manual, limit), (Source::Manual, rigid)]);
    for claim in &claims {
        assert!(claim.theory_agrees, "{claim:?}");
    }
}

#[test]
fn a_claim_of_ours_is_in_no_mouth_of_a_document() {
    let claims = claims();
    let source = |words: &str| {
        let claim = claims.iter().find(|c| c.statement.contains(words));
        claim.unwrap_or_else(|| panic!("no claim has “{words}”")).source
    };
    for ours in [
        "the Taylor start adds an offset",
        "one velocity-Verlet step errs by O(h³) in x",
        "amplitude √(1 + ω²h²/4)",
        "`pefrl` is stable below",
    ] {
        assert_eq!(source(ours), Source::Ours, "{ours}");
    }
    for manual in ["SPOOK is of order 1", "SPOOK takes no variable step"] {
        assert_eq!(source(manual), Source::Manual, "{manual}");
    }
    assert_eq!(source("n(n + 1)/2"), Source::Article);
}

#[test]
fn a_wrong_map_would_be_noticed() {
    // The comparison behind every figure must be able to fail: symplectic Euler against the map of
    // velocity Verlet has the same radius, and another amplitude.
    let symplectic = measured_map(entry("symplectic-euler").unwrap(), 1.0, 1.0).unwrap();
    let verlet = amplification::theory(entry("velocity-verlet").unwrap(), 1.0);
    assert!((symplectic.radius() - verlet.radius()).abs() < 1e-12);
    assert!(
        (symplectic.amplitude(1.0, 0.0).unwrap() - verlet.amplitude(1.0, 0.0).unwrap()).abs() > 0.1
    );
    assert!(StepMap::phase(verlet).is_some());
}
