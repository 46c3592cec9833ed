//! Collisions: springs that are too weak and too stiff, bounces by each rule, and the cradle.

use lennard_core::{DVec3, PeriodicBox};
use lennard_forcefield::{Hard, Response, SlitPlanes, Soft, SpringLaw, WallOptions};
use serde::Serialize;

use super::ball::{Balls, PLANE, SIDE};
use super::cradle::{Cradle, cradles, spook_rebound, stack};
use super::unilateral::{self, Unilateral};
use crate::StudyError;

/// Stiffness of soft walls, ε/σ²: ω = 20 τ⁻¹.
const STIFFNESS: f64 = 400.0;

/// A hit of a soft wall without restitution loss at one phase step s = ωh.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct StiffHit {
    /// s = ωh.
    pub phase: f64,
    /// Mean relative gain of energy per hit.
    pub gain: f64,
    /// RMS of the same.
    pub rms: f64,
    /// Greatest depth over v/ω.
    pub depth: f64,
}

/// A damped soft wall.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct DampedHit {
    /// The law.
    pub law: &'static str,
    /// The restitution that was set.
    pub set: f64,
    /// The mean over phases.
    pub mean: f64,
    /// The farthest single hit.
    pub farthest: f64,
}

/// A ball in gravity under a rule.
#[derive(Debug, Clone, Serialize)]
pub struct Bouncing {
    /// The rule.
    pub rule: &'static str,
    /// The restitution that was set.
    pub restitution: f64,
    /// Time and height of a ball dropped from 1 σ with g = 1.
    pub path: Vec<(f64, f64)>,
    /// Energy after each bounce over the energy of theory, e²ⁿ.
    pub energies: Vec<f64>,
}

/// All of it.
#[derive(Debug, Clone, Serialize)]
pub struct Collisions {
    /// Undamped linear springs.
    pub stiff: Vec<StiffHit>,
    /// Damped springs at s = 0.1.
    pub damped: Vec<DampedHit>,
    /// Time of contact and depth of a Hertz contact over theory.
    pub hertz: [f64; 2],
    /// Speed over ω·D, with D the room behind the plane, just below and just above which a particle stays and passes.
    pub passes: [f64; 2],
    /// Bounces by each rule.
    pub bouncing: Vec<Bouncing>,
    /// Largest | E/E₀ − 1 | of a billiard ball over 2000 bounces, and the trend between the halves.
    pub billiard: [f64; 2],
    /// Normal speed that is left two steps after a projection, over the speed before it.
    pub projected: f64,
    /// Rows of balls.
    pub cradles: Vec<Cradle>,
    /// The largest deviation of the contact forces of a stack of five from (5, …, 1)·m·g, relative.
    pub stack: f64,
    /// The largest rebound of a contact of SPOOK alone over phases, over the speed: at τ = 0 and at τ = 2h.
    pub spook_alone: [f64; 2],
    /// Contacts of SPOOK in whole steps.
    pub unilateral: Unilateral,
}

fn soft(law: SpringLaw, restitution: f64) -> WallOptions {
    WallOptions::Soft(Soft { law, stiffness: STIFFNESS, restitution })
}

fn hard(response: Response, restitution: f64) -> WallOptions {
    WallOptions::Hard(Hard { response, restitution: Some(restitution) })
}

/// Speeds after a hit with speed 1 at many phases of the step, and the greatest depth.
fn rebounds(wall: &WallOptions, h: f64, phases: u32) -> Result<(Vec<f64>, f64), StudyError> {
    let mut deepest = 0.0_f64;
    let mut speeds = Vec::new();
    for k in 0..phases {
        let phase = (f64::from(k) + 0.5) / f64::from(phases);
        let mut ball = Balls::one_over(wall, ((1.0 + phase) * h, -1.0), 0.0, h)?;
        for _ in 0..1_000_000 {
            if ball.step().is_err() {
                break;
            }
            deepest = deepest.max(-ball.height());
            if ball.speed() > 0.0 && ball.height() > 0.0 {
                break;
            }
        }
        speeds.push(ball.speed());
    }
    Ok((speeds, deepest))
}

fn stiff(quick: bool) -> Result<Vec<StiffHit>, StudyError> {
    let phases = if quick { 200 } else { 2000 };
    let omega = STIFFNESS.sqrt();
    [0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 1.1, 1.2, 1.3, 1.4, 1.5, 1.7, 1.9]
        .into_iter()
        .map(|phase| {
            let (speeds, deepest) = rebounds(&soft(SpringLaw::Linear, 1.0), phase / omega, phases)?;
            let gains: Vec<f64> = speeds.iter().map(|v| v * v - 1.0).collect();
            let n = gains.len() as f64;
            Ok(StiffHit {
                phase,
                gain: gains.iter().sum::<f64>() / n,
                rms: (gains.iter().map(|g| g * g).sum::<f64>() / n).sqrt(),
                depth: deepest * omega,
            })
        })
        .collect()
}

fn damped(quick: bool) -> Result<Vec<DampedHit>, StudyError> {
    let mut all = Vec::new();
    for (law, name) in [(SpringLaw::Linear, "linear"), (SpringLaw::Hertz, "hertz")] {
        for set in [0.05, 0.1, 0.3, 0.5, 0.7, 0.9] {
            let (speeds, _) = rebounds(&soft(law, set), 0.005, if quick { 50 } else { 500 })?;
            let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
            let farthest = speeds.iter().fold(0.0_f64, |m, v| m.max((v - set).abs()));
            all.push(DampedHit { law: name, set, mean, farthest });
        }
    }
    Ok(all)
}

