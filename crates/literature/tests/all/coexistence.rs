//! Vapor–liquid coexistence and phases.

use lennard_literature::{EquationOfState, Phase, thol_2015, thol_2016};

fn gibbs(e: &dyn EquationOfState, rho: f64, t: f64) -> f64 {
    let s = e.at(rho, t);
    t * (rho.ln() + s.residual_helmholtz - 1.0) + s.pressure / rho
}

#[test]
fn coexisting_phases_have_equal_pressure_and_chemical_potential_up_to_the_critical_point() {
    for equation in crate::with_liquid() {
        let t_c = equation.spec().critical.temperature;
        for fraction in [0.52, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 0.999, 0.9998] {
            let t = fraction * t_c;
            let s = equation
                .saturation(t)
                .unwrap_or_else(|| panic!("{} at {fraction} T_c", equation.spec().name));
            let (liquid, vapor) = (s.liquid_density, s.vapor_density);
            assert!(
                vapor < equation.spec().critical.density
                    && equation.spec().critical.density < liquid
            );
            let gap = equation.pressure(liquid, t) - equation.pressure(vapor, t);
            // Rounding of terms of order ten.
            assert!(gap.abs() < 1e-12, "pressures differ by {gap}");
            let gap = gibbs(equation, liquid, t) - gibbs(equation, vapor, t);
            assert!(gap.abs() < 1e-11, "chemical potentials differ by {gap}");
        }
        assert_eq!(equation.saturation(t_c), None);
        assert_eq!(equation.saturation(1.5 * t_c), None);
    }
}

#[test]
fn critical_point_is_where_pressure_is_flat() {
    for equation in crate::with_liquid() {
        let c = equation.spec().critical;
        let s = equation.at(c.density, c.temperature);
        // The slope is small against T_c, the slope of the ideal gas. It is zero to the digits to
        // which the critical constraint was imposed (Thol) or solved for (Kolafa and Nezbeda).
        assert!(s.dp_drho.abs() < 3e-3 * c.temperature, "{}: {}", equation.spec().name, s.dp_drho);
    }
}

#[test]
fn metastable_and_two_phase_states_are_said_to_be_ones() {
    let e = thol_2016();
    for (rho, t, phase) in [
        (0.8442, 0.722, Phase::Liquid),
        (0.75, 0.827, Phase::MetastableLiquid),
        (0.3, 1.0, Phase::InsideDome),
        (0.035, 1.0, Phase::MetastableVapor),
        (0.02, 1.0, Phase::Gas),
        (0.9, 0.9, Phase::AboveFreezing),
        (0.89, 0.67, Phase::BelowTriplePoint),
        (0.5, 2.0, Phase::Supercritical),
        (0.5, 0.3, Phase::OutsideRange),
    ] {
        assert_eq!(e.phase(rho, t), phase, "at rho {rho} T {t}");
    }
    // The freezing line belongs to the full potential, and nothing is said about other models.
    assert_eq!(thol_2015().phase(0.9, 0.9), Phase::Liquid);
    assert_eq!(thol_2015().freezing_density(0.9), None);
}
