//! Relaxation: how fast sweeps converge, what a tolerance costs, and which way a correction may point.

use std::f64::consts::PI;

use lennard_integrators::BondOptions;
use lennard_integrators::bonds::relaxation;
use serde::Serialize;

use super::bodies::{Bodies, distance};
use super::precise::G;
use super::ways::{projected, relaxed};
use crate::StudyError;
use crate::lab::Rig;

/// The rate of sweeps over a chain.
#[derive(Debug, Clone, Serialize)]
pub struct Rate {
    /// Bonds.
    pub bonds: usize,
    /// Angle between neighboring bonds, rad.
    pub angle: f64,
    /// Over-relaxation ω.
    pub over_relaxation: f64,
    /// The factor by which a sweep lowers the residual, by theory.
    pub theory: f64,
    /// The same as measured.
    pub measured: f64,
    /// Sweeps to 10⁻¹² by the theory.
    pub sweeps: f64,
}

impl Rate {
    /// What kind of chain it belongs to.
    pub(super) fn chain(&self) -> &'static str {
        match (self.over_relaxation == 1.0, self.angle > 0.0) {
            (true, false) => "straight",
            (true, true) => "at an angle",
            (false, _) => "over-relaxed",
        }
    }
}

/// A tolerance at a step, on two dumbbells that meet.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct AtTolerance {
    /// h, τ.
    pub dt: f64,
    /// The tolerance.
    pub tolerance: f64,
    /// RMS of E − E(0), ε.
    pub energy_rms: f64,
    /// ½μ·(tol·r/h)² of both bonds, ε: what corrections would add to velocities that kept them.
    pub bound: f64,
    /// Sweeps per step.
    pub sweeps: f64,
}

/// A free rotor under projection along the new bond.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Slowing {
    /// Step number.
    pub step: u32,
    /// Angle per step there, rad.
    pub measured: f64,
    /// α₀/√(1 + 2α₀²n).
    pub theory: f64,
}

