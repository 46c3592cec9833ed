//! How far the skin that the scene gets is from the cheapest one.

use serde::Serialize;

use super::blocks::{Start, take};
use super::clock::{Clock, tells_processor_time};
use super::variants::{Variant, in_shuffled_rounds};
use super::{BenchError, BenchOptions, Spread};
use crate::Progress;
use crate::jobs::pool;

/// Skins that are tried, as multiples of the one that the scene gets.
const TRIED: [f64; 7] = [0.5, 0.65, 0.8, 1.0, 1.25, 1.6, 2.0];

/// A skin that was tried.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SkinPoint {
    /// The skin, σ.
    pub skin: f64,
    /// Nanoseconds an atom and whole step.
    pub step_ns: Spread,
}

/// The scan.
#[derive(Debug, Clone, Serialize)]
pub struct SkinStudy {
    /// Instruction set, precision and threads that it was made with.
    pub with: String,
    /// The skin that the scene gets, σ.
    pub chosen: f64,
    /// The cheapest of those that were tried, σ.
    pub cheapest: f64,
    /// Median cost of the chosen over that of the cheapest, minus 1.
    pub excess: f64,
    /// The skins, ascending.
    pub points: Vec<SkinPoint>,
}

/// Measures whole steps with several skins on the first variant; `None` where it has no list.
pub(super) fn measure(
    variant: &Variant,
    start: &Start,
    options: &BenchOptions,
    progress: &mut dyn Progress,
) -> Result<Option<SkinStudy>, BenchError> {
    if variant.skin <= 0.0 {
        return Ok(None);
    }
    let room = start.cell.largest_cutoff() - variant.scene.truncation.r_cut;
    let skins: Vec<f64> = TRIED
        .iter()
        .map(|f| f * variant.skin)
        .filter(|s| *s <= room)
        .collect();
    let pool = pool(variant.threads)?;
    let by_processor = variant.threads == 1 && tells_processor_time();
    let mut seconds: Vec<Vec<f64>> = skins.iter().map(|_| Vec::new()).collect();
    in_shuffled_rounds(skins.len(), options.repeats, |i, share| {
        progress.update(&format!("skin {:.3} σ", skins[i]), share);
        let mut scene = variant.scene.clone();
        scene.neighbor.skin = Some(skins[i]);
        let time = pool.install(|| -> Result<f64, BenchError> {
            let mut simulation = start.simulation(&scene)?;
            let clock = Clock::start();
            take(&mut simulation, start.steps)?;
            Ok(if by_processor {
                clock.on_processor()
            } else {
                clock.wall()
            })
        })?;
        seconds[i].push(time);
        Ok(())
    })?;
    let ns = 1e9 / (start.state.len() as f64 * start.steps as f64);
    let points: Vec<SkinPoint> = skins
        .iter()
        .zip(seconds)
        .map(|(&skin, all)| SkinPoint {
            skin,
            step_ns: Spread::of(all).scaled(ns),
        })
        .collect();
    let cost = |p: &&SkinPoint| p.step_ns.median;
    let cheapest = points.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let chosen = points.iter().find(|p| p.skin == variant.skin);
    let (Some(cheapest), Some(chosen)) = (cheapest, chosen) else {
        return Ok(None);
    };
    Ok(Some(SkinStudy {
        with: format!(
            "{} {}, {}, {}",
            variant.isa,
            super::variants::precision_name(variant.precision),
            lennard_report::counted(variant.threads, "thread"),
            if by_processor {
                "processor time"
            } else {
                "wall clock"
            }
        ),
        chosen: chosen.skin,
        cheapest: cheapest.skin,
        excess: chosen.step_ns.median / cheapest.step_ns.median - 1.0,
        points,
    }))
}
