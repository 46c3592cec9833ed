//! Definitions of the thermodynamic quantities, on states whose values are known by hand.

use lennard_core::{DMat3, DVec3, Energetics, State, System, TailCorrection};

use super::*;
use crate::PressureTensor;
use crate::testing::{context, estimate, normal};

/// Two Lennard-Jones particles at distance σ along (2, 1, 2)/3: U = 0, F = 24 ε/σ outwards, W = 24 ε, and
/// ∇²U = 2·(U″ + 2U′/r) with U″ = 24·(26 − 7) = 456, U′ = −24.
fn pair_at_sigma() -> State {
    let direction = DVec3::new(2.0, 1.0, 2.0) / 3.0;
    let v = DVec3::new(0.5, -0.25, 1.0);
    let mut state = State::new(context(10.0, 2).cell, vec![direction, DVec3::ZERO], vec![v, -v]);
    let force = 24.0 * direction;
    state.forces = vec![force, -force];
    state.energetics = Energetics {
        potential_energy: Some(0.0),
        conserved_potential: Some(0.016_316_891_136),
        virial: Some(DMat3::from_cols(
            force * direction.x,
            force * direction.y,
            force * direction.z,
        )),
        laplacian: Some(2.0 * (456.0 - 48.0)),
        virial_trace: None,
        pairs: Some(1),
        per_particle: None,
    };
    state
}

#[test]
fn a_pair_at_sigma_has_the_values_worked_out_by_hand() {
    let context = context(10.0, 2);
    let system = System::atoms(2);
    let state = pair_at_sigma();
    let tail = TailCorrection { energy_per_particle: -0.5, pressure: -0.25 };
    let mut thermodynamics = Thermodynamics::new(&context);
    let mut tensor = PressureTensor::new(&context);
    let view = View { tail: Some(tail), heat: 0.3, ..View::of(&state, &system) };
    thermodynamics.sample(&view);
    tensor.sample(&view);
    let rows = thermodynamics.series();
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-13 * b.abs().max(1.0), "{a} {b}");
    // K = v² = 1.3125, n_dof = 3: T = 0.875; ρ = 0.002, V = 1000.
    close(rows.temperature[0], 0.875);
    close(rows.kinetic_energy[0], 0.656_25);
    let pressure = 0.002 * 0.875 + 24.0 / 3000.0;
    close(rows.pressure_without_tail[0], pressure);
    close(rows.pressure[0], pressure - 0.25);
    close(rows.potential_energy_without_tail[0], 0.0);
    close(rows.potential_energy[0], -0.5);
    close(rows.conserved_energy[0], 0.656_25 + (0.016_316_891_136 - 0.3) / 2.0);
    close(rows.squared_force[0], 576.0);
    close(rows.laplacian[0], 408.0);
    let findings = thermodynamics.finish(0.0);
    close(estimate(&findings, "configurational_temperature").mean, 576.0 / 408.0);
    assert!(estimate(&findings, "pressure").standard_error.is_nan());

    let findings = tensor.finish(0.0);
    let p = |ab: &str| estimate(&findings, &format!("pressure_{ab}")).mean;
    close((p("xx") + p("yy") + p("zz")) / 3.0, rows.pressure[0]);
    // Off the diagonal: 2·v_a·v_b·(3N/n_dof = 2) + 24·n_a·n_b over V.
    close(p("xy"), (-0.5 + 24.0 * 2.0 / 9.0) / 1000.0);
    close(p("xz"), (2.0 + 24.0 * 4.0 / 9.0) / 1000.0);
    close(p("yz"), (-1.0 + 24.0 * 2.0 / 9.0) / 1000.0);
}