/// Time of contact and depth of Hertz's contact, each over theory: 2.9432·δ/v and (5v²/(4k))^{2/5}.
fn hertz() -> Result<[f64; 2], StudyError> {
    let h = 1e-4;
    let mut ball = Balls::one_over(&soft(SpringLaw::Hertz, 1.0), (0.5 * h, -1.0), 0.0, h)?;
    let (mut inside, mut deepest) = (0.0, 0.0_f64);
    for _ in 0..100_000 {
        if ball.step().is_err() || (ball.speed() > 0.0 && ball.height() > 0.0) {
            break;
        }
        inside += h;
        deepest = deepest.max(-ball.height());
    }
    let depth = (1.25 / STIFFNESS).powf(0.4);
    Ok([inside / (2.9432 * depth), deepest / depth])
}

/// The largest speed that a soft wall holds and the smallest that passes, over ω times the room behind the plane.
fn passes() -> Result<[f64; 2], StudyError> {
    let room = SlitPlanes::new(&PeriodicBox::new(DVec3::splat(SIDE))?, 2, 2.0 * PLANE, 0.0).room;
    let limit = STIFFNESS.sqrt() * room;
    let is_held = |share: f64| -> Result<bool, StudyError> {
        let wall = soft(SpringLaw::Linear, 1.0);
        let mut ball = Balls::one_over(&wall, (0.1, -share * limit), 0.0, 1e-3)?;
        for _ in 0..10_000 {
            if ball.step().is_err() {
                return Ok(false);
            }
            if ball.speed() > 0.0 {
                return Ok(true);
            }
        }
        Ok(true)
    };
    let (mut low, mut high) = (0.5, 2.0);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if is_held(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok([low, high])
}

fn bouncing(
    rule: &'static str,
    response: Response,
    restitution: f64,
) -> Result<Bouncing, StudyError> {
    let h = 0.01;
    let mut ball = Balls::one_over(&hard(response, restitution), (1.0, 0.0), 1.0, h)?;
    let (mut path, mut energies) = (vec![(0.0, 1.0)], Vec::new());
    for n in 1..=1200_u32 {
        let before = ball.hits();
        ball.steps(1)?;
        path.push((f64::from(n) * h, ball.height()));
        let theory = restitution.powi(2 * ball.hits() as i32);
        if ball.hits() > before && theory > 1e-3 {
            energies.push((0.5 * ball.speed().powi(2) + ball.height()) / theory);
        }
    }
    Ok(Bouncing { rule, restitution, path, energies })
}

/// The largest | E/E₀ − 1 | over 2000 bounces of a billiard ball in gravity, and the trend of its mean between the halves.
fn billiard(quick: bool) -> Result<[f64; 2], StudyError> {
    let bounces = if quick { 400 } else { 2000 };
    let mut ball = Balls::one_over(&hard(Response::Billiard, 1.0), (1.0, 0.0), 1.0, 0.01)?;
    let (mut worst, mut sums, mut counts) = (0.0_f64, [0.0; 2], [0.0; 2]);
    while ball.hits() < bounces {
        ball.steps(1)?;
        let off = 0.5 * ball.speed().powi(2) + ball.height() - 1.0;
        worst = worst.max(off.abs());
        let half = usize::from(2 * ball.hits() >= bounces);
        sums[half] += off;
        counts[half] += 1.0;
    }
    Ok([worst, sums[1] / counts[1] - sums[0] / counts[0]])
}

fn projected() -> Result<f64, StudyError> {
    let mut worst = 0.0_f64;
    for phase in [0.1, 0.4, 0.9] {
        let wall = hard(Response::Project, 0.0);
        let mut ball = Balls::one_over(&wall, (phase * 0.01, -1.0), 0.0, 0.01)?;
        ball.steps(2)?;
        worst = worst.max(ball.speed().abs()).max(ball.height().abs());
    }
    Ok(worst)
}

/// Measures everything.
pub(crate) fn measure(quick: bool) -> Result<Collisions, StudyError> {
    let bounces = [
        ("event", Response::Event, 1.0),
        ("event", Response::Event, 0.9),
        ("event", Response::Event, 0.7),
        ("event", Response::Event, 0.5),
        ("billiard", Response::Billiard, 1.0),
        ("mirror", Response::Mirror, 1.0),
        ("project", Response::Project, 0.0),
    ];
    let largest = |damping| spook_rebound(damping).fold(0.0, f64::max);
    Ok(Collisions {
        stiff: stiff(quick)?,
        damped: damped(quick)?,
        hertz: hertz()?,
        passes: passes()?,
        bouncing: bounces
            .into_iter()
            .map(|(rule, response, e)| bouncing(rule, response, e))
            .collect::<Result<_, _>>()?,
        billiard: billiard(quick)?,
        projected: projected()?,
        cradles: cradles()?,
        stack: stack(),
        spook_alone: [largest(0.0), largest(2.0)],
        unilateral: unilateral::measure(quick)?,
    })
}
