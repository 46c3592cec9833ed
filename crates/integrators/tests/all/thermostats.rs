//! Each heat bath against its conserved quantity and its canonical distribution.

use crate::common::{KS_LIMIT, Rig, distance_from_gamma, farthest, free, one};
use lennard_core::random::Streams;
use lennard_core::{
    Constraint, DVec3, Integrator, Momentum, NoForces, State, Step, System, Thermostat, Want,
    couple,
};
use lennard_integrators::bussi::{self, Bussi};
use lennard_integrators::langevin::{self, Langevin};
use lennard_integrators::nose_hoover::{self, NoseHoover};
use lennard_integrators::oscillator::{HarmonicForces, OscillatorConstraint};
use lennard_integrators::rescale::{self, Rescale};
use lennard_integrators::{IntegratorOptions, ThermostatOptions, build, velocity_verlet};
use std::sync::Arc;

use rand_distr::{Distribution, StandardNormal};

const TEMPERATURE: f64 = 0.722;

/// A state with positions and velocities drawn from the canonical distribution of unit oscillators.
fn canonical_start(n: usize, seed: u64, temperature: f64) -> State {
    let mut rng = Streams::new(seed).sequential("start");
    let mut draw = || {
        (0..n)
            .map(|_| {
                temperature.sqrt()
                    * DVec3::new(
                        StandardNormal.sample(&mut rng),
                        StandardNormal.sample(&mut rng),
                        StandardNormal.sample(&mut rng),
                    )
            })
            .collect::<Vec<_>>()
    };
    let positions = draw();
    free(positions, draw())
}

fn baoab(friction: f64, temperature: f64, seed: u64) -> Integrator {
    Integrator::new(Langevin::new(
        &langevin::Options { friction },
        temperature,
        Streams::new(seed).noise("langevin"),
    ))
}

fn bussi_bath(tau: f64, seed: u64) -> Bussi {
    let noise = Streams::new(seed).noise("bussi");
    Bussi::new(&bussi::Options { tau }, TEMPERATURE, noise)
}

/// The baths that scale all velocities by one factor.
fn rescaling_baths() -> [Box<dyn Thermostat>; 3] {
    let chain = NoseHoover::new(&nose_hoover::Options::default(), TEMPERATURE);
    let rescale = Rescale::new(&rescale::Options { every: 1 }, TEMPERATURE);
    [Box::new(rescale), Box::new(bussi_bath(0.5, 1)), Box::new(chain)]
}

/// Lets a bath act once, and returns the heat, or nothing where it did not act.
fn apply(bath: &mut dyn Thermostat, momentum: Momentum, state: &mut State, dt: f64) -> Option<f64> {
    let system = System::atoms(state.len());
    // A method whose motion keeps the momentum, and one whose motion does not.
    let spec = match momentum {
        Momentum::Conserved => &velocity_verlet::SPEC,
        Momentum::Free => &langevin::SPEC,
    };
    let mut forces = NoForces;
    let mut s = Step::new(&system, state, &mut forces, spec, dt, Want::NOTHING);
    couple(bath, &mut s).then(|| s.finish().heat)
}

/// Particles on springs under a method.
fn on_springs(method: Integrator, state: State, stiffness: f64, dt: f64) -> Rig<HarmonicForces> {
    Rig::of(method, (System::atoms(state.len()), state), HarmonicForces::new(stiffness), dt)
}

/// How far kinetic energies are from the canonical distribution of n_dof = 2·shape.
fn distance_from_canonical(kinetic: Vec<f64>, shape: u32) -> f64 {
    distance_from_gamma(kinetic.into_iter().map(|k| k / TEMPERATURE), shape)
}

#[test]
fn the_distance_from_the_canonical_distribution_sees_a_wrong_one() {
    // Microcanonical samples, all at the mean, and samples that are 3 % too hot.
    let n = 20_000;
    let at_mean = vec![3.0 * TEMPERATURE; n];
    assert!(distance_from_canonical(at_mean, 3) > 10.0 * KS_LIMIT);
    let mut rng = Streams::new(5).sequential("gamma");
    let chi_squared = rand_distr::ChiSquared::new(6.0).unwrap();
    let right: Vec<f64> =
        (0..n).map(|_| 0.5 * TEMPERATURE * chi_squared.sample(&mut rng)).collect();
    let hot = right.iter().map(|k| 1.03 * k).collect();
    assert!(distance_from_canonical(hot, 3) > KS_LIMIT);
    assert!(distance_from_canonical(right, 3) < KS_LIMIT);
}

