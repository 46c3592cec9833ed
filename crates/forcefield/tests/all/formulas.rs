//! The formulas against finite differences, known values and each other.

use lennard_core::DVec3;
use lennard_core::PeriodicBox;
use lennard_forcefield::*;

fn models() -> Vec<(ForceFieldOptions, Model)> {
    let mut all = Vec::new();
    for potential in PotentialOptions::examples() {
        for &kind in TruncationKind::ALL {
            let truncation = TruncationOptions::new(kind, 2.5);
            let options =
                ForceFieldOptions { potential, truncation, ..ForceFieldOptions::default() };
            if let Ok(model) = Model::new(&potential, &truncation) {
                all.push((options, model));
            }
        }
    }
    all
}

#[test]
fn forces_and_curvatures_are_derivatives_of_the_energy() {
    for (options, model) in models() {
        let u = |r: f64| model.eval(r * r).energy;
        let slope = |r: f64| -model.eval(r * r).force * r;
        for k in 0..200 {
            let r = 0.85 + (model.r_cut - 0.86) * f64::from(k) / 200.0;
            let pair = model.eval(r * r);
            let scale = 1.0 + pair.curvature.abs() * 20.0;
            let (du, error) = derivative(u, r);
            assert!(
                (du - slope(r)).abs() < 1e-9 * scale + error,
                "{options:?} at {r}: {du} {}",
                slope(r)
            );
            let (d2u, error) = derivative(slope, r);
            assert!(
                (d2u - pair.curvature).abs() < 1e-8 * scale + error,
                "{options:?} at {r}: {d2u} {}",
                pair.curvature
            );
        }
    }
}

/// The derivative by a central difference over ±h, with the change from 2h to h, three times the error of order h².
///
/// Rounding adds ε·f/h to the error: h = ε^{1/3}·r balances the two.
fn derivative(f: impl Fn(f64) -> f64, r: f64) -> (f64, f64) {
    let h = f64::EPSILON.cbrt() * r;
    let over = |h: f64| (f(r + h) - f(r - h)) / (2.0 * h);
    (over(h), (over(h) - over(2.0 * h)).abs())
}

#[test]
fn lennard_jones_crosses_zero_at_sigma_and_has_its_minimum_at_minus_epsilon() {
    let model = Model::new(&PotentialOptions::default(), &TruncationOptions::default()).unwrap();
    assert_eq!(model.eval(1.0).energy, 0.0);
    assert_eq!(model.eval(1.0).force, 24.0);
    let minimum = model.eval(2.0_f64.powf(1.0 / 3.0));
    assert!((minimum.energy + 1.0).abs() < 1e-15);
    assert!(minimum.force.abs() < 1e-13);
}

#[test]
fn truncations_are_as_smooth_at_the_cutoff_as_they_claim() {
    for (options, model) in models() {
        let end = model.eval(model.r_cut * model.r_cut);
        let plain =
            Model::new(&options.potential, &TruncationOptions::new(TruncationKind::Cut, 2.5))
                .unwrap();
        let jump = plain.eval(2.5_f64 * 2.5).energy;
        match (options.potential, options.truncation.kind) {
            (potential, _) if potential.own_end().is_some() => {
                assert!(end.energy.abs() < 1e-14 && end.force.abs() < 1e-13);
            }
            (_, TruncationKind::Cut) => assert_eq!(end.energy, jump),
            (_, TruncationKind::Shift) => assert_eq!(end.energy, 0.0),
            (_, TruncationKind::ForceShift) => {
                assert!(end.energy.abs() < 1e-16 && end.force.abs() < 1e-16);
            }
            (_, TruncationKind::Switch) => {
                assert!(end.energy.abs() < 1e-16 && end.force == 0.0 && end.curvature == 0.0);
                // Where the switch begins, everything still has the values of the plain potential.
                let begin = model.eval(4.0_f64);
                let same = plain.eval(4.0_f64);
                assert!((begin.energy - same.energy).abs() < 1e-16);
                assert!((begin.curvature - same.curvature).abs() < 1e-15);
            }
            (_, TruncationKind::Xplor) => {
                assert!(end.energy.abs() < 1e-16 && end.force.abs() < 1e-16);
                let (begin, same) = (model.eval(4.0_f64), plain.eval(4.0_f64));
                assert!((begin.energy - same.energy).abs() < 1e-16);
                assert!((begin.force - same.force).abs() < 1e-15);
            }
            (_, other) => panic!("say here what {other:?} claims at the cutoff"),
        }
    }
}

