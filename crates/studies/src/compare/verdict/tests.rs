//! Verdicts follow the numbers.

use lennard_observables::Standing;

use super::*;
use crate::testing::average;

const TOLERANCE: Tolerance = Tolerance::new(4.0, 0.003, 0.0);

fn row(measured: f64) -> Row {
    Row::measured("u", &average(measured, 3e-4)).against(-5.0, Some(4e-4), TOLERANCE, "x")
}

#[test]
fn a_verdict_weighs_both_errors_and_the_allowance() {
    // 4·√(3² + 4²)·1e-4 + 0.003 = 0.005.
    assert_eq!(row(-5.0049).verdict, Verdict::Agrees);
    assert_eq!(row(-5.0051).verdict, Verdict::Differs);
    assert!((row(-4.999).in_standard_errors.unwrap() - 2.0).abs() < 1e-9);
    assert_eq!(row(f64::NAN).verdict, Verdict::Differs);
}

/// c_p 4.10 ± 0.70 beside 4.80 is no agreement: such an error sees no difference.
#[test]
fn a_tolerance_above_a_twentieth_of_the_scale_tells_nothing() {
    let three = Tolerance::new(3.0, 0.0, 0.0);
    let verdict = |measured, error, scale| {
        let row = Row { scale, ..Row::measured("c_p", &average(measured, error)) };
        row.against(4.8, None, three, "x").verdict
    };
    assert_eq!(verdict(4.10, 0.70, None), Verdict::TooCoarse);
    assert_eq!(verdict(4.80, 0.0801, None), Verdict::TooCoarse);
    assert_eq!(verdict(4.80, 0.0799, None), Verdict::Agrees);
    assert_eq!(verdict(2.60, 0.70, None), Verdict::Differs);
    // The scale may be another than the size of the value, which passes through zero.
    assert_eq!(verdict(4.80, 0.0799, Some(4.0)), Verdict::TooCoarse);
    assert_eq!(verdict(4.10, 0.70, Some(50.0)), Verdict::Agrees);
}

#[test]
fn a_finite_size_term_that_is_not_trusted_is_in_the_tolerance() {
    let allowed = TOLERANCE.for_reference(Some(0.02)).holding(Some(0.0769));
    assert_eq!(allowed.words(), "4 standard errors + 0.02 + 0.077 of the finite-size term");
    let row = Row::measured("u", &average(-5.06, 0.003)).against(-5.0, None, allowed, "x");
    assert_eq!(row.verdict, Verdict::Agrees);
    assert_eq!(TOLERANCE.holding(None).words(), TOLERANCE.words());
}

#[test]
fn the_allowance_of_a_reference_has_two_digits_and_is_never_too_small() {
    for (own, words) in [
        (0.15508462136292955, "0.16"),
        (2.2358183222459527e-4, "0.00023"),
        (0.003, "0.003"),
        (0.0999, "0.1"),
        (0.160_000_5, "0.17"),
        (0.009_901, "0.01"),
        (1.7, "1.7"),
    ] {
        let allowed = TOLERANCE.for_reference(Some(own));
        assert_eq!(allowed.words(), format!("4 standard errors + {words}"));
        assert!(allowed.of(0.0, 0.0) >= own);
    }
}

#[test]
fn a_value_known_to_lie_in_a_range_differs_by_its_distance_from_it() {
    let row = |low, high| row(high).between(low, high);
    let inside = row(-5.1, -4.9);
    assert_eq!((inside.difference, inside.verdict), (Some(0.0), Verdict::Agrees));
    assert!(inside.range_words().unwrap().contains("range -5.1000 to -4.9000"));
    let above = row(-4.998, -4.9);
    assert!((above.in_standard_errors.unwrap() - 4.0).abs() < 1e-9);
    assert_eq!(above.verdict, Verdict::Agrees);
    assert_eq!(row(-5.2, -5.01).verdict, Verdict::Differs);
    // What is no range changes nothing.
    let none = row(f64::NAN, f64::NAN);
    assert_eq!((none.verdict, none.range_words()), (Verdict::Differs, None));
}

#[test]
fn a_bias_explains_a_difference_of_its_size_and_no_other() {
    let because = "the tail beyond a cutoff of 2.5 σ";
    let found = row(-5.012).biased_by(-0.010, because);
    assert_eq!(found.verdict, Verdict::PredictedBias);
    assert_eq!(found.verdict_words(), "predicted bias of −0.010");
    // 0.375 ε off, where the cutoff makes a hundredth of that.
    let found = row(-4.625).biased_by(0.004, because);
    assert_eq!(found.verdict, Verdict::Differs);
    assert!(found.verdict_words().contains("not explained"));
    // A bias of the wrong sign explains nothing, and what agrees needs no explanation.
    assert_eq!(row(-5.0055).biased_by(0.001, because).verdict, Verdict::Differs);
    assert_eq!(row(-5.001).biased_by(-0.001, because).verdict, Verdict::Agrees);
}

#[test]
fn what_is_no_result_is_held_against_nothing() {
    let doubted = AverageRecord {
        standing: Standing::TooShort,
        reason: "12 samples".into(),
        ..average(-7.0, f64::NAN)
    };
    let row = Row::measured("u", &doubted).against(-5.0, None, TOLERANCE, "a source");
    assert_eq!(row.verdict_words(), "too short: 12 samples");
    assert_eq!((row.reference, row.source.as_str()), (None, ""));
}