#[test]
fn rescaling_sets_exactly_the_wanted_temperature_on_its_steps_and_nothing_on_others() {
    let mut bath = Rescale::new(&rescale::Options { every: 5 }, TEMPERATURE);
    let system = System::atoms(100);
    let mut state = canonical_start(100, 2, 1.7);
    for step in 1..=10 {
        state.step = step;
        let before = system.kinetic_energy(&state.velocities);
        let heat = apply(&mut bath, Momentum::Conserved, &mut state, 0.005);
        let after = system.kinetic_energy(&state.velocities);
        assert_eq!(heat.is_some(), step % 5 == 0);
        // What it says it put in is what the kinetic energy gained, but for the rounding of each velocity and of the sum.
        let off = heat.unwrap_or(0.0) - (after - before);
        assert!(off.abs() <= 16.0 * f64::EPSILON * before, "{off:e}");
        if heat.is_some() {
            // One square root, one product a component and a sum of 300 terms.
            let t = system.temperature(&state.velocities, Momentum::Conserved);
            assert!((t / TEMPERATURE - 1.0).abs() < 1e-14, "T = {t}");
        }
    }
}

#[test]
fn baths_leave_a_system_at_rest_at_rest() {
    for mut bath in rescaling_baths() {
        let mut state = free(vec![DVec3::ZERO; 3], vec![DVec3::ZERO; 3]);
        let heat = apply(bath.as_mut(), Momentum::Conserved, &mut state, 0.005);
        assert_eq!(heat, None);
        assert_eq!(state.velocities, [DVec3::ZERO; 3]);
    }
}

/// Kinetic energies of an ideal gas with n_dof = 6 under stochastic rescaling, a sample every step.
fn kinetic_energies_under_bussi(steps: u64, dt_over_tau: f64, seed: u64) -> Vec<f64> {
    let mut bath = bussi_bath(0.5, seed);
    let system = System::atoms(3);
    let mut state = canonical_start(3, seed, TEMPERATURE);
    (1..=steps)
        .map(|step| {
            state.step = step;
            apply(&mut bath, Momentum::Conserved, &mut state, 0.5 * dt_over_tau);
            system.kinetic_energy(&state.velocities)
        })
        .collect()
}

#[test]
fn stochastic_rescaling_samples_the_canonical_kinetic_energy() {
    // Six relaxation times a step: successive samples share e^{−6} = 0.2 % of their deviation.
    let kinetic = kinetic_energies_under_bussi(40_000, 6.0, 11);
    assert!(distance_from_canonical(kinetic.clone(), 3) < KS_LIMIT);

    // Moments of K = ½T·χ²(6): mean 3T, variance 3T², skewness 2/√3 with fourth cumulant 18·T⁴.
    let n = kinetic.len() as f64;
    let mean = kinetic.iter().sum::<f64>() / n;
    let variance = kinetic.iter().map(|k| (k - mean).powi(2)).sum::<f64>() / n;
    let mean_error = (3.0 * TEMPERATURE.powi(2) / n).sqrt();
    // Var(s²) = (κ₄ + 2σ⁴)/n with κ₄ = 18·T⁴ and σ² = 3·T².
    let variance_error = TEMPERATURE.powi(2) * ((18.0 + 18.0) / n).sqrt();
    assert!((mean - 3.0 * TEMPERATURE).abs() < 4.0 * mean_error);
    assert!((variance - 3.0 * TEMPERATURE.powi(2)).abs() < 4.0 * variance_error);
}