/// All of it.
#[derive(Debug, Clone, Serialize)]
pub struct Relaxing {
    /// Rates of sweeps.
    pub rates: Vec<Rate>,
    /// Tolerances at two steps.
    pub tolerances: Vec<AtTolerance>,
    /// A rotor that slows down.
    pub slowing: Vec<Slowing>,
    /// Angle per step of the same rotor along the old bond, less arcsin(Ωh), rad.
    pub rotor_off: f64,
    /// Change of its kinetic energy, relative.
    pub rotor_energy: f64,
    /// Largest distance between relaxation and direct solution on a falling chain of ten, σ.
    pub against_direct: f64,
    /// The same for projection along the new bond.
    pub new_against_direct: f64,
    /// Distance from the start after a way forth and back: direct, and along the new bond, σ.
    pub there_and_back: [f64; 2],
    /// Sweeps per step of a falling chain of ten at 10⁻⁴, 10⁻⁸, 10⁻¹², and Newton iterations of the direct way.
    pub chain_iterations: [f64; 4],
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
        let mut case = Bodies::stretching(bonds, angle);
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

fn rates(quick: bool) -> Result<Vec<Rate>, StudyError> {
    let lengths: &[usize] = if quick { &[2, 3, 5, 10] } else { &[2, 3, 5, 10, 20, 40] };
    let mut all = Vec::new();
    let mut add = |bonds, angle: f64, over_relaxation, theory: f64, few, more| {
        rate(bonds, angle, over_relaxation, few, more).map(|measured| {
            all.push(Rate {
                bonds,
                angle,
                over_relaxation,
                theory,
                measured,
                sweeps: -12.0 * 10.0_f64.ln() / theory.ln(),
            });
        })
    };
    for bonds in lengths {
        let n = *bonds as f64 + 1.0;
        let law = (PI / n).cos().powi(2);
        // After so many sweeps the slowest part alone is left.
        let settle = (n * n / 2.0) as u32 + 2;
        add(*bonds, 0.0, 1.0, law, settle, 4)?;
    }
    for degrees in [30.0_f64, 60.0] {
        let theory = (0.5 * degrees.to_radians().cos()).powi(2);
        add(2, degrees.to_radians(), 1.0, theory, 2, 2)?;
    }
    for bonds in [5, 10] {
        let best = 2.0 / (1.0 + (PI / (bonds as f64 + 1.0)).sin());
        // Eigenvalues meet at the best ω: a little below it the rate is a clean power.
        let omega = best - 0.05;
        let jacobi = (PI / (bonds as f64 + 1.0)).cos();
        let half = 0.5 * omega * jacobi;
        let theory = (half + (half * half - omega + 1.0).max(0.0).sqrt()).powi(2);
        add(bonds, 0.0, omega, theory, 20, 10)?;
    }
    Ok(all)
}

fn tolerances(quick: bool) -> Result<Vec<AtTolerance>, StudyError> {
    let exponents: &[i32] = if quick { &[-3, -5, -8] } else { &[-2, -3, -4, -5, -6, -8, -10] };
    let case = Bodies::two_dumbbells();
    let mut all = Vec::new();
    for steps in [1000, 4000] {
        for exponent in exponents {
            let (tolerance, dt) = (10.0_f64.powi(*exponent), 2.5 / f64::from(steps));
            if let Ok(end) = case.run(&relaxed(tolerance), 2.5, steps)? {
                let speed = tolerance * case.bond_length / dt;
                all.push(AtTolerance {
                    dt,
                    tolerance,
                    energy_rms: end.rms,
                    // μ = 1/2 for each of two bonds.
                    bound: 2.0 * 0.25 * speed * speed,
                    sweeps: end.iterations,
                });
            }
        }
    }
    Ok(all)
}

/// Angle per step of a rotor at some steps.
fn rotor(bonds: &BondOptions, alpha: f64, at: &[u32]) -> Result<(Vec<f64>, f64), StudyError> {
    let dt = 0.05;
    let mut rig = Bodies::rotor(alpha.sin() / dt).start(bonds, dt)?;
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
    let case = Bodies::two_dumbbells();
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
pub(crate) fn measure(quick: bool) -> Result<Relaxing, StudyError> {
    const ALPHA: f64 = 0.1;
    let at: &[u32] = if quick { &[10, 100, 300] } else { &[1, 10, 30, 100, 300, 1000, 3000] };
    let (angles, _) = rotor(&projected(), ALPHA, at)?;
    let slowing = at.iter().zip(angles).map(|(step, measured)| Slowing {
        step: *step,
        measured,
        theory: ALPHA / (1.0 + 2.0 * ALPHA * ALPHA * f64::from(*step)).sqrt(),
    });
    let (old, rotor_energy) = rotor(&BondOptions::default(), ALPHA, &[100])?;
    let falling = |bonds: &BondOptions| -> Result<_, StudyError> {
        let steps = if quick { 100 } else { 1000 };
        let chain = Bodies::hanging(10, 0.2, G);
        Ok(chain.run(bonds, 1e-3 * f64::from(steps), steps)?.ok())
    };
    let tight = BondOptions::Direct(lennard_integrators::bonds::direct::Options {
        tolerance: 1e-13,
        ..Default::default()
    });
    let direct = falling(&tight)?;
    let off = |bonds: &BondOptions| -> Result<f64, StudyError> {
        Ok(match (&direct, falling(bonds)?) {
            (Some(a), Some(b)) => distance(&a.positions, &b.positions),
            _ => f64::NAN,
        })
    };
    let iterations = |bonds: &BondOptions| -> Result<f64, StudyError> {
        Ok(falling(bonds)?.map_or(f64::NAN, |end| end.iterations))
    };
    let steps = if quick { 2000 } else { 10_000 };
    Ok(Relaxing {
        rates: rates(quick)?,
        tolerances: tolerances(quick)?,
        slowing: slowing.collect(),
        rotor_off: old[0] - ALPHA,
        rotor_energy,
        against_direct: off(&relaxed(1e-13))?,
        new_against_direct: off(&projected())?,
        there_and_back: [there_and_back(&tight, steps)?, there_and_back(&projected(), steps)?],
        chain_iterations: [
            iterations(&relaxed(1e-4))?,
            iterations(&relaxed(1e-8))?,
            iterations(&relaxed(1e-12))?,
            iterations(&tight)?,
        ],
    })
}
