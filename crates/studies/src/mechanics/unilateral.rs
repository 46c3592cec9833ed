//! Unilateral contacts of SPOOK in whole steps: restitution, stacks at rest, energy of a ball, sweeps.

use lennard_core::Masses;
use lennard_forcefield::{Hard, Response, WallOptions};
use lennard_integrators::spook::{Problem, Solver, TwoSided};
use lennard_scene::Scene;

use super::ball::{Balls, column};
use crate::StudyError;
use crate::measured::Measured;

/// Restitution of the measurements over phases.
const SHARE: f64 = 0.4;
/// Compliance of the stack at rest, σ²/ε.
const COMPLIANCE: f64 = 1e-3;
/// Balls of the row whose sweeps are counted.
const SWEPT: usize = 10;

/// Balls of diameter 1 over a plane, with contacts of SPOOK for both.
fn balls((restitution, compliance): (f64, f64), g: f64) -> Result<Scene, StudyError> {
    let restitution_of_balls = ("contact.restitution", restitution.to_string());
    let overrides = [restitution_of_balls, ("contact.compliance", compliance.to_string())];
    let hard = Hard { response: Response::Contact, restitution: Some(restitution) };
    column(&WallOptions::Hard(hard), g, &overrides)
}

/// The restitution over 100 phases of a step that is farthest from the one that was set, less that one.
fn restitution() -> Result<f64, StudyError> {
    let (h, mut worst) = (0.01, 0.0_f64);
    let scene = balls((SHARE, 0.0), 0.0)?;
    for k in 1..=100 {
        let above = (1.0 - f64::from(k) / 100.0) * h;
        let mut ball = Balls::start(&scene, (&[above], -1.0), h)?;
        ball.steps(30)?;
        let off = ball.speed() - SHARE;
        if off.abs() > worst.abs() {
            worst = off;
        }
    }
    Ok(worst)
}

/// A stack of five at rest: the depth that is farthest from ε × force, relative, and the momentum that the floor takes over
/// the weight, less 1.
fn stack() -> Result<[f64; 2], StudyError> {
    let h = 0.005;
    let heights: Vec<f64> = (0..5).map(|i| 0.1 + 1.1 * f64::from(i)).collect();
    let mut stack = Balls::start(&balls((0.2, COMPLIANCE), 1.0)?, (&heights, 0.0), h)?;
    stack.steps(16_000)?;
    let before = stack.impulse();
    stack.steps(2000)?;
    let weight = (stack.impulse() - before) / (2000.0 * h * 5.0) - 1.0;
    let depth = |i: usize| match i {
        0 => -stack.height(),
        _ => 1.0 - (stack.height_of(i) - stack.height_of(i - 1)),
    };
    let off = (0..5).map(|i| (depth(i) / (COMPLIANCE * (5 - i) as f64) - 1.0).abs());
    Ok([off.fold(0.0, f64::max), weight])
}

/// The largest | E/E₀ − 1 | of a ball that bounces in gravity with e = 1. In a constant field positions and v + h·f/(2m) lie on the exact parabola, so that the energy there is exact.
fn energy(steps: u32) -> Result<f64, StudyError> {
    let h = 0.01;
    let mut ball = Balls::start(&balls((1.0, 0.0), 1.0)?, (&[1.0], 0.0), h)?;
    let of = |ball: &Balls| {
        let v = ball.speed() - 0.5 * h;
        0.5 * v * v + ball.height()
    };
    let (start, mut worst) = (of(&ball), 0.0_f64);
    for _ in 0..steps {
        ball.steps(1)?;
        worst = worst.max((of(&ball) / start - 1.0).abs());
    }
    Ok(worst)
}

/// The factor by which a sweep over a stack of ten lowers the error, measured and by theory.
fn sweep() -> [f64; 2] {
    let contacts = lennard_integrators::spook::column(SWEPT);
    // What gravity does in a step: the floor alone sees the fall, and the solution is (n, …, 1).
    let mut b = vec![0.0; SWEPT];
    b[0] = -1.0;
    let error = |sweeps| -> f64 {
        let problem = Problem {
            contacts: &contacts,
            masses: &Masses::Uniform(1.0),
            sigma: 0.0,
            b: &b,
            bonds: TwoSided::default(),
        };
        let found = problem.solve(Solver::Sweeps(sweeps)).impulses;
        let off = (found.iter().enumerate()).map(|(i, x)| (x - (SWEPT - i) as f64).abs());
        off.sum()
    };
    let theory = (std::f64::consts::PI / (2 * SWEPT) as f64).cos().powi(2);
    [error(401) / error(400), theory]
}

/// Measures everything.
pub(super) fn measure(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let numbers = &mut all.numbers;
    numbers.add("restitution of unilateral contacts", restitution()?.abs());
    let [sunk, weight] = stack()?;
    numbers.add("depths of a stack", sunk);
    numbers.add("weight of a stack", weight.abs());
    let steps = if quick { 20_000 } else { 200_000 };
    numbers.add("energy of a bouncing ball", energy(steps)?).of("steps", steps);
    let [measured, theory] = sweep();
    numbers.add("sweep over a stack", measured).theory(theory);
    Ok(())
}