#[test]
fn stochastic_rescaling_relaxes_with_its_time_constant() {
    // ⟨δK(0)·δK(dt)⟩/⟨δK²⟩ = e^{−dt/τ} exactly; measured with dt = τ/2 over n steps, whose
    // statistical error is below √((1 + ρ²)/(1 − ρ²)/n) for an autoregressive process.
    let kinetic = kinetic_energies_under_bussi(60_000, 0.5, 12);
    let n = kinetic.len() as f64;
    let mean = 3.0 * TEMPERATURE;
    let variance = kinetic.iter().map(|k| (k - mean).powi(2)).sum::<f64>() / n;
    let lagged = kinetic.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum::<f64>() / (n - 1.0);
    let rho = (-0.5_f64).exp();
    let error = ((1.0 + rho * rho) / (1.0 - rho * rho) / n).sqrt();
    assert!((lagged / variance - rho).abs() < 4.0 * error, "{}", lagged / variance);
}

#[test]
fn stochastic_rescaling_serves_a_single_degree_of_freedom() {
    // n_dof = 1: K = ½T·χ²(1), mean ½T, variance ½T²; the velocity must change its sign at times.
    // Two rigid constraints leave one of the three degrees of freedom.
    let rigid = || -> Arc<dyn Constraint> { Arc::new(OscillatorConstraint::new(0.0, 0.0)) };
    let mut system = System::atoms(1);
    system.constraints = vec![rigid(), rigid()];
    assert_eq!(system.n_dof(Momentum::Conserved), 1.0);
    let mut bath = bussi_bath(0.5, 13);
    let mut state = one(DVec3::ZERO, DVec3::X);
    let n = 20_000_u64;
    let (mut sum, mut positive) = (0.0, 0_u64);
    for step in 1..=n {
        state.step = step;
        let mut forces = NoForces;
        let spec = &velocity_verlet::SPEC;
        let mut step = Step::new(&system, &mut state, &mut forces, spec, 3.0, Want::NOTHING);
        couple(&mut bath, &mut step);
        sum += system.kinetic_energy(&state.velocities);
        positive += u64::from(state.velocities[0].x > 0.0);
    }
    let n = n as f64;
    assert!((sum / n - 0.5 * TEMPERATURE).abs() < 4.0 * TEMPERATURE * (0.5 / n).sqrt());
    assert!((positive as f64 / n - 0.5).abs() < 4.0 * 0.5 / n.sqrt());
}

#[test]
fn energy_minus_heat_is_conserved_under_rescaling_and_stochastic_rescaling() {
    // With velocity Verlet on unit oscillators the energy oscillates by a relative (ωh)²/8 about its
    // shadow. The heat enters in between, so E − Σ heat stays within a few such amplitudes.
    let (n, dt, omega) = (200, 0.02, 1.0);
    for options in [
        ThermostatOptions::Rescale(rescale::Options { every: 7 }),
        ThermostatOptions::Bussi(bussi::Options { tau: 0.3 }),
        ThermostatOptions::NoseHoover(nose_hoover::Options { tau: 0.3, chain: 3 }),
    ] {
        let method = build(&IntegratorOptions::default());
        let noise = Streams::new(3).noise("heat");
        let method = options.couple(method, TEMPERATURE.into(), noise);
        let state = canonical_start(n, 4, 3.0 * TEMPERATURE);
        let mut rig = on_springs(method, state, omega * omega, dt);
        let (start, mut total_heat) = (rig.conserved(), 0.0_f64);
        for _ in 0..2000 {
            rig.step();
            total_heat = total_heat.max(rig.heat.abs());
            let deviation = (rig.conserved() - start).abs() / start;
            assert!(
                deviation < 3.0 * (omega * dt).powi(2) / 8.0,
                "{}: {deviation:e}",
                options.name()
            );
        }
        // The bath did cool the system: the book-keeping had something to keep.
        assert!(total_heat > 0.3 * start);
    }
}

#[test]
fn baths_keep_the_direction_of_momentum() {
    let system = System::atoms(50);
    for mut bath in rescaling_baths() {
        let mut state = canonical_start(50, 6, 1.0);
        let mean = system.momentum(&state.velocities) / 50.0;
        for v in &mut state.velocities {
            *v -= mean;
        }
        for step in 0..100 {
            state.step = step;
            apply(bath.as_mut(), Momentum::Conserved, &mut state, 0.1);
        }
        // 100 products of 50 numbers of the order 1.
        assert!(system.momentum(&state.velocities).length() < 1e-11);
    }
}

