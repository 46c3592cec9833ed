use super::*;
use crate::statistics::synthetic::cover;
use crate::testing::{column, context, estimate, mixture, normal, under_friction};
use lennard_core::{State, System};

/// Langevin velocities: C(t) = 3T e^{−γt} per particle, D = T/γ; relative to the centre of mass
/// both lose 1/N.
fn ornstein_uhlenbeck(seed: u64, samples: u64) -> Findings {
    let (n, gamma, temperature) = (50, 3.0_f64, 0.8_f64);
    let context = BuildContext { dt: 0.05, ..context(10.0, n) };
    let decay = (-gamma * context.dt).exp();
    let kick = (temperature * (1.0 - decay * decay)).sqrt();
    let start = (0..n).map(|i| temperature.sqrt() * normal(seed, u64::MAX, i)).collect();
    let mut state = State::new(context.cell, vec![DVec3::ZERO; n], start);
    let mut vacf = VelocityAutocorrelation::new(&VacfOptions::default(), &context).unwrap();
    for s in 0..samples {
        vacf.sample(&View::of(&state, &System::atoms(n)));
        for (i, v) in state.velocities.iter_mut().enumerate() {
            *v = decay * *v + kick * normal(seed, s, i);
        }
    }
    vacf.finish(0.0)
}

#[test]
fn langevin_velocities_decay_exponentially_and_integrate_to_their_diffusion_coefficient() {
    let (gamma, temperature, h) = (3.0_f64, 0.8, 0.05);
    let relative = 1.0 - 1.0 / 50.0;
    let mut found = Vec::new();
    for seed in 0..24 {
        let findings = ornstein_uhlenbeck(seed, 1500);
        found.push(findings.averages[0].estimate);
        let table = &findings.tables[0];
        for k in [0, 4, 20] {
            let exact = 3.0 * temperature * relative * (-gamma * h * k as f64).exp();
            let error = table.columns[2].numbers()[k];
            assert!((table.columns[1].numbers()[k] - exact).abs() < 5.0 * error);
        }
    }
    // The trapezoidal sum of e^{−γt} is h/2·coth(γh/2) in place of 1/γ.
    let exact = temperature * relative * 0.5 * h / (0.5 * gamma * h).tanh();
    // 24 seeds know their spread to 1/√46 = 15 %: three of these.
    cover(&found, exact, 0.0, 0.45);
}

#[test]
fn each_species_has_its_function_and_its_diffusion_coefficient() {
    let species = mixture(60, |i| usize::from(i % 3 == 0));
    let context = BuildContext { dt: 0.05, species, ..context(10.0, 60) };
    let mut vacf = VelocityAutocorrelation::new(&VacfOptions::default(), &context).unwrap();
    let exact = under_friction(&context, (4, 4000), [3.0, 5.0], |view| vacf.sample(view));
    let findings = vacf.finish(0.0);
    for (name, exact) in ["A", "B"].iter().zip(exact) {
        let estimate = estimate(&findings, &format!("diffusion_coefficient_green_kubo_{name}"));
        // The centre of mass takes a share of 1/N·m_a/m̄ at most.
        let off = (estimate.mean - exact).abs();
        assert!(off < 4.0 * estimate.standard_error + 0.03 * exact, "{estimate:?} {exact}");
        assert!(estimate.standard_error < 0.05 * exact, "{estimate:?}");
    }
    // The function of all is made of its parts at each lag.
    let [whole, a, b] = ["vacf", "vacf_A", "vacf_B"].map(|name| column(&findings, name));
    for k in 0..whole.len() {
        assert!(((2.0 * a[k] + b[k]) / 3.0 - whole[k]).abs() < 1e-12);
    }
}

#[test]
fn a_run_shorter_than_the_window_gives_no_number() {
    let findings = ornstein_uhlenbeck(1, 50);
    assert!(findings.averages.is_empty() && findings.remarks.len() == 1);
}
