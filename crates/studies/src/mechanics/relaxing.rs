//! Relaxation: how fast sweeps converge, what a tolerance costs, and which way a correction may point.

use std::f64::consts::PI;

use lennard_integrators::BondOptions;
use lennard_integrators::bonds::relaxation;
use lennard_observables::Table;

use super::bodies::{Bodies, OF_TWO, RunSummary, distance};
use super::bodies::{projected, relaxed};
use crate::StudyError;
use crate::claims::Measured;
use crate::lab::Rig;
use crate::report::Drawn;

/// The rate of sweeps over a chain.
struct Rate {
    chain: &'static str,
    bonds: usize,
    /// Angle between neighboring bonds, rad.
    angle: f64,
    /// Over-relaxation ω.
    omega: f64,
    /// The factor by which a sweep lowers the residual, by theory.
    theory: f64,
    /// The same as measured.
    measured: f64,
}

/// The factor by which a sweep lowers the residual of a chain, from two numbers of sweeps.
fn rate(
    bonds: usize,
    angle: f64,
    over_relaxation: f64,
    few: u32,
    more: u32,
) -> Result<f64, StudyError> {
    let residual = |sweeps: u32| -> Result<f64, StudyError> {
        let options = BondOptions::Relaxation(relaxation::Options {
            sweeps,
            over_relaxation,
            ..Default::default()
        });
        let mut case = Bodies::stretching(bonds, angle)?;
        // So small that the constraints are linear, and far above rounding.
        for v in &mut case.v {
            *v *= 1e-2;
        }
        let mut rig = case.start(&options, 1e-3)?;
        // They stretch bonds at the first drift: they keep their part along the bonds.
        rig.state.velocities.clone_from(&case.v);
        Ok(rig.step()?.residual)
    };
    Ok((residual(few + more)? / residual(few)?).powf(1.0 / f64::from(more)))
}

/// Sweeps of a rate for a factor of 10⁻¹².
fn sweeps(rate: f64) -> f64 {
    -12.0 * 10.0_f64.ln() / rate.ln()
}

fn rates(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let lengths: &[usize] = if quick { &[2, 3, 5, 10] } else { &[2, 3, 5, 10, 20, 40] };
    let turn = |bonds: f64| PI / (bonds + 1.0);
    let mut rates: Vec<Rate> = Vec::new();
    let mut add = |(chain, bonds, angle, omega), theory: f64, few, more| {
        rate(bonds, angle, omega, few, more).map(|measured| {
            rates.push(Rate { chain, bonds, angle, omega, theory, measured });
        })
    };
    for bonds in lengths {
        let n = *bonds as f64 + 1.0;
        // After so many sweeps the slowest part alone is left.
        let settle = (n * n / 2.0) as u32 + 2;
        add(("straight", *bonds, 0.0, 1.0), turn(*bonds as f64).cos().powi(2), settle, 4)?;
    }
    for degrees in [30.0_f64, 60.0] {
        let theory = (0.5 * degrees.to_radians().cos()).powi(2);
        add(("at an angle", 2, degrees.to_radians(), 1.0), theory, 2, 2)?;
    }
    for bonds in [5, 10] {
        let best = 2.0 / (1.0 + turn(bonds as f64).sin());
        // Eigenvalues meet at the best ω: a little below it the rate is a clean power.
        let omega = best - 0.05;
        let half = 0.5 * omega * turn(bonds as f64).cos();
        let theory = (half + (half * half - omega + 1.0).max(0.0).sqrt()).powi(2);
        add(("over-relaxed", bonds, 0.0, omega), theory, 20, 10)?;
    }
    for rate in &rates {
        all.numbers
            .add("rate of sweeps", rate.measured)
            .of("chain", rate.chain)
            .of("n", rate.bonds)
            .of("degrees", format!("{:.0}", rate.angle.to_degrees()))
            .of("omega", format!("{:.3}", rate.omega))
            .theory(rate.theory);
    }
    let straight = rates.iter().filter(|rate| rate.chain == "straight");
    let off = straight.map(|rate| (rate.measured / rate.theory - 1.0).abs()).fold(0.0, f64::max);
    all.numbers.add("sweeps against Gauss–Seidel", off);
    let table = Table::rows_of("rates", &rates)
        .column("bonds", |r| r.bonds)
        .column("angle [rad]", |r| r.angle)
        .column("over-relaxation", |r| r.omega)
        .column("rate by theory", |r| r.theory)
        .column("rate measured", |r| r.measured)
        .column("sweeps to 1e-12 by theory", |r| sweeps(r.theory))
        .table();
    let lengths: Vec<f64> = (2..=100).map(f64::from).collect();
    let by_theory = Table::rows_of("rates by theory", &lengths)
        .column("bonds", |n| *n)
        .column("plain", |n| sweeps(turn(*n).cos().powi(2)))
        .column("best", |n| sweeps(2.0 / (1.0 + turn(*n).sin()) - 1.0));
    let drawn = table.clone().and("chain", rates.iter().map(|r| r.chain));
    let drawn = drawn.and("sweeps measured", rates.iter().map(|r| sweeps(r.measured)));
    all.given.tables.extend([drawn, by_theory.table()]);
    all.tables.push(table);
    Ok(())
}

