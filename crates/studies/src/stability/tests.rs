//! The numbers of the study against theory, with tolerances that their causes explain. What is a row of `claims.csv` is judged there: two
//! rows differ, and theory agrees with all.

use std::sync::LazyLock;

use super::groups::entry;
use super::map::StepMap;
use super::oscillator::{Spring, excursion, measured_map};
use super::*;
use crate::Silent;
use lennard_observables::Verdict;

use crate::claims::Source;

/// The quick oscillator part, run once for all tests.
static QUICK: LazyLock<OscillatorStudy> =
    LazyLock::new(|| oscillator(true, &mut Silent).expect("every method runs on the oscillator"));

/// The claims about the oscillator.
fn claims() -> Vec<crate::claims::Claim> {
    crate::claims::judged(CLAIMS, &numbers::on_the_oscillator(&QUICK).unwrap()).unwrap()
}

fn limit(method: &str) -> Option<f64> {
    let found = QUICK.methods.iter().find(|m| m.method == method);
    found.expect("the method is on the list").measured_limit
}

#[test]
fn every_method_has_the_limit_of_its_declared_map() {
    for m in &QUICK.methods {
        match (m.measured_limit, m.theory_limit) {
            // The window of `blanes-moan` opens so slowly that its edge is seen 6·10⁻⁶ late.
            (Some(measured), Some(theory)) => {
                assert!(
                    (measured - theory).abs() <= 1e-5 * theory,
                    "{}: {measured} {theory}",
                    m.method
                );
            }
            (None, None) => assert_eq!(m.bounded_at_1000, Some(true), "{}", m.method),
            other => panic!("{}: {other:?}", m.method),
        }
        // Runs with the largest radii grow a thousandfold per step, from a start on a grid.
        assert!(m.largest_radius_difference < 1e-9, "{}", m.method);
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
        assert!((far.unwrap().largest() / amplitude - 1.0).abs() < 1e-6, "ωh = {omega_h}");
    }
}

#[test]
fn declared_maps_and_long_runs_agree_on_every_fate() {
    for case in &QUICK.cases {
        for s in &case.summaries {
            let bounded = s.growth_of_halves.is_some();
            assert_eq!(bounded, s.theory_radius < 1.0 + 1e-9, "{}, {}", case.title, s.method);
            if let (Some(theory), Some(measured)) = (s.theory_amplitude, s.measured_amplitude) {
                assert!((measured / theory - 1.0).abs() < 1e-5, "{}, {}", case.title, s.method);
            }
        }
    }
}

#[test]
fn at_infinite_stiffness_spook_grows_as_two_n_plus_one_without_damping_and_decays_with_it() {
    let found = &QUICK.infinite;
    // At its limit, symplectic Euler does the same.
    assert!(found.at_limit.deviation_from_linear < 1e-6, "{:?}", found.at_limit);
    // Rounding splits the double eigenvalue −1 by some 10⁻⁸: (n·10⁻⁸)² over 20 000 steps.
    assert!(found.deviation_from_linear < 1e-6, "{}", found.deviation_from_linear);
    for run in &found.rigid {
        if run.damping_steps == 0.0 {
            assert!((run.growth_of_halves - 2.0).abs() < 1e-3);
        } else {
            assert!(run.theory_radius < 1.0);
            // The critical damping has a double eigenvalue: √ε is 10⁻⁸.
            assert!((run.measured_radius - run.theory_radius).abs() < 1e-7);
            assert!(run.last_displacement < 1e-100);
        }
    }
    for run in &found.stiff {
        // The crest is sampled within half the angle that a beat advances, 2/(ωh)² of it.
        let tolerance = 2.0 / run.omega_h.powi(2) + 1e-7;
        assert!(
            (run.measured_amplitude / run.theory_amplitude - 1.0).abs() < tolerance,
            "{}",
            run.omega_h
        );
    }
}

#[test]
fn measured_orders_are_the_declared_ones() {
    let o = &QUICK.orders;
    let lines = o
        .positions
        .iter()
        .chain(&o.velocities)
        .chain(&o.starts)
        .chain(&o.velocity_estimates)
        .chain(&o.local)
        .chain([&o.energy]);
    for line in lines {
        match line.measured {
            Some(order) => assert!((order - line.theory).abs() < 0.05, "{}: {order}", line.name),
            None => assert_eq!(line.theory, 0.0, "{} has no measurable order", line.name),
        }
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
    let verlet = amplification::theory(entry("velocity-verlet").unwrap(), 1.0).unwrap();
    assert!((symplectic.radius() - verlet.radius()).abs() < 1e-12);
    assert!(
        (symplectic.amplitude(1.0, 0.0).unwrap() - verlet.amplitude(1.0, 0.0).unwrap()).abs() > 0.1
    );
    assert!(StepMap::phase(verlet).is_some());
}
