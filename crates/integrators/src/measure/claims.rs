//! The claims of the literature on the Verlet family, each as a number that a run gives.

use glam::DVec2;
use lennard_core::{Backend, DVec3, Integrator, PeriodicBox, State, StepError, System, Want};

use super::order::{ErrorPoint, Orders};
use super::{Kepler, KeplerForces, run};
use crate::stormer_verlet::{Recurrence, StepRule};
use crate::{IntegratorEntry, IntegratorOptions, build};

fn stormer_verlet_run(
    orbit: &Kepler,
    velocity: DVec3,
    dt: f64,
    steps: u64,
    mut look: impl FnMut(&State),
) -> Result<(), StepError> {
    let mut state = orbit.start();
    state.velocities[0] = velocity;
    let mut integrator = build(&IntegratorOptions::StormerVerlet(Default::default()));
    look(&state);
    run(&mut integrator, &System::atoms(1), &mut KeplerForces, &mut state, dt, steps, |s, _| {
        look(s)
    })
}

/// The global orders of Störmer–Verlet with each of two starts: (x₁ = x₀ + h·v₀ + ½h²·a₀,
/// x₁ = x₀ + h·v₀).
///
/// Leaving out the last term is starting the same method with the velocity v₀ − ½h·a₀.
///
/// # Errors
/// As the method's own steps.
pub fn start_orders(duration: f64, steps: &[u64]) -> Result<(Orders, Orders), StepError> {
    let orbit = Kepler::for_orders();
    let (x, v) = orbit.at(duration);
    let with_start = |share: f64| -> Result<Orders, StepError> {
        let mut points = Vec::new();
        for &n in steps {
            let dt = duration / n as f64;
            let start = orbit.at(0.0).1 - share * 0.5 * dt * orbit.acceleration(0.0);
            let mut end = orbit.start();
            stormer_verlet_run(&orbit, start, dt, n, |s| end.clone_from(s))?;
            points.push(ErrorPoint {
                dt,
                position: (end.positions[0] - x).length(),
                velocity: (end.velocities[0] - v).length(),
            });
        }
        Ok(points.into())
    };
    Ok((with_start(0.0)?, with_start(1.0)?))
}

/// Errors of three velocities made from the positions of Störmer–Verlet near the time `duration`, each
/// as (dt, error) for each number of steps. The central velocity is (x_{n+1} − x_{n−1})/(2h) at t_n.
/// The velocity of half steps is (x_{n+1} − x_n)/h at t_n + h/2, and the early velocity is the same at
/// t_{n+1}.
///
/// # Errors
/// As the method's own steps.
pub fn velocity_estimate_errors(
    duration: f64,
    steps: &[u64],
) -> Result<[Vec<(f64, f64)>; 3], StepError> {
    let orbit = Kepler::for_orders();
    let mut found = [const { Vec::new() }; 3];
    for &n in steps {
        let dt = duration / n as f64;
        let mut positions = Vec::new();
        stormer_verlet_run(&orbit, orbit.at(0.0).1, dt, n + 1, |s| {
            positions.push(s.positions[0]);
        })?;
        let n = n as usize;
        let (before, now, after) = (positions[n - 1], positions[n], positions[n + 1]);
        let forward = (after - now) / dt;
        let estimates = [
            ((after - before) / (2.0 * dt), duration),
            (forward, duration + 0.5 * dt),
            (forward, duration + dt),
        ];
        for (errors, (velocity, time)) in found.iter_mut().zip(estimates) {
            errors.push((dt, (velocity - orbit.at(time).1).length()));
        }
    }
    Ok(found)
}

/// The discretisation error of Störmer–Verlet on ẍ = w²x, whose solution e^{wt} it follows with
/// x_n = e^{wt}·(1 − C·(wh)²·w·t + offset).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExponentialError {
    /// C, from the end of a run that starts on the growing root, x₁ = q₊; theory 1/24.
    pub coefficient_from_root: f64,
    /// C, as the slope in w·t of the relative error after the Taylor start; theory 1/24.
    pub coefficient_from_slope: f64,
    /// The offset in units of (wh)² that the Taylor start leaves; theory −1/16.
    pub taylor_offset: f64,
}

/// Measures [`ExponentialError`] at w·h = `wh` (w = 1) over `steps` steps.
///
/// The start x₁ = q₊ = 1 + ½(wh)² + wh·√(1 + ¼(wh)²) is the Taylor start of the velocity
/// w·√(1 + ¼(wh)²). The slope comes from the second half of the run, where the decaying root that the
/// Taylor start also excites has died out.
///
/// # Errors
/// As the method's own steps.
pub fn exponential_error(wh: f64, steps: u64) -> Result<ExponentialError, StepError> {
    let relative_errors = |velocity: f64| -> Result<Vec<f64>, StepError> {
        let mut state =
            State::new(PeriodicBox::boundless(), vec![DVec3::X], vec![DVec3::X * velocity]);
        let mut integrator = build(&IntegratorOptions::StormerVerlet(Default::default()));
        let mut forces = crate::oscillator::HarmonicForces::new(-1.0);
        let mut errors = vec![0.0];
        run(&mut integrator, &System::atoms(1), &mut forces, &mut state, wh, steps, |s, _| {
            let t = wh * s.step as f64;
            errors.push(s.positions[0].x / t.exp() - 1.0);
        })?;
        Ok(errors)
    };
    let end = steps as usize;
    let middle = end / 2;
    let time = wh * steps as f64;
    let root = relative_errors((1.0 + 0.25 * wh * wh).sqrt())?;
    let taylor = relative_errors(1.0)?;
    let scale = wh * wh;
    let slope = (taylor[end] - taylor[middle]) / (wh * (end - middle) as f64);
    Ok(ExponentialError {
        coefficient_from_root: -root[end] / (scale * time),
        coefficient_from_slope: -slope / scale,
        taylor_offset: (taylor[end] - slope * time) / scale,
    })
}

