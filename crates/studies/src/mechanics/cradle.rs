//! Balls that touch: rows that one ball hits, a stack at rest, and the contacts of SPOOK.

use lennard_core::{DVec3, Masses};
use lennard_forcefield::{Hard, Response, WallOptions};
use lennard_integrators::spook::{self, Contact, Problem, Regularisation, Solver, TwoSided};
use lennard_observables::{Cell, Table};
use lennard_scene::Scene;

use super::ball::{balls, column};
use super::bodies::{in_a_box, rig, shipped};
use crate::StudyError;
use crate::claims::Measured;
use crate::lab::Rig;

/// A row of touching balls by springs, in small steps of velocity Verlet.
fn by_springs(n: usize, law: &str) -> Result<Vec<f64>, StudyError> {
    let mut v = vec![DVec3::ZERO; n];
    v[0] = DVec3::X;
    let x: Vec<DVec3> = (0..n).map(|i| DVec3::new(i as f64, 0.0, 0.0)).collect();
    let scene = shipped("mechanics/cradle-hertz", &[("contact.law", law.to_owned())])?;
    let mut rig = rig(&scene, &in_a_box(100.0, &x, &v)?, 2e-5)?;
    rig.steps(60_000)?;
    Ok(rig.state.velocities.iter().map(|v| v.x).collect())
}

fn row(n: usize) -> Vec<Contact> {
    (1..n)
        .map(|second| Contact { first: Some(second - 1), second, normal: DVec3::X, gap: 0.0 })
        .collect()
}

/// Rows of balls after the first hit the second, by how hits are resolved.
fn cradles(all: &mut Measured) -> Result<(), StudyError> {
    let masses = Masses::Uniform(1.0);
    let resolved = |n: usize, resolve: &dyn Fn(&[Contact], &mut [DVec3])| -> Vec<f64> {
        let mut v = vec![DVec3::ZERO; n];
        v[0] = DVec3::X;
        resolve(&row(n), &mut v);
        v.iter().map(|v| v.x).collect()
    };
    let in_turn = |c: &[Contact], v: &mut [DVec3]| spook::impacts_in_turn(c, &masses, v, 1.0);
    let at_once = |c: &[Contact], v: &mut [DVec3]| {
        spook::impacts_at_once(c, &masses, v, 1.0);
    };
    let rows: [(&str, Vec<f64>, &[f64]); 5] = [
        ("in turn, e = 1", resolved(5, &in_turn), &[0.0, 0.0, 0.0, 0.0, 1.0]),
        ("all at once, e = 1", resolved(5, &at_once), &[-0.6, 0.4, 0.4, 0.4, 0.4]),
        ("linear springs", by_springs(3, "linear")?, &[-0.1303, 0.1502, 0.9800]),
        ("Hertz, three balls", by_springs(3, "hertz")?, &[-0.0709, 0.0764, 0.9946]),
        (
            "Hertz, five balls",
            by_springs(5, "hertz")?,
            &[-0.0711, -0.0303, -0.0145, 0.1270, 0.9888],
        ),
    ];
    for (rule, velocities, known) in &rows {
        let off = velocities.iter().zip(*known).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let number = all.numbers.add("velocities of a row of balls", off);
        number.of("rule", rule).of("velocities", format!("{velocities:?}"));
    }
    let words = |values: &[f64]| {
        let words: Vec<String> = values.iter().map(|v| format!("{v:.4}")).collect();
        Cell::figures(words.join(", "))
    };
    let table = Table::rows_of("cradles", &rows)
        .caption("Equal balls in a row that touch; the first has speed 1.")
        .column("Rule", |(rule, ..)| *rule)
        .column("Velocities after", |(_, velocities, _)| words(velocities))
        .column("Known", |(.., known)| words(known));
    all.tables.push(table.table());
    Ok(())
}

