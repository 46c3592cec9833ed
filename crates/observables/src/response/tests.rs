use super::*;
use crate::series::Columns;
use crate::statistics::mean;
use crate::statistics::synthetic::{cover, printed_and_spread};
use crate::testing::context;
use lennard_core::random::Streams;
use rand_distr::{Distribution, StandardNormal};

/// A box of side 10 with a thousand particles: ρ = 1.
const N: usize = 1000;

fn setting(ensemble: Ensemble) -> Setting {
    Setting {
        ensemble,
        curvature: Some(Curvature { of_virial: 19.0, of_energy: 72.0, of_truncated: false }),
        n_dof: 3.0 * N as f64 - 3.0,
        mass: 1.0,
        volume: 1000.0,
    }
}

/// Rows of T, U, W and K per particle, with V/N = 1 and no tail.
fn rows(samples: &[[f64; 4]]) -> ThermoSeries {
    let mut rows = ThermoSeries::default();
    for (at, [t, u, w, k]) in samples.iter().enumerate() {
        let names = rows.names();
        let row = names.iter().map(|name| match *name {
            "time" => at as f64,
            "temperature" | "temperature_of_positions" => *t,
            "kinetic_energy" => *k,
            "potential_energy" | "sampled_potential_energy" => *u,
            "pressure" | "pressure_without_tail" => t + w / 3.0,
            "sampled_potential_energy_squared" | "sampled_energy_squared" => u * u,
            "virial" => *w,
            "virial_squared" => w * w,
            "sampled_energy_virial" => u * w,
            "sampled_energy_kinetic" => u * k,
            "inverse_kinetic_energy" => 1.0 / k,
            "virial_over_kinetic" => w / k,
            "virial_squared_over_kinetic" => w * w / k,
            _ => 0.0,
        });
        let row: Vec<f64> = row.collect();
        for (column, value) in rows.columns_mut().into_iter().zip(row) {
            column.push(value);
        }
    }
    rows
}

fn named(averages: &[Average], name: &str) -> crate::Estimate {
    averages.iter().find(|a| a.name == name).unwrap().estimate
}

/// U ∝ V^(−n/3) for each term of Lennard-Jones, and W = n·U.
#[test]
fn the_second_derivative_by_the_volume_is_that_of_powers() {
    let setting = setting(Ensemble::Canonical);
    for n in [6.0, 12.0] {
        let found = ensembles::second_volume_derivative(&setting, 1.0, n, 0.0);
        assert!((found - n / 3.0 * (n / 3.0 + 1.0)).abs() < 1e-12, "{n}: {found}");
    }
}

#[test]
fn an_ideal_gas_at_constant_energy_has_its_textbook_values() {
    let t = 1.5;
    let k = 0.5 * t * (3.0 * N as f64 - 3.0) / N as f64;
    let rows = rows(&[[t, 0.0, 0.0, k]; 64]);
    let found = averages(&setting(Ensemble::Microcanonical), &rows, 0, &context(10.0, N));
    for (name, expected) in [
        ("heat_capacity_pressure", 2.5),
        ("thermal_pressure_coefficient", 1.0),
        ("isothermal_compressibility", 1.0 / t),
        ("thermal_expansion", 1.0 / t),
        ("speed_of_sound", (5.0 * t / 3.0).sqrt()),
        ("joule_thomson_coefficient", 0.0),
        ("grueneisen_parameter", 2.0 / 3.0),
    ] {
        let value = named(&found, name).mean;
        // One part in N of what the kept momentum takes.
        assert!((value - expected).abs() < 2e-3, "{name}: {value} {expected}");
    }
}

