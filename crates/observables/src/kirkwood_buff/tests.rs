use super::*;
use crate::Standing;
use crate::testing::{context, estimate, mixture, random_positions, view_of};
use lennard_core::DVec3;

/// What is found in ideal gases, where no particle knows of another.
fn ideal(kinds: usize, samples: u64) -> Findings {
    let (n, side) = (200, 8.0);
    let context = BuildContext { species: mixture(n, |i| i % kinds), ..context(side, n) };
    let options = KirkwoodBuffOptions::default();
    let mut found = KirkwoodBuff::new(&options, &context).unwrap();
    for seed in 0..samples {
        view_of(&context.cell, random_positions(n, side, seed), |view| {
            found.sample(view);
        });
    }
    found.finish(0.0)
}

#[test]
fn an_ideal_mixture_has_integrals_of_zero_and_a_factor_of_one_by_both_routes() {
    let findings = ideal(2, 300);
    let names: Vec<&str> = findings.averages.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(
        names[..4],
        ["kirkwood_buff_A_A", "kirkwood_buff_A_B", "kirkwood_buff_B_B", "thermodynamic_factor"]
    );
    assert_eq!(names.len(), 10);
    for average in &findings.averages {
        // At rest the temperature is 0: κ is no number here.
        if average.name.contains("compressibility") {
            continue;
        }
        assert_eq!(average.doubt, None, "{average:?}");
        let estimate = average.estimate;
        let exact = if average.name.contains("factor") { 1.0 } else { 0.0 };
        assert!((estimate.mean - exact).abs() < 4.0 * estimate.standard_error, "{average:?}");
        assert!(estimate.standard_error < 1.2, "{average:?}");
    }
}

#[test]
fn one_species_has_one_integral_and_three_have_no_factor() {
    let names = |kinds| -> Vec<String> {
        let averages = ideal(kinds, 30).averages;
        averages.into_iter().map(|a| a.name).collect()
    };
    assert_eq!(
        names(1),
        [
            "kirkwood_buff",
            "compressibility_kirkwood_buff",
            "kirkwood_buff_structure",
            "compressibility_kirkwood_buff_structure"
        ]
    );
    let three = names(3);
    assert_eq!(three.len(), 12);
    assert!(!three.iter().any(|name| name.contains("factor")));
}

/// Pairs of one particle of each species at a distance of 1 to 1.4 σ: each has one partner of the other species more than the mean.
#[test]
fn bound_pairs_have_one_partner_in_excess_by_both_routes() {
    let (n, side) = (200, 9.0);
    let context = BuildContext { species: mixture(n, |i| i % 2), ..context(side, n) };
    let mut found = KirkwoodBuff::new(&KirkwoodBuffOptions::default(), &context).unwrap();
    for seed in 0..400 {
        let mut positions = random_positions(n, side, seed);
        let turns = random_positions(n / 2, 1.0, 10_000 + seed);
        for (m, turn) in turns.iter().enumerate() {
            let direction = (*turn - DVec3::splat(0.5)).normalize();
            positions[2 * m + 1] = positions[2 * m] + (1.0 + 0.4 * turn.x) * direction;
        }
        view_of(&context.cell, positions, |view| found.sample(view));
    }
    let findings = found.finish(0.0);
    // ρ_b·G_ab = 1 with ρ_b = 100/729; like particles know nothing of each other.
    let exact = 7.29;
    for route in ["kirkwood_buff", "kirkwood_buff_structure"] {
        let unlike = estimate(&findings, &format!("{route}_A_B"));
        assert!(unlike.standard_error < 0.6, "{unlike:?}");
        // The line in k² leaves out terms of k⁴·(1.4 σ)⁴/120, a per cent at the largest k.
        let off = (unlike.mean - exact).abs();
        assert!(off < 4.0 * unlike.standard_error + 0.1, "{route}: {unlike:?}");
        let like = estimate(&findings, &format!("{route}_A_A"));
        assert!(like.mean.abs() < 4.0 * like.standard_error, "{like:?}");
    }
}

#[test]
fn routes_that_disagree_are_said_not_to_have_converged() {
    // Two species in two halves of the box: the integral over half a side has no end.
    let (n, side) = (200, 8.0);
    let context = BuildContext { species: mixture(n, |i| i % 2), ..context(side, n) };
    let mut found = KirkwoodBuff::new(&KirkwoodBuffOptions::default(), &context).unwrap();
    for seed in 0..100 {
        let mut positions = random_positions(n, side, seed);
        for (i, r) in positions.iter_mut().enumerate() {
            r.x = 0.5 * (r.x + side * (i % 2) as f64);
        }
        view_of(&context.cell, positions, |view| found.sample(view));
    }
    let findings = found.finish(0.0);
    let unlike = findings.averages.iter().find(|a| a.name == "kirkwood_buff_A_B");
    let doubt = unlike.unwrap().doubt.as_ref().unwrap();
    assert_eq!(doubt.standing(), Standing::Incomplete);
    assert!(doubt.reason(1).contains("larger box"), "{}", doubt.reason(1));
}