#[test]
fn langevin_samples_the_canonical_kinetic_energy_of_an_ideal_gas() {
    // Pairs of free particles, each pair a system with n_dof = 6, started at rest: after 8 friction
    // times e^{−16} of the start is left.
    let pairs = 20_000;
    let state = canonical_start(2 * pairs, 7, 0.0);
    let rig = on_springs(baoab(2.0, TEMPERATURE, 21), state, 0.0, 0.5).steps(8);
    let kinetic = rig
        .state
        .velocities
        .chunks(2)
        .map(|v| 0.5 * (v[0].length_squared() + v[1].length_squared()))
        .collect();
    assert!(distance_from_canonical(kinetic, 3) < KS_LIMIT);
    // All the energy there is came in as heat; 8 differences of sums of 120,000 terms.
    assert!((rig.heat / rig.kinetic_energy() - 1.0).abs() < 1e-12);
}

#[test]
fn langevin_gives_oscillators_their_exact_spread_at_any_step() {
    // BAOAB on ẍ = −ω²x: ⟨x²⟩ = T/ω² for every h, ⟨v²⟩ = T·(1 − (ωh)²/4)
    // (Leimkuhler and Matthews 2013, section III).
    let n = 20_000;
    for (dt, steps) in [(0.5, 60), (1.5, 30)] {
        let start = canonical_start(n, 8, 0.3);
        let state = on_springs(baoab(1.0, TEMPERATURE, 22), start, 1.0, dt).steps(steps).state;
        let mean_square =
            |a: &[DVec3]| a.iter().map(|x| x.length_squared()).sum::<f64>() / (3 * n) as f64;
        // 60,000 independent normal numbers: relative error of the variance √(2/60,000).
        let error = (2.0 / (3 * n) as f64).sqrt();
        let x2 = mean_square(&state.positions) / TEMPERATURE;
        let v2 = mean_square(&state.velocities) / TEMPERATURE;
        assert!((x2 - 1.0).abs() < 4.0 * error, "dt {dt}: {x2}");
        let expected = 1.0 - 0.25 * dt * dt;
        assert!((v2 / expected - 1.0).abs() < 4.0 * error, "dt {dt}: {v2}");
    }
}

#[test]
fn energy_minus_heat_is_conserved_under_langevin_up_to_the_square_of_the_step() {
    let n = 2000;
    let spread = |dt: f64| {
        let runs = 12;
        let sum: f64 = (0..runs)
            .map(|seed| {
                let state = canonical_start(n, 100 + seed, TEMPERATURE);
                let rig = on_springs(baoab(1.0, TEMPERATURE, 200 + seed), state, 1.0, dt);
                let start = rig.conserved();
                (rig.steps((10.0 / dt).round() as u32).conserved() - start).powi(2)
            })
            .sum();
        (sum / runs as f64 / n as f64).sqrt() / TEMPERATURE
    };
    let (coarse, fine) = (spread(0.2), spread(0.1));
    // The steps' own energy error is of the order (ωh)²/8 for a particle with three components.
    assert!(coarse < 0.2_f64.powi(2) && fine < 0.1_f64.powi(2));
    // A spread from 12 runs is known to 1/√24 = 20 %: the ratio 4 within two such errors, doubled.
    assert!((1.6..10.0).contains(&(coarse / fine)), "{}", coarse / fine);
}

#[test]
fn langevin_without_friction_is_velocity_verlet() {
    let n = 20;
    let [bath, verlet] = [baoab(1e-300, 1.0, 1), build(&IntegratorOptions::default())]
        .map(|method| on_springs(method, canonical_start(n, 9, 1.0), 1.0, 0.1).steps(100));
    // The drift in two halves rounds differently: 100 steps of an ulp each.
    assert!(farthest(&bath.state.positions, &verlet.state.positions) < 1e-13);
    assert!(bath.heat.abs() < 1e-13);
}