/// U with this variance and a slow part, W that follows U with noise of its own, and K that `kinetic` gives of what U deviates by.
fn correlated(
    noise: &str,
    (seed, samples): (u64, usize),
    variance: f64,
    kinetic: impl Fn(f64) -> f64,
) -> Vec<[f64; 4]> {
    let noise = Streams::new(seed).noise(noise);
    let mut slow = 0.0_f64;
    (0..samples)
        .map(|at| {
            let mut rng = noise.at(at as u64, 0);
            let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
            slow = 0.8 * slow + 0.6 * draw();
            let u = variance.sqrt() * slow;
            // var(u), cov(u, w) = 17·var(u), var(w) above by an own part.
            let w = 17.0 * u + 0.1 * draw();
            [1.2, -5.0 + u, 1.0 + w, kinetic(u)]
        })
        .collect()
}

fn canonical(seed: u64, samples: usize) -> Vec<[f64; 4]> {
    correlated("response", (seed, samples), 7.2e-4, |_| 1.8)
}

#[test]
fn the_canonical_values_are_the_derivatives_of_the_helmholtz_energy() {
    let rows = rows(&canonical(1, 60_000));
    let found = averages(&setting(Ensemble::Canonical), &rows, 0, &context(10.0, N));
    let (n, t, beta) = (N as f64, 1.2, 1.0 / 1.2);
    let (uu, uw, ww) = (7.2e-4, 17.0 * 7.2e-4, 289.0 * 7.2e-4 + 0.01);
    let (a01, a20) = (beta / 3.0, -beta * beta * n * uu);
    let a11 = a01 - beta * beta * n * uw / 3.0;
    let second = (21.0 * 1.0 - 72.0 * -5.0) / 9.0;
    let a02 = beta * (second - beta * n * ww / 9.0) - 2.0 * a01;
    let (g, k, c_v) = (1.0 + a01 - a11, 1.0 + 2.0 * a01 + a02, 1.5 - a20);
    for (name, expected) in [
        ("heat_capacity_pressure", c_v + g * g / k),
        ("thermal_pressure_coefficient", g),
        ("isothermal_compressibility", 1.0 / (t * k)),
        ("thermal_expansion", g / (t * k)),
        ("speed_of_sound", (t * (k + g * g / c_v)).sqrt()),
        ("joule_thomson_coefficient", -(a01 + a02 + a11) / (g * g + c_v * k)),
        ("density_scaling_exponent", (a11 - a01) / a20),
        ("energy_virial_correlation", uw / (uu * ww).sqrt()),
    ] {
        let value = named(&found, name);
        let off = (value.mean - expected).abs();
        assert!(off < 4.0 * value.standard_error + 1e-9, "{name}: {value:?} {expected}");
        assert!(value.standard_error < 0.1 * expected.abs(), "{name}: {value:?}");
    }
}

#[test]
fn errors_cover_the_scatter_over_seeds() {
    let one = |seed: u64| {
        let rows = rows(&canonical(100 + seed, 6000));
        let found = averages(&setting(Ensemble::Canonical), &rows, 0, &context(10.0, N));
        let names =
            ["speed_of_sound", "isothermal_compressibility", "thermal_pressure_coefficient"];
        names.map(|name| named(&found, name))
    };
    let found: Vec<_> = (0..40).map(one).collect();
    for at in 0..3 {
        let (_, ratio) = printed_and_spread(&found.iter().map(|f| f[at]).collect::<Vec<_>>());
        // Forty seeds know their spread to 11 %: three of these.
        assert!((0.6..1.35).contains(&ratio), "{at}: {ratio}");
    }
}

/// Constant energy: K takes what U gives.
fn microcanonical(seed: u64, samples: usize) -> Vec<[f64; 4]> {
    let kinetic = 0.5 * 1.2 * (3.0 * N as f64 - 3.0) / N as f64;
    correlated("constant energy", (seed, samples), 4e-4, |u| kinetic - u)
}

#[test]
fn at_constant_energy_the_scaling_exponent_is_the_slope_of_w_in_u_with_an_error_that_covers() {
    // The formula has no U: W against 1/K stands for W against U, and both bring the same slope.
    let one = |seed: u64| {
        let rows = rows(&microcanonical(seed, 6000));
        let setting = setting(Ensemble::Microcanonical);
        let found = averages(&setting, &rows, 0, &context(10.0, N));
        named(&found, "density_scaling_exponent")
    };
    let found: Vec<_> = (0..40).map(one).collect();
    cover(&found, 17.0 / 3.0, 0.0, 0.4);
}