/// The switch in the words of HOOMD-blue's documentation of the mode "xplor".
#[test]
fn xplor_is_the_formula_of_other_programs() {
    let (on, cut) = (1.7_f64, 2.5_f64);
    let truncation = TruncationOptions {
        switch_from: Some(on),
        ..TruncationOptions::new(TruncationKind::Xplor, cut)
    };
    let plain = TruncationOptions::new(TruncationKind::Cut, cut);
    for potential in truncated_potentials() {
        let model = Model::new(&potential, &truncation).unwrap();
        let full = Model::new(&potential, &plain).unwrap();
        for k in 0..=170 {
            let r = 0.8 + 0.01 * f64::from(k);
            let width = (cut * cut - on * on).powi(3);
            let rest = cut * cut - r * r;
            let (step, slope) = if r < on {
                (1.0, 0.0)
            } else {
                let inner = cut * cut + 2.0 * r * r - 3.0 * on * on;
                let slope = 4.0 * r * (rest * rest - rest * inner) / width;
                (rest * rest * inner / width, slope)
            };
            let (found, pair) = (model.eval(r * r), full.eval(r * r));
            let energy = step * pair.energy;
            let force = step * pair.force * r - slope * pair.energy;
            let scale = 1e-14 * (1.0 + pair.force.abs());
            assert!((found.energy - energy).abs() < scale, "{potential:?} {r}");
            assert!((found.force * r - force).abs() < scale, "{potential:?} {r}");
        }
    }
}

#[test]
fn the_switch_serialises_with_its_default_start_left_out_and_comes_back() {
    for (options, _) in models() {
        let text = toml::to_string(&options).unwrap();
        assert_eq!(toml::from_str::<ForceFieldOptions>(&text).unwrap(), options, "{text}");
    }
    let bare: ForceFieldOptions = toml::from_str("[truncation]\nkind = \"shift\"\n").unwrap();
    assert_eq!(bare.truncation, TruncationOptions::new(TruncationKind::Shift, 2.5));
    let soft: ForceFieldOptions = toml::from_str("[potential]\nkind = \"soft-sphere\"\n").unwrap();
    assert_eq!(soft.potential, PotentialOptions::SoftSphere(SoftSphere { exponent: 12 }));
    assert!(
        toml::from_str::<ForceFieldOptions>("[potential]\nkind = \"wca\"\nexponent = 3\n").is_err()
    );
    assert!(toml::from_str::<ForceFieldOptions>("[truncation]\nrcut = 3.0\n").is_err());
}

/// The potentials that a truncation ends, with their options for tests.
fn truncated_potentials() -> impl Iterator<Item = PotentialOptions> {
    let all = PotentialOptions::examples().into_iter();
    all.filter(|potential| potential.own_end().is_none())
}

#[test]
fn tail_pressure_is_minus_the_volume_derivative_of_the_tail_energy() {
    for potential in truncated_potentials() {
        let options = ForceFieldOptions { potential, ..ForceFieldOptions::default() };
        let (n, v) = (864, 1023.45);
        let u = |v: f64| tail_correction(&options, n, v).unwrap().energy;
        let h = v * f64::EPSILON.cbrt();
        let slope = (u(v + h) - u(v - h)) / (2.0 * h);
        let tail = tail_correction(&options, n, v).unwrap();
        // U_tail ∝ N²/V with g = 1 holds r_cut fixed. −dU/dV has the change of density, and the virial
        // has the forces beyond r_cut. They differ by the flow through the cutoff sphere,
        // −(2π/3)ρN/V·r_cut³·U(r_cut).
        let model = Model::new(&potential, &options.truncation).unwrap();
        let r_cut = model.r_cut;
        let rho = n as f64 / v;
        let surface = 2.0 / 3.0
            * std::f64::consts::PI
            * rho
            * rho
            * r_cut.powi(3)
            * model.eval(r_cut * r_cut).energy;
        assert!((-slope - (tail.pressure - surface)).abs() < 1e-9 * tail.pressure.abs());
        assert!((tail.virial - 3.0 * v * tail.pressure).abs() < 1e-12 * tail.virial.abs());
        assert!(
            (tail.energy_per_particle * n as f64 - tail.energy).abs() < 1e-12 * tail.energy.abs()
        );
    }
}

