//! Collisions: springs that are too weak and too stiff, bounces by each rule, and the cradle.

use lennard_core::{DVec3, PeriodicBox};
use lennard_forcefield::{Hard, Response, SlitPlanes, Soft, SpringLaw, WallOptions};
use lennard_literature::try_bisect;
use lennard_observables::{Cell, Table};

use super::ball::{PLANE, SIDE, balls, over};
use super::cradle;
use crate::StudyError;
use crate::claims::Measured;
use crate::report::Drawn;

/// Stiffness of soft walls, ε/σ²: ω = 20 τ⁻¹.
const STIFFNESS: f64 = 400.0;

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
    let scene = over(wall, 0.0)?;
    for k in 0..phases {
        let phase = (f64::from(k) + 0.5) / f64::from(phases);
        let mut ball = balls(&scene, (&[(1.0 + phase) * h], -1.0), h)?;
        for _ in 0..1_000_000 {
            if ball.try_step().is_err() {
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

/// Hits of undamped linear springs, for each phase step s = ωh.
fn stiff(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let phases = if quick { 200 } else { 2000 };
    let omega = STIFFNESS.sqrt();
    let mut hits: Vec<[f64; 4]> = Vec::new();
    for phase in [0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 1.1, 1.2, 1.3, 1.4, 1.5, 1.7, 1.9] {
        let (speeds, deepest) = rebounds(&soft(SpringLaw::Linear, 1.0), phase / omega, phases)?;
        let gains: Vec<f64> = speeds.iter().map(|v| v * v - 1.0).collect();
        let n = gains.len() as f64;
        let gain = gains.iter().sum::<f64>() / n;
        let rms = (gains.iter().map(|g| g * g).sum::<f64>() / n).sqrt();
        all.numbers.add("gain per hit", gain).of("phase", phase);
        hits.push([phase, gain, rms, deepest * omega]);
    }
    let at = |phase| hits.iter().find(|hit| hit[0] == phase).map_or(f64::NAN, |hit| hit[1]);
    all.numbers.add("gain at 1.4 over 1.2", at(1.4) / at(1.2));
    let table = Table::rows_of("penalty", &hits)
        .column("omega h", |hit| hit[0])
        .column("mean gain", |hit| hit[1])
        .column("RMS", |hit| hit[2])
        .column("depth over v/omega", |hit| hit[3])
        .table();
    let sizes = hits.iter().map(|hit| hit[1].abs());
    all.given.tables.push(table.clone().and("size of the gain", sizes));
    all.tables.push(table);
    Ok(())
}

/// Restitution of soft walls with a dashpot.
fn damped(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let mut hits = Vec::new();
    for (law, name) in [(SpringLaw::Linear, "linear"), (SpringLaw::Hertz, "hertz")] {
        for set in [0.05, 0.1, 0.3, 0.5, 0.7, 0.9] {
            let (speeds, _) = rebounds(&soft(law, set), 0.005, if quick { 50 } else { 500 })?;
            let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
            let farthest = speeds.iter().fold(0.0_f64, |m, v| m.max((v - set).abs()));
            all.numbers.add("restitution of a damped spring", mean).of("law", name).of("e", set);
            hits.push((name, set, mean, farthest));
        }
    }
    let table = Table::rows_of("damped-springs", &hits)
        .caption("Soft walls with a dashpot at ωh = 0.1, over all phases of the step.")
        .column("Law", |hit| hit.0)
        .column("e set", |hit| Cell::rounded(hit.1, 3))
        .column("mean e", |hit| Cell::rounded(hit.2, 5))
        .column("farthest hit", |hit| Cell::rounded(hit.3, 2));
    all.tables.push(table.table());
    Ok(())
}

/// Time of contact and depth of Hertz's contact, each over theory: 2.9432·δ/v and (5v²/(4k))^{2/5}.
fn hertz() -> Result<[f64; 2], StudyError> {
    let h = 1e-4;
    let scene = over(&soft(SpringLaw::Hertz, 1.0), 0.0)?;
    let mut ball = balls(&scene, (&[0.5 * h], -1.0), h)?;
    let (mut inside, mut deepest) = (0.0, 0.0_f64);
    for _ in 0..100_000 {
        if ball.try_step().is_err() || (ball.speed() > 0.0 && ball.height() > 0.0) {
            break;
        }
        inside += h;
        deepest = deepest.max(-ball.height());
    }
    let depth = (1.25 / STIFFNESS).powf(0.4);
    Ok([inside / (2.9432 * depth), deepest / depth])
}

/// The smallest speed that passes a soft wall, over ω times the room behind the plane.
fn passes() -> Result<f64, StudyError> {
    let room = SlitPlanes::new(&PeriodicBox::new(DVec3::splat(SIDE))?, 2, 2.0 * PLANE, 0.0).room;
    let limit = STIFFNESS.sqrt() * room;
    let scene = over(&soft(SpringLaw::Linear, 1.0), 0.0)?;
    let is_held = |share: f64| -> Result<bool, StudyError> {
        let mut ball = balls(&scene, (&[0.1], -share * limit), 1e-3)?;
        for _ in 0..10_000 {
            if ball.try_step().is_err() {
                return Ok(false);
            }
            if ball.speed() > 0.0 {
                return Ok(true);
            }
        }
        Ok(true)
    };
    Ok(try_bisect(0.5, 2.0, 20, is_held)?[1])
}

/// A ball in gravity under each rule, dropped from 1 σ with g = 1.
fn bouncing(all: &mut Measured) -> Result<(), StudyError> {
    let h = 0.01;
    let mut heights = Vec::new();
    for (rule, response, restitution) in [
        ("event", Response::Event, 1.0),
        ("event", Response::Event, 0.9),
        ("event", Response::Event, 0.7),
        ("event", Response::Event, 0.5),
        ("billiard", Response::Billiard, 1.0),
        ("mirror", Response::Mirror, 1.0),
        ("project", Response::Project, 0.0_f64),
    ] {
        let scene = over(&hard(response, restitution), 1.0)?;
        let mut ball = balls(&scene, (&[1.0], 0.0), h)?;
        heights.push((rule, restitution, 0.0, 1.0));
        // Energy after each bounce over the energy of theory, e²ⁿ, less 1.
        let mut gains: Vec<f64> = Vec::new();
        for n in 1..=1200_u32 {
            let before = ball.hits();
            ball.steps(1)?;
            heights.push((rule, restitution, f64::from(n) * h, ball.height()));
            let theory = restitution.powi(2 * ball.hits() as i32);
            if ball.hits() > before && theory > 1e-3 {
                gains.push((0.5 * ball.speed().powi(2) + ball.height()) / theory - 1.0);
            }
        }
        if rule == "event" {
            let off = gains.iter().fold(0.0, |most: f64, gain| most.max(gain.abs()));
            all.numbers.add("energy after bounces", off).of("e", restitution);
        } else if rule == "mirror" {
            let gain = gains.last().copied().unwrap_or(f64::NAN);
            all.numbers.add("gain of a mirrored ball", gain);
        }
    }
    let table = Table::rows_of("bounces", &heights)
        .column("rule", |at| at.0)
        .column("restitution", |at| at.1)
        .column("time [tau]", |at| at.2)
        .column("height [sigma]", |at| at.3)
        .table();
    let names = heights.iter().map(|at| format!("{}, e = {}", at.0, at.1));
    all.given.tables.push(table.clone().and("ball", names));
    all.tables.push(table);
    Ok(())
}

/// The largest | E/E₀ − 1 | over 2000 bounces of a billiard ball in gravity, and the trend of its mean between the halves.
fn billiard(quick: bool) -> Result<[f64; 2], StudyError> {
    let bounces = if quick { 400 } else { 2000 };
    let scene = over(&hard(Response::Billiard, 1.0), 1.0)?;
    let mut ball = balls(&scene, (&[1.0], 0.0), 0.01)?;
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
        let scene = over(&hard(Response::Project, 0.0), 0.0)?;
        let mut ball = balls(&scene, (&[phase * 0.01], -1.0), 0.01)?;
        ball.steps(2)?;
        worst = worst.max(ball.speed().abs()).max(ball.height().abs());
    }
    Ok(worst)
}

/// Measures everything.
pub(super) fn measure(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    stiff(quick, all)?;
    damped(quick, all)?;
    bouncing(all)?;
    let [time, depth] = hertz()?;
    let [worst, trend] = billiard(quick)?;
    for (key, measured) in [
        ("speed that passes", passes()?),
        ("time of a Hertz contact", time),
        ("depth of a Hertz contact", depth),
        ("speed after a projection", projected()?),
        ("energy of a billiard ball", worst),
        ("trend of a billiard ball", trend.abs()),
    ] {
        all.numbers.add(key, measured);
    }
    cradle::measure(all)?;
    cradle::contacts(quick, all)
}