#[test]
fn without_the_second_derivative_what_needs_it_is_left_out_by_name() {
    let bent = Setting { curvature: None, ..setting(Ensemble::Canonical) };
    let rows = rows(&canonical(1, 2000));
    let found = averages(&bent, &rows, 0, &context(10.0, N));
    let names: Vec<&str> = found.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "thermal_pressure_coefficient",
            "grueneisen_parameter",
            "density_scaling_exponent",
            "energy_virial_correlation"
        ]
    );
    let said = remark(&bent).to_string();
    assert!(said.contains("speed_of_sound") && said.contains("not given"), "{said}");
}

#[test]
fn a_fluid_that_separates_has_no_compressibility_and_says_why() {
    // The variance of W in a box of two phases is larger than any single phase has.
    let mut samples = canonical(2, 20_000);
    for [.., w, _] in &mut samples {
        *w *= 4.0;
    }
    let found = averages(&setting(Ensemble::Canonical), &rows(&samples), 0, &context(10.0, N));
    assert!(named(&found, COMPRESSIBILITY).mean < 0.0);
    for average in &found {
        let needs = RESPONSES.iter().any(|r| r.name == average.name && r.needs_curvature);
        let why = format!("{:?}", average.doubt);
        assert_eq!(why.contains("no stable phase"), needs, "{}: {why}", average.name);
    }
}

/// Oscillators in a bath with a weak friction: exactly canonical, with slow exchange of K + U, and fast exchange between both.
fn oscillators(seed: u64, samples: usize) -> Vec<[f64; 4]> {
    /// How much a sample forgets.
    const FORGOTTEN: f64 = 0.02;
    let noise = Streams::new(seed).noise("oscillators");
    // Frequencies differ: equal ones would keep K − U together.
    let turns: Vec<(f64, f64)> =
        (0..OSCILLATORS).map(|i| (0.4 + 1.5 * i as f64 / OSCILLATORS as f64).sin_cos()).collect();
    let (kept, new) = (1.0 - FORGOTTEN, (1.0 - (1.0 - FORGOTTEN).powi(2)).sqrt());
    let mut rng = noise.at(0, 0);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut states: Vec<[f64; 2]> = (0..OSCILLATORS).map(|_| [draw(), draw()]).collect();
    (0..samples)
        .map(|_| {
            let (mut k, mut u) = (0.0, 0.0);
            for ([x, p], (sin, cos)) in states.iter_mut().zip(&turns) {
                (*x, *p) = (cos * *x + sin * *p, cos * *p - sin * *x);
                *p = kept * *p + new * draw();
                (k, u) = (k + 0.5 * *p * *p, u + 0.5 * *x * *x);
            }
            let n = N as f64;
            [1.0, u / n, 3.0 * u / n, k / n]
        })
        .collect()
}

const OSCILLATORS: usize = 60;

