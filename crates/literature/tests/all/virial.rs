//! Virial coefficients beside closed forms, independent quadrature, and equations of state.

use lennard_literature::{
    EquationOfState, Jet, Mie, OutsideRange, Phase, kolafa_nezbeda_1994, pohl_2023, thol_2016,
    virial_series,
};

/// B₂ of 12-6 in σ³, T ∂B₂/∂T and T² ∂²B₂/∂T², by the series with 30 digits, checked against quadrature to 1e-15; B₃ in σ⁶
/// by the sine transform of the Mayer function on 2¹⁶ points up to 60 σ. Computed for this test, not taken from a paper.
const LENNARD_JONES: [[f64; 5]; 5] = [
    [0.7, -9.864_679_086_625_1, 17.293_661_435_976, -50.396_726_818_442, -14.81199],
    [1.0, -5.315_745_120_262_8, 9.274_529_240_452_7, -24.169_012_951_177, 1.884_787],
    [1.31, -3.270_434_694_647_5, 6.139_060_770_441, -15.102_963_450_229, 2.573_231],
    [2.0, -1.314_495_329_569_2, 3.413_279_002_423_9, -7.958_105_799_373_3, 1.917_201],
    [3.0, -0.241_345_449_479_07, 2.010_626_009_731, -4.605_984_176_015_1, 1.545_364],
];

/// B₂ of other Mie potentials in σ³, computed in the same way.
const OTHERS: [(f64, f64, f64, f64); 5] = [
    (14.0, 6.0, 1.0, -4.580_434_887_67),
    (10.0, 6.0, 1.0, -6.427_283_592_72),
    (24.0, 6.0, 0.7, -5.918_742_887_48),
    (14.0, 7.0, 3.0, 0.362_608_828_165),
    (10.0, 6.0, 2.0, -1.820_996_831_62),
];

#[test]
fn second_virial_coefficients_and_their_slopes_are_exact() {
    for [t, b, slope, curvature, _] in LENNARD_JONES {
        let beta = 1.0 / t;
        let found = Mie::LENNARD_JONES.second_virial(Jet::first(beta));
        // T ∂/∂T = −β ∂/∂β, and T² ∂²/∂T² = β² ∂²/∂β² + 2β ∂/∂β.
        let of_t = [found.value, -beta * found.x, beta * beta * found.xx + 2.0 * beta * found.x];
        for (found, expected) in of_t.into_iter().zip([b, slope, curvature]) {
            assert!((found / expected - 1.0).abs() < 2e-13, "{t}: {found} {expected}");
        }
    }
    for (repulsive, attractive, t, b) in OTHERS {
        let potential = Mie { repulsive, attractive };
        let found = potential.second_virial(Jet::constant(1.0 / t)).value;
        assert!((found / b - 1.0).abs() < 1e-10, "{potential:?} {t}: {found} {b}");
    }
}

#[test]
fn third_virial_coefficients_are_those_of_the_sine_transform() {
    for [t, .., b3] in LENNARD_JONES {
        let found = Mie::LENNARD_JONES.third_virial(1.0 / t).value;
        // Half a unit of the last digit given, and the 1e-6 of what lies beyond the reach.
        assert!((found - b3).abs() < 6e-6, "{t}: {found} {b3}");
    }
}

#[test]
fn slopes_of_the_third_coefficient_are_those_of_finite_differences() {
    let at = |beta: f64| Mie::LENNARD_JONES.third_virial(beta);
    for beta in [0.4, 1.0] {
        let h = 1e-4;
        let (low, here, high) = (at(beta - h), at(beta), at(beta + h));
        let slope = (high.value - low.value) / (2.0 * h);
        let curvature = (high.x - low.x) / (2.0 * h);
        assert!((here.x / slope - 1.0).abs() < 1e-5, "{} {slope}", here.x);
        assert!((here.xx / curvature - 1.0).abs() < 1e-5, "{} {curvature}", here.xx);
    }
}

#[test]
fn good_equations_have_the_series_as_their_limit() {
    let (rho, t) = (0.005, 1.5);
    let series = virial_series(Mie::LENNARD_JONES);
    let ours = series.at(rho, t);
    for equation in [thol_2016(), pohl_2023(12.0).unwrap() as &dyn EquationOfState] {
        let theirs = equation.at(rho, t);
        // B₂ of the equations is off by up to 0.002 here, which is 5e-8 in the pressure.
        assert!((ours.pressure - theirs.pressure).abs() < 1e-7);
        assert!((ours.heat_capacity_volume - theirs.heat_capacity_volume).abs() < 5e-4);
        assert!((ours.speed_of_sound / theirs.speed_of_sound - 1.0).abs() < 1e-4);
    }
    // Both were fitted to the exact coefficient, to about three digits of 2π/3.
    let exact = Mie::LENNARD_JONES.second_virial(Jet::constant(0.5)).value;
    for equation in [thol_2016(), kolafa_nezbeda_1994() as &dyn EquationOfState] {
        let found = (equation.pressure(1e-8, 2.0) / 2e-8 - 1.0) / 1e-8;
        assert!((found - exact).abs() < 5e-3, "{found} {exact}");
    }
    // The energy equation of thermodynamics, by two routes.
    let left = rho * rho * ours.du_drho;
    let right = ours.pressure - t * ours.dp_dt;
    assert!((left - right).abs() < 1e-15);
}

#[test]
fn the_series_is_for_gases() {
    let series = virial_series(Mie::LENNARD_JONES);
    assert_eq!(series.phase(0.02, 1.0), Phase::Gas);
    assert_eq!(series.phase(0.035, 1.0), Phase::MetastableVapor);
    assert_eq!(series.saturation(1.0), None);
    let refused = series.check(0.3, 1.0).unwrap_err();
    assert!(matches!(refused, OutsideRange::Density { .. }));
    assert_eq!(refused.to_string(), "virial series covers densities up to 0.04, found 0.3");
    // The next term at ρ = 0.02 is a thousandth of the second.
    let next = series.uncertainty(0.02, 1.0).unwrap().pressure;
    assert!(next > 0.0 && next < 1e-5, "{next}");
}
