//! The sum over all pairs that checks the forces of a run.

use super::*;

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
                let all_pairs = AllPairs::new(&options, None).unwrap();
                for (i, w) in wanted.iter().enumerate() {
                    let found = all_pairs.force_on(i, &cell, positions);
                    assert!((found.force - *w).length() <= 1e-10 * (1.0 + w.length()) * loosened);
                    let is_plain =
                        matches!(base.truncation.kind, TruncationKind::Cut | TruncationKind::Shift);
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
        AllPairs::new(&options, None).unwrap().force_on(0, &cell, &pair)
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
