//! How far the skin that the scene gets is from the cheapest one.

use lennard_core::Want;
use lennard_core::stopwatch::{Spread, Stopwatch};
use lennard_engine::take;
use serde::Serialize;

use super::blocks::{Blocks, clock_name, in_turns, spread};
use super::variants::Variant;
use super::{BenchError, BenchOptions};
use crate::Progress;
use crate::jobs::pool;

/// Skins that are tried, as multiples of the one that the scene gets.
const TRIED: [f64; 7] = [0.5, 0.65, 0.8, 1.0, 1.25, 1.6, 2.0];

/// A skin that was tried.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SkinPoint {
    /// The skin, σ.
    pub skin: f64,
    /// Nanoseconds per particle and whole step.
    pub step_ns: Spread,
}

/// The scan.
#[derive(Debug, Clone, Serialize)]
pub struct SkinStudy {
    /// Instruction set, precision and threads that it was made with.
    pub with: String,
    /// What was read: `processor time` or `wall clock`.
    pub clock: &'static str,
    /// The skin that the scene gets, σ.
    pub chosen: f64,
    /// The cheapest skin that was tried, σ.
    pub cheapest: f64,
    /// Median cost of the chosen skin over the cost of the cheapest, minus 1.
    pub excess: f64,
    /// The skins, ascending.
    pub points: Vec<SkinPoint>,
}

/// Measures whole steps with several skins on the first variant; `None` where it has no list.
pub(super) fn measure(
    variant: &Variant,
    blocks: &Blocks,
    options: &BenchOptions,
    progress: &mut dyn Progress,
) -> Result<Option<SkinStudy>, BenchError> {
    let own = variant.plan.skin;
    if own <= 0.0 {
        return Ok(None);
    }
    let room = blocks.start.cell.largest_cutoff() - variant.scene.truncation.r_cut;
    let skins: Vec<f64> =
        TRIED.iter().map(|factor| factor * own).filter(|skin| *skin <= room).collect();
    let labels: Vec<String> = skins.iter().map(|s| format!("skin {s:.3} σ")).collect();
    let pool = pool(variant.threads)?;
    let by_processor = variant.threads == 1 && Stopwatch::tells_processor_time();
    let seconds = in_turns(&labels, options, progress, |i| {
        let mut scene = variant.scene.clone();
        scene.neighbor.skin = Some(skins[i]);
        pool.install(|| {
            let mut simulation = blocks.simulation(&scene)?;
            let watch = Stopwatch::start();
            take(&mut simulation, blocks.steps, Want::NOTHING)?;
            Ok(if by_processor { watch.on_processor() } else { watch.wall() })
        })
    })?;
    let point = |(skin, seconds): (&f64, Vec<f64>)| SkinPoint {
        skin: *skin,
        step_ns: spread(seconds).scaled(blocks.ns_per_second()),
    };
    let points: Vec<SkinPoint> = skins.iter().zip(seconds).map(point).collect();
    let cost = |p: &&SkinPoint| p.step_ns.median;
    let cheapest = points.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let chosen = points.iter().find(|p| p.skin == own);
    let (Some(cheapest), Some(chosen)) = (cheapest, chosen) else {
        return Ok(None);
    };
    let clock = clock_name(by_processor);
    Ok(Some(SkinStudy {
        with: format!(
            "{}, {}, {clock}",
            variant.kernel(),
            crate::report::counted(variant.threads, "thread"),
        ),
        clock,
        chosen: chosen.skin,
        cheapest: cheapest.skin,
        excess: chosen.step_ns.median / cheapest.step_ns.median - 1.0,
        points,
    }))
}
