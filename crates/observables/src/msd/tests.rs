use super::*;
use crate::statistics::synthetic::cover;
use crate::testing::{column, context, estimate, normal, view_of};

/// Feeds a path, one position array a sample.
fn follow(
    options: &MsdOptions,
    context: &BuildContext,
    samples: u64,
    mut positions: impl FnMut(u64) -> Vec<DVec3>,
) -> MeanSquareDisplacement {
    let mut msd = MeanSquareDisplacement::new(options, context).unwrap();
    for s in 0..samples {
        view_of(&context.cell, positions(s), |view| msd.sample(view));
    }
    msd
}

#[test]
fn free_flight_gives_the_square_of_speed_times_time_at_every_lag() {
    // Opposite velocities: the centre of mass rests, and a common drift of 5 σ/τ is taken out.
    let context = context(10.0, 2);
    let v = DVec3::new(0.3, -0.2, 0.6);
    let drift = DVec3::new(5.0, 0.0, 0.0);
    let msd = follow(&MsdOptions::default(), &context, 700, |s| {
        let t = s as f64 * 0.01;
        vec![(drift + v) * t, (drift - v) * t]
    });
    let table = &msd.finish(0.0).tables[0];
    let longest = table.columns[0].numbers().pop().unwrap();
    assert!(longest > 4.0);
    for (t, m) in table.columns[0].numbers().iter().zip(&table.columns[1].numbers()) {
        let exact = v.length_squared() * t * t;
        // Positions near 35 carry rounding of 4e-15; the shortest displacement is 7e-3.
        assert!((m / exact - 1.0).abs() < 1e-10, "{t}: {m} {exact}");
    }
}

#[test]
fn brownian_motion_gives_its_diffusion_coefficient_and_the_spread_of_seeds_its_error() {
    let n = 40;
    let context = context(10.0, n);
    let (exact, seeds) = (0.05_f64, 24);
    let step = (2.0 * exact * context.dt).sqrt();
    let one = |seed| {
        let mut path = vec![DVec3::ZERO; n];
        let msd = follow(&MsdOptions::default(), &context, 2000, |s| {
            for (i, r) in path.iter_mut().enumerate() {
                *r += step * normal(seed, s, i);
            }
            path.clone()
        });
        estimate(&msd.finish(0.0), UNCORRECTED)
    };
    let found: Vec<_> = (0..seeds).map(one).collect();
    // Independent particles relative to their centre of mass diffuse with D(1 − 1/N). 24 seeds know their spread to 1/√46 = 15 %;
    // printed errors are known better: three of these.
    cover(&found, exact * (1.0 - 1.0 / n as f64), 0.0, 0.45);
}

#[test]
fn ballistic_lags_are_left_out_of_the_fit() {
    // Langevin velocities with friction γ = 2: msd = (6T/γ)(t − (1 − e^{−γt})/γ), D = T/γ.
    let n = 100;
    let context = BuildContext { dt: 0.05, ..context(10.0, n) };
    let (gamma, h) = (2.0_f64, 0.05);
    let decay = (-gamma * h).exp();
    let mut v: Vec<DVec3> = (0..n).map(|i| normal(7, u64::MAX, i)).collect();
    let mut r = vec![DVec3::ZERO; n];
    // The exact joint update of position and velocity of the Ornstein–Uhlenbeck process.
    let vv = 1.0 - decay * decay;
    let rr = (2.0 * h - (3.0 - 4.0 * decay + decay * decay) / gamma) / gamma;
    let rv = (1.0 - decay).powi(2) / gamma;
    let msd = follow(&MsdOptions::default(), &context, 10_000, |s| {
        for i in 0..n {
            let (a, b) = (normal(8, s, i), normal(9, s, i));
            r[i] +=
                (1.0 - decay) / gamma * v[i] + rv / vv.sqrt() * a + (rr - rv * rv / vv).sqrt() * b;
            v[i] = decay * v[i] + vv.sqrt() * a;
        }
        r.clone()
    });
    let findings = msd.finish(0.0);
    let found = estimate(&findings, UNCORRECTED);
    let exact = 0.5 * (1.0 - 1.0 / n as f64);
    assert!(found.standard_error < 0.05 * exact);
    // Four standard errors and what the rest of the transient, e^{−γt} at t ≈ 2, can do.
    assert!(
        (found.mean - exact).abs() < 4.0 * found.standard_error + 0.01 * exact,
        "{found:?} {:?}",
        findings.remarks
    );
    let table = &findings.tables[0];
    for k in [3, 15, 30] {
        let t = table.columns[0].numbers()[k];
        let curve = 6.0 / gamma * (t - (1.0 - (-gamma * t).exp()) / gamma) * 0.99;
        let error = table.columns[2].numbers()[k];
        assert!((table.columns[1].numbers()[k] - curve).abs() < 5.0 * error);
    }
}

#[test]
fn the_finite_size_correction_is_that_of_yeh_and_hummer() {
    let with = |viscosity| {
        let options = MsdOptions { viscosity, ..MsdOptions::default() };
        let mut path = [DVec3::ZERO; 4];
        follow(&options, &context(10.0, 4), 400, |s| {
            for (i, r) in path.iter_mut().enumerate() {
                *r += 0.1 * normal(3, s, i);
            }
            path.to_vec()
        })
    };
    // At rest T = 0 and the correction vanishes; with T = 0.72 set by hand, L = 10, η = 3.0 it is
    // 2.837297·0.72/(6π·3·10).
    let mut msd = with(Some(3.0));
    msd.temperatures = 0.72 * msd.samples() as f64;
    let findings = msd.finish(0.0);
    let difference = estimate(&findings, CORRECTED).mean - estimate(&findings, UNCORRECTED).mean;
    assert!((difference - 0.003_612_558_7).abs() < 1e-9, "{difference}");
    assert!(with(None).finish(0.0).remarks_in_words().contains("not corrected"));
}