/// The largest deviation of the contact forces of a stack of five balls at rest, relative.
fn stack() -> f64 {
    const G: f64 = 9.81;
    let fall = [DVec3::new(0.0, 0.0, -G); 5];
    let forces = spook::resting_forces(&spook::column(5), &Masses::Uniform(1.0), &fall);
    let off = forces.iter().zip([5.0, 4.0, 3.0, 2.0, 1.0]).map(|(f, n)| (f / (n * G) - 1.0).abs());
    off.fold(0.0, f64::max)
}

/// The largest rebound of SPOOK's contact alone over phases and the speed, at a damping in steps.
fn spook_rebound(damping: f64) -> f64 {
    let h = 0.01;
    let rebounds = (1..=100).map(|k| {
        let contact =
            [Contact { first: None, second: 0, normal: DVec3::Z, gap: -f64::from(k) / 100.0 * h }];
        let (masses, mut v) = (Masses::Uniform(1.0), [DVec3::NEG_Z]);
        let regular = Regularisation::new(0.0, damping * h, h);
        let (still, exact) = ([DVec3::ZERO], Solver::Exact);
        spook::spook_contacts(&contact, &masses, &mut v, &still, regular, h, exact);
        v[0].z
    });
    rebounds.fold(0.0, f64::max)
}

/// Measures everything.
pub(super) fn measure(all: &mut Measured) -> Result<(), StudyError> {
    cradles(all)?;
    all.numbers.add("forces of a stack", stack());
    all.numbers.add("rebound of SPOOK alone", spook_rebound(2.0)).of("damping", "2h");
    all.numbers.add("rebound of SPOOK alone", spook_rebound(0.0)).of("damping", "0");
    Ok(())
}

/// Restitution of the measurements over phases.
const SHARE: f64 = 0.4;
/// Compliance of the stack at rest, σ²/ε.
const COMPLIANCE: f64 = 1e-3;
/// Balls of the row whose sweeps are counted.
const SWEPT: usize = 10;

/// Balls of diameter 1 over a plane, with contacts of SPOOK for both.
fn touching((restitution, compliance): (f64, f64), g: f64) -> Result<Scene, StudyError> {
    let restitution_of_balls = ("contact.restitution", restitution.to_string());
    let overrides = [restitution_of_balls, ("contact.compliance", compliance.to_string())];
    let hard = Hard { response: Response::Contact, restitution: Some(restitution) };
    column(&WallOptions::Hard(hard), g, &overrides)
}

/// The restitution over 100 phases of a step that is farthest from the one that was set, less that one.
fn restitution() -> Result<f64, StudyError> {
    let (h, mut worst) = (0.01, 0.0_f64);
    let scene = touching((SHARE, 0.0), 0.0)?;
    for k in 1..=100 {
        let above = (1.0 - f64::from(k) / 100.0) * h;
        let mut ball = balls(&scene, (&[above], -1.0), h)?;
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
fn stack_at_rest() -> Result<[f64; 2], StudyError> {
    let h = 0.005;
    let heights: Vec<f64> = (0..5).map(|i| 0.1 + 1.1 * f64::from(i)).collect();
    let mut stack = balls(&touching((0.2, COMPLIANCE), 1.0)?, (&heights, 0.0), h)?;
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
    let mut ball = balls(&touching((1.0, 0.0), 1.0)?, (&[1.0], 0.0), h)?;
    let of = |ball: &Rig| {
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
pub(super) fn contacts(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let numbers = &mut all.numbers;
    numbers.add("restitution of unilateral contacts", restitution()?.abs());
    let [sunk, weight] = stack_at_rest()?;
    numbers.add("depths of a stack", sunk);
    numbers.add("weight of a stack", weight.abs());
    let steps = if quick { 20_000 } else { 200_000 };
    numbers.add("energy of a bouncing ball", energy(steps)?).of("steps", steps);
    let [measured, theory] = sweep();
    numbers.add("sweep over a stack", measured).theory(theory);
    Ok(())
}