/// RMS of the energy on two dumbbells that meet, at each tolerance and two steps.
fn tolerances(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let exponents: &[i32] = if quick { &[-3, -5, -8] } else { &[-2, -3, -4, -5, -6, -8, -10] };
    let case = Bodies::two_dumbbells()?;
    let mut runs = Vec::new();
    for steps in [1000, 4000] {
        for exponent in exponents {
            let (tolerance, dt) = (10.0_f64.powi(*exponent), 2.5 / f64::from(steps));
            if let Ok(end) = case.run(&relaxed(tolerance), 2.5, steps)? {
                runs.push((dt, tolerance, end));
            }
        }
    }
    let loose: Vec<f64> = runs.iter().filter(|run| run.1 == 1e-3).map(|run| run.2.rms).collect();
    if let [coarse, fine] = loose[..] {
        all.numbers.add("gain of a quarter of the step", fine / coarse);
    }
    let table = Table::rows_of("tolerances", &runs)
        .column("dt [tau]", |(dt, ..)| *dt)
        .column("tolerance", |(_, tolerance, _)| *tolerance)
        .column("energy RMS [epsilon]", |(.., end)| end.rms)
        // ½μ·(tol·r/h)² of both bonds, which velocities would have that kept the corrections; μ = 1/2.
        .column("bound [epsilon]", |(dt, tolerance, _)| {
            let speed = tolerance * OF_TWO / dt;
            2.0 * 0.25 * speed * speed
        })
        .column("sweeps per step", |(.., end)| end.iterations);
    all.tables.push(table.table());
    Ok(())
}

/// Angle per step of a rotor at some steps.
fn rotor(bonds: &BondOptions, alpha: f64, at: &[u32]) -> Result<(Vec<f64>, f64), StudyError> {
    let dt = 0.05;
    let mut rig = Bodies::rotor(alpha.sin() / dt)?.start(bonds, dt)?;
    let first = rig.energy();
    let angle = |rig: &Rig| {
        let d = rig.state.positions[1] - rig.state.positions[0];
        d.y.atan2(d.x)
    };
    let (mut angles, mut n) = (Vec::new(), 0);
    for stop in at {
        let mut before = angle(&rig);
        while n <= *stop {
            before = angle(&rig);
            rig.step()?;
            n += 1;
        }
        angles.push((angle(&rig) - before).rem_euclid(2.0 * PI));
    }
    Ok((angles, rig.energy() / first - 1.0))
}