/// K and U of a run fluctuate together, though their true correlation is zero: what the run owes to it goes, and the error with it.
#[test]
fn a_known_correlation_takes_noise_out_of_the_heat_capacity_and_the_error_covers() {
    let context = context(10.0, N);
    let exact = 1.5 + 0.5 * OSCILLATORS as f64 / N as f64;
    let (mut found, mut plain) = (Vec::new(), Vec::new());
    for seed in 0..60 {
        let mut rows = rows(&oscillators(seed, 4000));
        let estimate = |rows: &ThermoSeries| {
            let n_dof = OSCILLATORS as f64;
            crate::heat_capacity::average(Ensemble::Canonical, rows, 0, &context, n_dof)
                .unwrap()
                .estimate
        };
        found.push(estimate(&rows));
        // Without K there is nothing to take out.
        rows.kinetic_energy.fill(0.0);
        rows.sampled_energy_kinetic.fill(0.0);
        plain.push(estimate(&rows));
    }
    let pulls = |found: &[crate::Estimate]| {
        let pull = |e: &crate::Estimate| ((e.mean - exact) / e.standard_error).powi(2);
        (mean(&found.iter().map(pull).collect::<Vec<f64>>())).sqrt()
    };
    let spread = |found: &[crate::Estimate]| {
        let squares: Vec<f64> = found.iter().map(|e| (e.mean - exact).powi(2)).collect();
        mean(&squares).sqrt()
    };
    // 60 seeds know a spread to 9 %.
    assert!(spread(&found) < 0.8 * spread(&plain), "{} {}", spread(&found), spread(&plain));
    assert!((pulls(&found) - 1.0).abs() < 0.35, "{}", pulls(&found));
}

#[test]
fn a_bulk_modulus_that_may_be_zero_gives_no_compressibility() {
    // Of W the rows have a little too much, as near a critical point: κ_T would be any large number.
    let found = |scale: f64, steps: usize| {
        let mut samples = canonical(2, steps);
        for [.., w, _] in &mut samples {
            *w *= scale;
        }
        let setting = setting(Ensemble::Canonical);
        averages(&setting, &rows(&samples), 0, &context(10.0, N))
    };
    let plain = found(1.0, 20_000);
    assert!(plain.iter().all(|a| a.doubt.is_none()), "{plain:?}");
    let scales = (100..400).map(|k| f64::from(k) / 100.0);
    let near = scales
        .map(|scale| found(scale, 2_000))
        .find(|found| {
            let kappa = found.iter().find(|a| a.name == COMPRESSIBILITY).unwrap();
            kappa.estimate.mean > 0.0 && kappa.doubt.is_some()
        })
        .expect("between one phase and two");
    for average in &near {
        let why = format!("{:?}", average.doubt);
        assert_eq!(
            why.contains("1/κ_T"),
            OVER_BULK_MODULUS.contains(&average.name.as_str()),
            "{}: {why}",
            average.name
        );
        if let Some(crate::Doubt::TooShort { longer, .. }) = &average.doubt {
            assert!(*longer > 1.0, "{why}");
        }
    }
}

/// κ is the inverse of a bulk modulus B that is r of its errors from zero. With B̂ = B(1 + z/r), κ̂ is within two errors of κ where
/// |z|(1 + z/r) ≤ 2. Below r = 8 that is wrong for large z alone.
#[test]
fn inverses_from_five_errors_on_have_errors_that_nearly_cover() {
    let covered = |r: f64| {
        let largest = 0.5 * ((r * r + 8.0 * r).sqrt() - r);
        let smallest = if r > 8.0 { 0.5 * ((r * r - 8.0 * r).sqrt() - r) } else { -r };
        // The normal distribution between both, by the midpoint rule.
        let step = (largest - smallest) / 1000.0;
        let at = |k: i32| smallest + step * (f64::from(k) + 0.5);
        let density = |z: f64| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
        (0..1000).map(|k| step * density(at(k))).sum::<f64>()
    };
    assert!(covered(FEWEST_ERRORS_FROM_ZERO) > 0.935);
    // A stricter bar takes numbers away for little.
    assert!(covered(0.8 * FEWEST_ERRORS_FROM_ZERO) < 0.935);
    let doubted = |errors: f64| {
        let estimate = crate::Estimate {
            mean: 0.1,
            standard_error: 0.1 / errors,
            n_effective: 1e3,
            least_effective: 1e3,
            freedom: 64.0,
            equilibration_cut: 0,
        };
        let values = vec![(estimate, Vec::new()); RESPONSES.len()];
        why_unresolved(&values).is_some()
    };
    assert!(doubted(0.98 * FEWEST_ERRORS_FROM_ZERO) && !doubted(1.02 * FEWEST_ERRORS_FROM_ZERO));
}
