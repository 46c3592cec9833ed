//! The van der Waals one-fluid theory against numbers of teqp 0.23.2 with Thol 2016.

use lennard_literature::{EquationOfState, ModelKind, OneFluid, equation_of_state_for, one_fluid};

/// A mixture of two species: σ and ε of the pairs 11, 12 and 22.
type Pairs = [[f64; 2]; 3];

/// Equal particles whose unlike pairs attract less.
const SYMMETRIC: Pairs = [[1.0, 1.0], [1.0, 0.85], [1.0, 1.0]];
/// The pairs of Kob and Andersen, outside the use of the theory: their numbers check the formula.
const KOB_ANDERSEN: Pairs = [[1.0, 1.0], [0.8, 1.5], [0.88, 0.5]];

/// x₁, T, ρ, then σ_x, ε_x, u and p.
const PREDICTIONS: [(Pairs, [f64; 7]); 4] = [
    (SYMMETRIC, [0.25, 1.5, 0.65, 1.0, 0.94375, -3.992969, 1.247529]),
    (SYMMETRIC, [0.5, 2.0, 0.4, 1.0, 0.925, -2.313914, 0.7793373]),
    (KOB_ANDERSEN, [0.8, 1.5, 0.65, 0.9401942, 1.082169, -3.924891, 0.4434816]),
    (KOB_ANDERSEN, [0.5, 2.0, 0.4, 0.87779752, 1.0633028, -1.887258, 0.602999]),
];

#[test]
fn the_one_fluid_and_its_energy_and_pressure_are_those_of_teqp() {
    for (pairs, [x, t, rho, sigma, epsilon, u, p]) in PREDICTIONS {
        let fluid = OneFluid::of(&[x, 1.0 - x], |a, b| pairs[a + b]);
        assert!((fluid.sigma - sigma).abs() < 1e-6, "{fluid:?}");
        assert!((fluid.epsilon - epsilon).abs() < 1e-6, "{fluid:?}");
        let equation = one_fluid(fluid);
        assert!((equation.potential_energy(rho, t) - u).abs() < 3e-6);
        assert!((equation.pressure(rho, t) - p).abs() < 3e-6);
        let band = equation.uncertainty(rho, t).unwrap();
        assert!((band.potential_energy + 0.01 * u).abs() < 1e-6);
        assert!((band.pressure - 0.03 * rho * t).abs() < 1e-12);
    }
}

#[test]
fn a_fluid_of_one_size_has_the_equation_of_the_pure_fluid() {
    let fluid = OneFluid::of(&[0.3, 0.7], |_, _| [1.0, 1.0]);
    assert_eq!(fluid, OneFluid { sigma: 1.0, epsilon: 1.0, mass: 1.0 });
    let pure = lennard_literature::thol_2016().at(0.8, 1.2);
    assert!((one_fluid(fluid).at(0.8, 1.2).pressure - pure.pressure).abs() < 1e-12);
    let heavy = one_fluid(fluid.with_mass(4.0)).at(0.8, 1.2);
    assert!((heavy.speed_of_sound - 0.5 * pure.speed_of_sound).abs() < 1e-12);
}

#[test]
fn unlike_sizes_have_no_theory_here() {
    let kind = |size_ratio| ModelKind::Mixture {
        fluid: OneFluid { sigma: 1.0, epsilon: 1.0, mass: 1.0 },
        size_ratio,
        r_cut: 4.0,
    };
    assert!(equation_of_state_for(kind(1.0656)).is_ok());
    let none = equation_of_state_for(kind(1.25)).unwrap_err().to_string();
    assert!(none.contains("1.250") && none.contains("up to 1.1"), "{none}");
}