#[test]
fn each_species_has_its_displacement_and_its_diffusion_coefficient() {
    let n = 60;
    let context = BuildContext {
        species: crate::testing::mixture(n, |i| usize::from(i % 3 == 0)),
        ..context(10.0, n)
    };
    let exact = [0.05_f64, 0.2];
    let mut path = vec![DVec3::ZERO; n];
    let msd = follow(&MsdOptions::default(), &context, 4000, |s| {
        for (i, r) in path.iter_mut().enumerate() {
            let d = exact[context.species.of(i)];
            *r += (2.0 * d * context.dt).sqrt() * normal(17, s, i);
        }
        path.clone()
    });
    let findings = msd.finish(0.0);
    let all = estimate(&findings, UNCORRECTED).mean;
    let found = ["A", "B"].map(|a| estimate(&findings, &format!("{UNCORRECTED}_{a}")));
    for (found, exact) in found.iter().zip(exact) {
        // The centre of mass takes and gives a few per cent: below the error.
        assert!((found.mean - exact).abs() < 4.0 * found.standard_error, "{found:?}");
        assert!(found.standard_error < 0.1 * exact);
    }
    assert!((all - 0.1).abs() < 0.01, "{all}");
    // x_b·D_a + x_a·D_b with x_a = 2/3: the slow species counts for its small share of the others.
    let darken = estimate(&findings, "mutual_diffusion_darken");
    assert!((darken.mean - (found[0].mean / 3.0 + 2.0 * found[1].mean / 3.0)).abs() < 1e-12);
    assert!((darken.mean - 0.15).abs() < 4.0 * darken.standard_error);
    assert!(darken.standard_error < 0.015, "{darken:?}");
    // The mean of all is made of its parts at each lag.
    let [whole, a, b] = ["msd", "msd_A", "msd_B"].map(|name| column(&findings, name));
    for k in 0..whole.len() {
        assert!(((2.0 * a[k] + b[k]) / 3.0 / whole[k] - 1.0).abs() < 1e-12);
    }
}

/// Shows positions in boxes that change.
fn follow_in_boxes(
    context: &BuildContext,
    samples: u64,
    mut of: impl FnMut(u64) -> (DVec3, Vec<DVec3>),
) -> MeanSquareDisplacement {
    let mut msd = MeanSquareDisplacement::new(&MsdOptions::default(), context).unwrap();
    for s in 0..samples {
        let (sides, positions) = of(s);
        let cell = lennard_core::PeriodicBox::new(sides).unwrap();
        crate::testing::view_of(&cell, positions, |view| msd.sample(view));
    }
    msd
}

/// The sides of a box whose axes change by a few per cent, each in its own way.
fn sides(s: u64) -> DVec3 {
    let t = s as f64;
    10.0 * (DVec3::ONE + 0.05 * DVec3::new((0.3 * t).sin(), (0.17 * t).cos(), (0.05 * t).sin()))
}

#[test]
fn what_a_changing_box_moves_is_no_displacement() {
    let n = 20;
    let context = context(10.0, n);
    let at = crate::testing::random_positions(n, 30.0, 5);
    let msd = follow_in_boxes(&context, 300, |s| {
        let scaled = at.iter().map(|r| *r / 10.0 * sides(s)).collect();
        (sides(s), scaled)
    });
    let findings = msd.finish(0.0);
    let curve = findings.tables[0].columns[1].numbers();
    // Roundings of positions of 30 σ.
    assert!(curve.iter().all(|m| *m < 1e-24), "{curve:?}");
    assert!(findings.remarks_in_words().contains("the box changed"));
}

#[test]
fn particles_diffuse_in_a_changing_box_as_in_one_that_stays() {
    let (n, samples) = (50, 3000);
    let context = context(10.0, n);
    let step = |s: u64, i: usize| 0.03 * normal(21, s, i);
    let mut path = vec![DVec3::ZERO; n];
    let still = follow_in_boxes(&context, samples, |s| {
        path.iter_mut().enumerate().for_each(|(i, r)| *r += step(s, i));
        (DVec3::splat(10.0), path.clone())
    });
    // The same steps, in a box that scales all positions after each of them.
    let mut path = vec![DVec3::ZERO; n];
    let changing = follow_in_boxes(&context, samples, |s| {
        path.iter_mut().enumerate().for_each(|(i, r)| *r += step(s, i));
        let shown = (sides(s), path.clone());
        path.iter_mut().for_each(|r| *r *= sides(s + 1) / sides(s));
        shown
    });
    let curve = |msd: &MeanSquareDisplacement| msd.finish(0.0).tables[0].columns[1].numbers();
    let (still, changing) = (curve(&still), curve(&changing));
    for (k, (a, b)) in still.iter().zip(&changing).enumerate() {
        // Half of a per cent of change of the box between two samples, in no direction that counts.
        assert!((a / b - 1.0).abs() < 0.01, "{k}: {a} {b}");
    }
    assert!(*still.last().unwrap() > 1.0);
}
