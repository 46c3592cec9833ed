//! The two-center equations against values of teqp 0.23.2, and against coexistence computed with it.

use lennard_literature::{EquationOfState, ModelKind, equation_of_state_for, two_center};

/// L, T, ρ, and then p and u of Lísal 2004, p and u of Mecke 1997.
const STATES: &[[f64; 7]] = &[
    [0.22, 4.5, 0.3, 0.5168692, -7.9002521, 0.51716669, -7.9087501],
    [0.22, 3.5, 0.6, 0.82531878, -15.717584, 0.83072539, -15.705737],
    [0.3292, 4.0, 0.05, 0.16907901, -1.3620591, 0.16904061, -1.3736222],
    [0.3292, 2.3, 0.62, 0.71648454, -16.157484, 0.73918259, -16.135032],
    [0.505, 3.2, 0.05, 0.13265446, -1.2913986, 0.13246366, -1.3086849],
    [0.505, 1.8, 0.52, 0.37565271, -13.080083, 0.38074936, -13.060393],
    [0.67, 2.6, 0.05, 0.10348926, -1.2867598, 0.10334233, -1.2997485],
    [0.67, 1.6, 0.46, 0.69508364, -11.321027, 0.69738616, -11.341165],
    [1.0, 2.5, 0.05, 0.10833973, -1.1695174, 0.10944564, -1.1499404],
    [1.0, 2.2, 0.3, 0.98692486, -6.8332835, 2.6407542, -7.3026796],
];

/// L, T, vapor pressure, densities of liquid and vapor: Lísal 2004, then Mecke 1997.
const COEXISTENCE: &[(usize, [f64; 5])] = &[
    (1, [0.22, 2.9847155, 0.041033536, 0.63608345, 0.015417878]),
    (1, [0.3292, 3.2420156, 0.15973763, 0.43565841, 0.075367981]),
    (1, [0.505, 2.2626996, 0.050778944, 0.42899397, 0.028367693]),
    (1, [0.67, 1.6659184, 0.014240736, 0.41886572, 0.0095968892]),
    (1, [1.0, 1.5475634, 0.038955689, 0.16868877, 0.038440985]),
    (0, [0.22, 3.4099462, 0.1018804, 0.57316873, 0.037414094]),
    (0, [0.3292, 3.4196687, 0.21547036, 0.381297, 0.11233171]),
    (0, [0.505, 2.5329313, 0.10308437, 0.36647646, 0.061648416]),
    (0, [0.67, 1.880114, 0.0348903, 0.37849624, 0.023162438]),
    (0, [1.0, 1.7604747, 0.068760824, 0.23219643, 0.070289547]),
];

#[test]
fn pressures_and_energies_are_those_of_another_implementation() {
    for [l, t, rho, p_lisal, u_lisal, p_mecke, u_mecke] in STATES {
        let equations = two_center(*l).expect("a bond length in range");
        for (equation, p, u) in [(equations[0], p_lisal, u_lisal), (equations[1], p_mecke, u_mecke)]
        {
            let state = equation.at(*rho, *t);
            let name = &equation.spec().name;
            assert!(
                (state.pressure - p).abs() < 2e-7 * p.abs().max(1.0),
                "{name} {l} {t}: {state:?} {p}"
            );
            assert!(
                (state.potential_energy - u).abs() < 2e-7 * u.abs().max(1.0),
                "{name} {l} {t}: {state:?} {u}"
            );
        }
    }
}

/// Where the two equations disagree, a verdict must not be sharper than they are.
#[test]
fn the_uncertainty_at_a_state_is_the_difference_of_the_two_equations() {
    for [l, t, rho, p_lisal, u_lisal, p_mecke, u_mecke] in STATES {
        for equation in two_center(*l).expect("a bond length in range") {
            let own = equation.uncertainty(*rho, *t).expect("known for each state");
            let wanted_p = (p_lisal - p_mecke).abs().max(0.02);
            let wanted_u = (u_lisal - u_mecke).abs().max(0.02);
            assert!((own.pressure - wanted_p).abs() < 1e-5, "{l} {t} {rho}: {own:?}");
            assert!((own.potential_energy - wanted_u).abs() < 1e-5, "{l} {t} {rho}: {own:?}");
        }
    }
}

#[test]
fn vapor_and_liquid_coexist_where_another_implementation_has_them() {
    for (which, [l, t, p, liquid, vapor]) in COEXISTENCE {
        let equation = two_center(*l).expect("a bond length in range")[*which];
        let s = equation.saturation(*t).expect("below the critical point");
        assert!((s.pressure / p - 1.0).abs() < 1e-5, "{l} {t}: {s:?} {p}");
        assert!((s.liquid_density / liquid - 1.0).abs() < 1e-5, "{l} {t}: {s:?}");
        assert!((s.vapor_density / vapor - 1.0).abs() < 1e-5, "{l} {t}: {s:?}");
    }
}

#[test]
fn the_critical_point_ends_the_slope_and_the_curvature_of_the_isotherm() {
    for l in [0.22, 0.505, 0.67, 1.0] {
        for equation in two_center(l).unwrap() {
            let critical = equation.spec().critical;
            let slope = |rho: f64| equation.at(rho, critical.temperature).dp_drho;
            assert!(slope(critical.density).abs() < 1e-6);
            let h = 0.01 * critical.density;
            assert!(slope(critical.density - h) > 0.0 && slope(critical.density + h) > 0.0);
        }
    }
}

#[test]
fn rigid_dumbbells_have_an_equation_where_their_bond_is_in_range() {
    let model = |bond_length| ModelKind::TwoCenter { bond_length, r_cut: 3.0 };
    assert_eq!(equation_of_state_for(model(0.67)).unwrap().spec().key, "lisal-2004");
    let none = equation_of_state_for(model(1.5)).unwrap_err().to_string();
    assert!(none.contains("bonds of 1.5 σ"), "{none}");
    // Half the degrees of freedom of a rigid dumbbell.
    let thin = two_center(0.67).unwrap()[0].at(1e-6, 2.5);
    assert!((thin.heat_capacity_volume - 2.5).abs() < 1e-3);
}

#[test]
fn a_state_outside_the_range_is_refused_with_short_numbers() {
    let equation = two_center(0.67).unwrap()[0];
    for (rho, temperature) in [(0.3, 0.1), (0.3, 50.0), (0.9, 2.0)] {
        let words = equation.check(rho, temperature).unwrap_err().to_string();
        let digits = |word: &str| word.chars().filter(char::is_ascii_digit).count();
        assert!(words.split(' ').all(|word| digits(word) < 9), "{words}");
    }
}