#[test]
fn half_steps_add_the_kicks_of_both_sides_to_temperature_and_pressure() {
    let context = context(10.0, 2);
    let system = System::atoms(2);
    let state = pair_at_sigma();
    let mut thermodynamics = Thermodynamics::new(&context);
    let mut tensor = PressureTensor::new(&context);
    let view = View { half_kick_step: Some(0.01), ..View::of(&state, &system) };
    thermodynamics.sample(&view);
    tensor.sample(&view);
    let rows = thermodynamics.series();
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-13 * b.abs().max(1.0), "{a} {b}");
    // Velocities half a step on are v ± 0.005·24·n: ΣF² = 2·24², so that K gains (h²/8)·1152 = 0.0144, and T two
    // thirds of that.
    let half = 0.875 + 2.0 / 3.0 * 0.0144;
    close(rows.temperature[0], 0.875);
    close(rows.temperature_of_positions[0], half);
    close(rows.kinetic_energy[0], 0.656_25);
    close(rows.pressure[0], 0.002 * half + 24.0 / 3000.0);
    // What is conserved knows nothing of it.
    close(rows.conserved_energy[0], 0.656_25 + 0.016_316_891_136 / 2.0);
    let p = |ab: &str| estimate(&tensor.finish(0.0), &format!("pressure_{ab}")).mean;
    close((p("xx") + p("yy") + p("zz")) / 3.0, rows.pressure[0]);
    let findings = thermodynamics.finish(0.0);
    close(estimate(&findings, "temperature_half_steps").mean, half);

    // A method without half steps has none to show.
    let mut other = Thermodynamics::new(&context);
    other.sample(&View { half_kick_step: None, ..view });
    assert!(!other.has_half_steps());
    close(other.series().temperature_of_positions[0], 0.875);
    assert!(other.finish(0.0).averages.iter().all(|a| a.name != "temperature_half_steps"));
}

#[test]
fn an_ideal_gas_of_any_size_has_the_pressure_of_its_density_and_temperature() {
    for n in [2, 3, 50] {
        let context = context(5.0, n);
        let system = System::atoms(n);
        let mut velocities: Vec<DVec3> = (0..n).map(|i| normal(1, 0, i)).collect();
        let mean = velocities.iter().sum::<DVec3>() / n as f64;
        velocities.iter_mut().for_each(|v| *v -= mean);
        let mut state = State::new(context.cell, vec![DVec3::ZERO; n], velocities);
        state.energetics = Energetics {
            potential_energy: Some(0.0),
            virial: Some(DMat3::ZERO),
            ..Energetics::default()
        };
        let options = ThermodynamicsOptions { configurational_temperature: false };
        let mut thermodynamics = Thermodynamics::with_options(&options, &context);
        thermodynamics.sample(&View::of(&state, &system));
        let rows = thermodynamics.series();
        let exact = n as f64 / 125.0 * rows.temperature[0];
        assert!((rows.pressure[0] / exact - 1.0).abs() < 1e-14);
    }
}

/// Shows `samples` states with the energetics that `set` gives.
fn sampled(
    thermodynamics: &mut Thermodynamics,
    context: &BuildContext,
    samples: u64,
    mut set: impl FnMut(u64, &mut State) -> f64,
) {
    let system = System::atoms(context.n_atoms);
    let mut state = State::new(
        context.cell,
        vec![DVec3::ZERO; context.n_atoms],
        vec![DVec3::ZERO; context.n_atoms],
    );
    for s in 0..samples {
        state.time = s as f64 * context.sample_interval();
        state.energetics = Energetics {
            potential_energy: Some(0.0),
            virial: Some(DMat3::ZERO),
            laplacian: Some(1.0),
            ..Energetics::default()
        };
        let heat = set(s, &mut state);
        thermodynamics.sample(&View { heat, ..View::of(&state, &system) });
    }
}

#[test]
fn harmonic_particles_at_temperature_t_have_that_configurational_temperature() {
    // U = ½kx² with x of variance T/k: |∇U|² = k²x², ∇²U = 3k for each particle.
    let (n, k, temperature) = (20, 50.0, 0.7_f64);
    let context = context(5.0, n);
    let mut thermodynamics = Thermodynamics::new(&context);
    sampled(&mut thermodynamics, &context, 2000, |s, state| {
        for (i, f) in state.forces.iter_mut().enumerate() {
            *f = -k * (temperature / k).sqrt() * normal(2, s, i);
        }
        state.energetics.laplacian = Some(3.0 * k * n as f64);
        0.0
    });
    let found = estimate(&thermodynamics.finish(0.0), "configurational_temperature");
    // 3·20·2000 independent squares of a normal variable: relative error √(2/120 000).
    let exact_error = temperature * (2.0_f64 / 120_000.0).sqrt();
    assert!((found.mean - temperature).abs() < 4.0 * exact_error);
    assert!((found.standard_error / exact_error - 1.0).abs() < 0.15);
}