/// Position errors of Störmer–Verlet under a changing step at t ≈ `duration`, as (mean step, error) for
/// each number of steps. The three rules are the plain, the time-corrected and the more exact rule.
///
/// The step is h·(1 + ½·sin 2t), a smooth function of time.
///
/// # Errors
/// As the method's own steps.
pub fn variable_step_errors(
    duration: f64,
    steps: &[u64],
) -> Result<[Vec<(f64, f64)>; 3], StepError> {
    let orbit = Kepler::for_orders();
    let system = System::atoms(1);
    let mut found = [const { Vec::new() }; 3];
    let rules = [StepRule::Plain, StepRule::TimeCorrected, StepRule::MoreExact];
    for (errors, rule) in found.iter_mut().zip(rules) {
        for &n in steps {
            let mean = duration / n as f64;
            let step_at = |t: f64| mean * (1.0 + 0.5 * (2.0 * t).sin());
            let mut state = orbit.start();
            // The specification that allows the step to change; the rule is what is compared.
            let mut recurrence =
                Integrator::new(Recurrence::new(rule, &crate::stormer_variable::SPEC));
            let forces: &mut dyn Backend = &mut KeplerForces;
            let first = step_at(0.0);
            recurrence.start(&system, &mut state, forces, first, Want::NOTHING)?;
            while state.time < duration {
                let dt = step_at(state.time);
                recurrence.step(&system, &mut state, forces, dt, Want::NOTHING)?;
            }
            let exact = orbit.at(state.time).0;
            errors.push((mean, (state.positions[0] - exact).length()));
        }
    }
    Ok(found)
}

/// Errors of a single step from exact values, each as (dt, error).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OneStepErrors {
    /// Position by the two-step recurrence from two exact positions; theory h⁴.
    pub recurrence_position: Vec<(f64, f64)>,
    /// Central velocity from two exact positions; theory h².
    pub central_velocity: Vec<(f64, f64)>,
    /// Position by velocity Verlet from exact position and velocity; theory h³.
    pub velocity_verlet_position: Vec<(f64, f64)>,
    /// Velocity by velocity Verlet from exact position and velocity; theory h³.
    pub velocity_verlet_velocity: Vec<(f64, f64)>,
}

/// Measures [`OneStepErrors`] on the ellipse for each step.
///
/// The recurrence starts from the exact x(−h) as from the velocity (x₀ − x(−h))/h + ½h·a₀.
///
/// # Errors
/// As the method's own steps.
pub fn one_step_errors(steps: &[f64]) -> Result<OneStepErrors, StepError> {
    let orbit = Kepler::for_orders();
    let mut found = OneStepErrors::default();
    for &dt in steps {
        let (x_before, _) = orbit.at(-dt);
        let (x_now, _) = orbit.at(0.0);
        let (x, v) = orbit.at(dt);
        let start = (x_now - x_before) / dt + 0.5 * dt * orbit.acceleration(0.0);
        let mut end = DVec3::ZERO;
        stormer_verlet_run(&orbit, start, dt, 1, |s| end = s.positions[0])?;
        found.recurrence_position.push((dt, (end - x).length()));
        let central = (x - x_before) / (2.0 * dt);
        let exact = orbit.at(0.0).1;
        found.central_velocity.push((dt, (central - exact).length()));

        let mut state = orbit.start();
        let mut verlet = build(&IntegratorOptions::VelocityVerlet(Default::default()));
        run(&mut verlet, &System::atoms(1), &mut KeplerForces, &mut state, dt, 1, |_, _| {})?;
        found.velocity_verlet_position.push((dt, (state.positions[0] - x).length()));
        found.velocity_verlet_velocity.push((dt, (state.velocities[0] - v).length()));
    }
    Ok(found)
}

/// How well a run keeps its energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyError {
    /// The largest |E − E₀| of the run's first half, ε.
    pub first_half: f64,
    /// The largest |E − E₀| of its second half, ε: no larger where nothing drifts.
    pub second_half: f64,
}

/// Measures [`EnergyError`] of a method on the oscillator ω = 1 from (1, 0.5).
///
/// # Errors
/// As the method's own steps.
pub fn energy_error(
    entry: &IntegratorEntry,
    dt: f64,
    steps: u64,
) -> Result<EnergyError, StepError> {
    let mut bench = super::OscillatorBench::new(entry.oscillator, 1.0, 0.0);
    let samples = bench.trajectory(&mut entry.build(), DVec2::new(1.0, 0.5), dt, steps)?;
    let start = samples[0].energy;
    let largest =
        |part: &[super::Sample]| part.iter().map(|s| (s.energy - start).abs()).fold(0.0, f64::max);
    let (first, second) = samples.split_at(samples.len() / 2);
    Ok(EnergyError { first_half: largest(first), second_half: largest(second) })
}