/// Distance from the start after so many steps forth and as many back.
fn there_and_back(bonds: &BondOptions, steps: u32) -> Result<f64, StudyError> {
    let case = Bodies::two_dumbbells()?;
    let time = 5e-4 * f64::from(steps);
    let Ok(forth) = case.run(bonds, time, steps)? else {
        return Ok(f64::NAN);
    };
    let reversed = Bodies {
        x: forth.positions,
        v: forth.velocities.iter().map(|v| -*v).collect(),
        ..case.clone()
    };
    Ok(match reversed.run(bonds, time, steps)? {
        Ok(back) => distance(&back.positions, &case.x),
        Err(_) => f64::NAN,
    })
}

/// Measures everything.
pub(super) fn measure(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    const ALPHA: f64 = 0.1;
    rates(quick, all)?;
    tolerances(quick, all)?;
    let at: &[u32] = if quick { &[10, 100, 300] } else { &[1, 10, 30, 100, 300, 1000, 3000] };
    let (angles, _) = rotor(&projected(), ALPHA, at)?;
    let theory = |n: u32| ALPHA / (1.0 + 2.0 * ALPHA * ALPHA * f64::from(n)).sqrt();
    let slowing: Vec<(u32, f64)> = at.iter().copied().zip(angles).collect();
    for (n, angle) in &slowing {
        all.numbers.add("slowing of a rotor", *angle).of("n", n).theory(theory(*n));
    }
    let table = Table::rows_of("rotor", &slowing)
        .column("step", |(n, _)| *n)
        .column("angle by theory [rad]", |(n, _)| theory(*n))
        .column("angle measured [rad]", |(_, angle)| *angle);
    all.tables.push(table.table());
    let (old, energy) = rotor(&BondOptions::default(), ALPHA, &[100])?;
    all.numbers.add("angle of a rotor", (old[0] - ALPHA).abs());
    all.numbers.add("energy of a rotor", energy.abs());
    let tight = BondOptions::Direct(lennard_integrators::bonds::direct::Options {
        tolerance: 1e-13,
        ..Default::default()
    });
    falling_chain(quick, &tight, all)?;
    let steps = if quick { 2000 } else { 10_000 };
    for (bond, bonds) in [("old", tight), ("new", projected())] {
        all.numbers.add("distance there and back", there_and_back(&bonds, steps)?).of("bond", bond);
    }
    Ok(())
}

/// A falling chain of ten: relaxation against the direct solve, and the iterations of each.
fn falling_chain(quick: bool, tight: &BondOptions, all: &mut Measured) -> Result<(), StudyError> {
    let chain = Bodies::hanging(10, 0.2)?;
    let falling = |bonds: &BondOptions| {
        let steps = if quick { 100 } else { 1000 };
        chain.run(bonds, 1e-3 * f64::from(steps), steps).map(Result::ok)
    };
    let direct = falling(tight)?;
    for (bond, bonds) in [("old", relaxed(1e-13)), ("new", projected())] {
        let off = match (&direct, falling(&bonds)?) {
            (Some(a), Some(b)) => distance(&a.positions, &b.positions),
            _ => f64::NAN,
        };
        all.numbers.add("distance from the direct solve", off).of("bond", bond);
    }
    let of = |end: Option<RunSummary>| end.map_or(f64::NAN, |end| end.iterations);
    let mut iterations = Vec::new();
    for tolerance in [1e-4, 1e-8, 1e-12] {
        iterations.push(("relaxation", tolerance, of(falling(&relaxed(tolerance))?)));
    }
    iterations.push(("direct", 1e-13, of(direct)));
    all.numbers.add("iterations over sweeps", iterations[3].2 / iterations[2].2);
    let table = Table::rows_of("chain-iterations", &iterations)
        .column("way", |row| row.0)
        .column("tolerance", |row| row.1)
        .column("iterations per step", |row| row.2);
    all.tables.push(table.table());
    Ok(())
}