#[test]
fn a_force_that_jumps_at_the_cutoff_adds_its_delta_function_to_the_laplacian() {
    // U = k(r − r_cut) inside r_cut, in a gas so hot that g = 1: ⟨∇²U⟩ = ⟨|∇U|²⟩/T vanishes to first order
    // in k. The part without the delta function is ½ρ∫4πr²·2·(2k/r) dr = 4πρk r_cut² per particle, of the N − 1 others.
    let context = context(5.0, 100);
    let k = 0.039;
    let regular = 4.0 * std::f64::consts::PI * 0.8 * 0.99 * k * 2.5 * 2.5;
    let mut thermodynamics = Thermodynamics::new(&context);
    thermodynamics.set_ends(vec![PairEnd { r_cut: 2.5, slope: k, shift: 0.0 }]);
    sampled(&mut thermodynamics, &context, 4000, |s, state| {
        for (i, r) in state.positions.iter_mut().enumerate() {
            // Normal points three sides wide, folded into the box, are uniform.
            *r = 15.0 * normal(6, s, i);
        }
        state.energetics.laplacian = Some(regular * 100.0);
        0.0
    });
    let left = statistics::estimate_stationary(&thermodynamics.series().laplacian);
    assert!(left.mean.abs() < 4.0 * left.standard_error, "{left:?}");
    assert!(left.standard_error < 0.03 * regular, "{left:?}");
}

#[test]
fn drift_and_fluctuation_of_the_conserved_energy_are_those_put_in_and_heat_is_no_drift() {
    let n = 10;
    let context = BuildContext { dt: 0.05, ..context(5.0, n) };
    let mut thermodynamics = Thermodynamics::new(&context);
    let (slope, ripple) = (2e-6, 1e-4);
    sampled(&mut thermodynamics, &context, 4000, |s, state| {
        let sign = if s % 2 == 0 { 1.0 } else { -1.0 };
        let heat = 0.5 * state.time;
        let total = n as f64 * (slope * state.time + sign * ripple) + heat;
        state.energetics.conserved_potential = Some(total);
        state.velocities[0] = DVec3::new(0.0, 0.0, 0.03);
        // The kinetic energy is part of the conserved one: the same at each sample.
        heat
    });
    let found = thermodynamics.conservation();
    // The ripple itself adds √12·1e-4/(200·√4000)/√4000-like terms, below 1e-10 over a time of 200.
    assert!((found.energy_drift_per_atom_per_tau - slope).abs() < 1e-9, "{found:?}");
    assert!((found.energy_rms_per_atom / ripple - 1.0).abs() < 1e-3);
    assert!((found.momentum_per_atom - 0.003).abs() < 1e-15);
    assert!(found.energy_drift_standard_error < 1e-7);
}

#[test]
fn all_averages_of_a_run_share_one_equilibration_cut() {
    let n = 5;
    let context = context(5.0, n);
    let mut thermodynamics = Thermodynamics::new(&context);
    sampled(&mut thermodynamics, &context, 3000, |s, state| {
        let noise = normal(4, s, 0);
        let transient = 10.0 * (-(s as f64) / 60.0).exp();
        state.energetics.potential_energy = Some(n as f64 * (-6.0 + 0.1 * noise.x + transient));
        state.energetics.virial = Some(DMat3::from_diagonal(noise));
        state.velocities[0] = normal(5, s, 1);
        0.0
    });
    let findings = thermodynamics.finish(thermodynamics.equilibrium().discarded);
    let cut = estimate(&findings, "potential_energy").equilibration_cut;
    assert!((200..900).contains(&cut), "{cut}");
    for a in &findings.averages {
        assert_eq!(a.estimate.equilibration_cut, cut, "{}", a.name);
    }
    let energy = estimate(&findings, "potential_energy");
    assert!((energy.mean + 6.0).abs() < 5.0 * energy.standard_error + 1e-3);
    // Against a line the error gains the fluctuation of the temperature, here independent of U.
    let slope = 3.0;
    let temperature = estimate(&findings, "temperature");
    let rows = thermodynamics.series();
    let (u, t) = (&rows.potential_energy, &rows.temperature_of_positions);
    let against = statistics::about_line(u, t, slope, cut as usize);
    let exact = energy.standard_error.hypot(slope * temperature.standard_error);
    assert!((against.standard_error / exact - 1.0).abs() < 0.1);
    assert_eq!(against.mean, energy.mean);
}