#[test]
fn tail_integrals_are_those_of_the_potential() {
    // Simpson's rule from r_cut to END in ln r. Beyond, r⁻⁴, the slowest decay allowed, leaves 2.5/END of it.
    const END: f64 = 2.5e5;
    for potential in truncated_potentials() {
        let options = ForceFieldOptions { potential, ..ForceFieldOptions::default() };
        let model = Model::new(&potential, &options.truncation).unwrap();
        let (a, b) = (2.5_f64.ln(), END.ln());
        let steps = 20_000;
        let h = (b - a) / f64::from(steps);
        let (mut energy, mut virial) = (0.0, 0.0);
        for k in 0..=steps {
            let r = (a + h * f64::from(k)).exp();
            let weight = match k {
                0 => 1.0,
                k if k == steps => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            } * h
                / 3.0;
            let pair = model.eval(r * r);
            energy += weight * r.powi(3) * pair.energy;
            virial += weight * r.powi(5) * pair.force;
        }
        let (n, v) = (100, 250.0);
        let tail = tail_correction(&options, n, v).unwrap();
        let factor = 2.0 * std::f64::consts::PI * 100.0 * 100.0 / v;
        let near = |closed: f64, summed: f64| (closed / (factor * summed) - 1.0).abs() < 2e-5;
        assert!(near(tail.energy, energy), "{potential:?}: {tail:?} {energy}");
        assert!(near(tail.virial, virial), "{potential:?}: {tail:?} {virial}");
    }
}

#[test]
fn what_cannot_be_is_refused_with_the_key_it_is_about() {
    let cell = PeriodicBox::new(DVec3::splat(8.0)).unwrap();
    let at = Conditions { cell, n_atoms: 400, temperature: 1.0, dt: 0.005, mixture: None };
    let base = ForceFieldOptions::default();
    let with = |change: &dyn Fn(&mut ForceFieldOptions)| {
        let mut options = base;
        change(&mut options);
        match build(&options, &at) {
            Ok(_) => panic!("{options:?} was accepted"),
            Err(e) => {
                assert!(
                    !e.found().is_empty() && !e.allowed().is_empty() && !e.to_string().is_empty()
                );
                e.key()
            }
        }
    };
    assert_eq!(with(&|o| o.truncation.r_cut = 4.000_001), "truncation.r_cut");
    assert_eq!(with(&|o| o.truncation.r_cut = f64::NAN), "truncation.r_cut");
    assert_eq!(with(&|o| o.truncation.r_cut = -1.0), "truncation.r_cut");
    assert_eq!(with(&|o| o.neighbor.skin = Some(1.6)), "neighbor.skin");
    assert_eq!(with(&|o| o.neighbor.skin = Some(-0.1)), "neighbor.skin");
    assert_eq!(with(&|o| o.truncation.kind = TruncationKind::Shift), "truncation.tail_correction");
    assert_eq!(with(&|o| o.truncation.switch_from = Some(2.0)), "truncation.switch_from");
    assert_eq!(
        with(&|o| o.potential = PotentialOptions::SoftSphere(SoftSphere { exponent: 3 })),
        "potential.exponent"
    );
    assert_eq!(
        with(&|o| o.split = Some(SplitOptions { r_split: 3.0, width: 0.2 })),
        "integrator.r_split"
    );
    // Half the box is legal, and a skin that the program chooses is clamped or done without.
    let mut half = base;
    half.truncation.r_cut = 4.0;
    let few = Conditions { n_atoms: 30, ..at };
    assert_eq!(build(&half, &few).unwrap().plan().search, Search::Direct);
    assert_eq!(build(&half, &at).unwrap().plan().r_list, 4.0);
    half.truncation.r_cut = 3.9;
    assert!(build(&half, &at).unwrap().plan().r_list <= 4.0);
    let mut exact = base;
    exact.neighbor.skin = Some(1.5);
    assert_eq!(build(&exact, &at).unwrap().plan().r_list, 4.0);
}

#[test]
fn every_listed_name_is_one_that_scenes_can_use() {
    for spec in potentials() {
        toml::from_str::<PotentialOptions>(&format!("kind = \"{}\"", spec.name)).unwrap();
    }
    for spec in truncations() {
        toml::from_str::<TruncationOptions>(&format!("kind = \"{}\"", spec.name)).unwrap();
    }
}
