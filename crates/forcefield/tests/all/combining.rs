//! Combining rules against numbers of their formulas in exact arithmetic.

use lennard_forcefield::{CombiningOptions, Deviation, Size, combining_rules};

/// Of (σ, ε) = (1, 1) with (σ₂, ε₂): rule, σ₂, ε₂, then σ₁₂ and ε₁₂.
const NUMBERS: [(&str, f64, f64, f64, f64); 8] = [
    ("lorentz-berthelot", 1.2, 0.8, 1.1, 0.894427191),
    ("lorentz-berthelot", 1.0656, 1.3934, 1.0328, 1.18042365276),
    ("geometric", 1.2, 0.8, 1.09544511501, 0.894427191),
    ("geometric", 0.88, 0.5, 0.938083151965, std::f64::consts::FRAC_1_SQRT_2),
    ("waldman-hagler", 1.2, 0.8, 1.12180557136, 0.775502453621),
    ("waldman-hagler", 0.88, 0.5, 0.949376526319, 0.658115443323),
    ("fender-halsey", 1.2, 0.8, 1.1, 0.888888888889),
    ("fender-halsey", 0.88, 0.5, 0.94, 0.666666666667),
];

const ONE: Size = Size { sigma: 1.0, epsilon: 1.0 };

fn rule(name: &str) -> CombiningOptions {
    let all = CombiningOptions::all().into_iter();
    all.into_iter().find(|rule| rule.spec().name == name).unwrap()
}

#[test]
fn every_rule_gives_the_numbers_of_its_formula_in_either_order() {
    for (name, sigma, epsilon, sigma_12, epsilon_12) in NUMBERS {
        let other = Size { sigma, epsilon };
        for (a, b) in [(ONE, other), (other, ONE)] {
            let found = rule(name).combine(a, b, Deviation::default()).unwrap();
            assert!((found.sigma - sigma_12).abs() < 1e-10, "{name}: {found:?}");
            assert!((found.epsilon - epsilon_12).abs() < 1e-9, "{name}: {found:?}");
        }
    }
}

#[test]
fn like_particles_have_their_own_size_by_every_rule_but_the_explicit_one() {
    let size = Size { sigma: 1.3, epsilon: 0.7 };
    assert_eq!(combining_rules().len(), CombiningOptions::all().len());
    for rule in CombiningOptions::all() {
        let name = rule.spec().name;
        let Some(found) = rule.combine(size, size, Deviation::default()) else {
            assert_eq!(name, "explicit");
            continue;
        };
        assert!((found.sigma - size.sigma).abs() < 1e-14, "{name}");
        assert!((found.epsilon - size.epsilon).abs() < 1e-14, "{name}");
    }
}

#[test]
fn a_pair_deviates_from_lorentz_and_berthelot_by_its_own_k_and_l() {
    let other = Size { sigma: 1.2, epsilon: 0.8 };
    let deviation = Deviation { k: Some(0.1), l: Some(-0.05) };
    let found = rule("lorentz-berthelot").combine(ONE, other, deviation).unwrap();
    assert!((found.sigma - 1.1 * 1.05).abs() < 1e-14);
    assert!((found.epsilon - 0.9 * 0.8_f64.sqrt()).abs() < 1e-14);
    assert!(rule("lorentz-berthelot").deviates() && !rule("geometric").deviates());
}
