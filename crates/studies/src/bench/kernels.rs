//! Kernels, precisions and numbers of threads beside one another, and skins around the one that the scene gets.

use std::path::Path;

use lennard_engine::bare;
use lennard_engine::stopwatch::Stopwatch;
use lennard_forcefield::{ForcePlan, Isa, measure};

use super::types::{BenchError, KernelResult, SkinPoint, SkinStudy, doubts, load};
use super::variants::{Block, Blocks, Variant, spread};
use crate::Progress;
use crate::report::counted;

/// Evaluations and builds that each repeat times alone. The best counts: on a busy machine most of such short times are
/// disturbed.
const ROUNDS: usize = 3;
/// Bytes per particle of position, velocity and force.
const STATE_BYTES: f64 = 72.0;
/// A full list meets each pair twice.
const MEETINGS: f64 = 2.0;
/// Skins that are tried, as multiples of the one that the scene gets.
const TRIED: [f64; 7] = [0.5, 0.65, 0.8, 1.0, 1.25, 1.6, 2.0];

/// Instruction set and precision: `avx2 mixed`.
fn kernel(plan: &ForcePlan) -> String {
    format!("{} {}", plan.isa, plan.precision.name())
}

/// The variants that the options ask for, each once; the first is the one that `auto` would choose.
pub(super) fn variants(
    file: &Path,
    overrides: &[(String, String)],
    isas: &[String],
    precisions: &[String],
    threads: &[usize],
) -> Result<Vec<Variant>, BenchError> {
    let or = |given: &[String], all: Vec<&'static str>| -> Vec<String> {
        if given.is_empty() { all.into_iter().map(str::to_owned).collect() } else { given.to_vec() }
    };
    let isas = or(isas, lennard_forcefield::available_isas());
    let precisions = or(precisions, vec!["double", "mixed"]);
    let available = lennard_core::parallel::processors();
    let mut threads = match threads {
        [] => vec![1, available],
        given => given.to_vec(),
    };
    threads.dedup();
    let mut variants: Vec<Variant> = Vec::new();
    for isa in &isas {
        for precision in &precisions {
            let settings = [("kernel.isa", isa), ("kernel.precision", precision)];
            let settings = settings.map(|(key, value)| (key.to_owned(), value.clone()));
            let overrides: Vec<_> = overrides.iter().cloned().chain(settings).collect();
            let scene = bare(&load(file, &overrides)?);
            // Says here what does not fit, with the key; and what really runs.
            let beginning = lennard_engine::start(&scene)?;
            let (_, forces) = lennard_engine::forces(&scene, beginning.cell, &beginning.species)?;
            let plan = forces.plan();
            for &threads in &threads {
                let runs = |p: &ForcePlan, n: usize| (p.isa, p.precision, p.kernel, n);
                if !variants.iter().any(|v| runs(&v.plan, v.threads) == runs(plan, threads)) {
                    let name = format!("{}, {}", kernel(plan), counted(threads, "thread"));
                    let (scene, plan) = (scene.clone(), plan.clone());
                    variants.push(Variant { name, scene, plan, threads });
                }
            }
        }
    }
    Ok(variants)
}

/// Measures every kernel; forces and list are timed alone beside each block.
pub(super) fn kernels(
    variants: &[Variant],
    blocks: &Blocks<'_>,
    pairs_per_atom: f64,
    progress: &mut dyn Progress,
) -> Result<Vec<KernelResult>, BenchError> {
    let configuration = || blocks.start.configuration();
    let found = blocks.measure(variants, progress, |variant| {
        let mut forces = blocks.start.forces(&variant.scene)?;
        Ok(measure::part_times(&mut forces, configuration(), ROUNDS)?)
    })?;
    let all = variants.iter().zip(&found);
    all.map(|(variant, found)| result(variant, found, blocks, pairs_per_atom)).collect()
}

fn result(
    variant: &Variant,
    found: &[(Block, measure::PartTimes)],
    blocks: &Blocks<'_>,
    pairs_per_atom: f64,
) -> Result<KernelResult, BenchError> {
    let n = blocks.start.len() as f64;
    let atom_steps = n * blocks.steps as f64;
    let of = |value: &dyn Fn(&Block) -> f64| spread(found.iter().map(|(b, _)| value(b)));
    let parts = |value: &dyn Fn(&measure::PartTimes) -> f64| {
        spread(found.iter().map(|(_, p)| value(p) * 1e9 / n))
    };
    let builds: u64 = found.iter().map(|(b, _)| b.builds).sum();
    let has_list = found.iter().all(|(_, p)| p.build > 0.0);
    let seconds = of(&|b| b.seconds);
    let forces_ns = parts(&|p| p.forces);
    let mut forces = blocks.start.forces(&variant.scene)?;
    let work = measure::work(&mut forces, blocks.start.configuration())?;
    let ForcePlan { kernel, isa, precision, skin, .. } = variant.plan;
    let meetings = if kernel == "reference" { 1.0 } else { MEETINGS };
    // Only loops that compute in whole registers could reach the limit.
    let limit = matches!(kernel, "rows" | "cluster")
        .then(|| measure::arithmetic_limit(isa_named(isa), precision))
        .flatten();
    let met = MEETINGS * pairs_per_atom;
    let ideal_ns = |limit: f64| 1e9 * met / (limit * variant.threads as f64);
    let limit_share = limit.map(|l| ideal_ns(l) / forces_ns.lowest);
    let builds_per_block = has_list.then(|| builds as f64 / found.len() as f64);
    let tells_processor_time = variant.threads == 1 && Stopwatch::tells_processor_time();
    Ok(KernelResult {
        kernel: kernel.into(),
        isa: isa.into(),
        precision: precision.name().into(),
        threads: variant.threads,
        speed: of(&|b| atom_steps / b.seconds * 1e-6),
        step_ns: seconds.scaled(blocks.ns_per_second()),
        processor_ns: tells_processor_time
            .then(|| of(&|b| b.on_processor).scaled(blocks.ns_per_second())),
        forces_ns,
        totals_ns: parts(&|p| p.totals),
        build_ns: has_list.then(|| parts(&|p| p.build)),
        list_share: of(&|b| b.neighbor / b.seconds),
        steps_per_build: (builds > 0)
            .then(|| (blocks.steps * found.len() as u64) as f64 / builds as f64),
        skin,
        lanes_per_pair: work.lanes as f64 / (meetings * work.pairs.max(1) as f64),
        limit,
        limit_share,
        bytes_per_atom: STATE_BYTES + found[0].0.bytes as f64 / n,
        doubts: doubts(seconds, builds_per_block, limit_share),
    })
}

fn isa_named(name: &str) -> Isa {
    match name {
        "avx512" => Isa::Avx512,
        "avx2" => Isa::Avx2,
        _ => Isa::Portable,
    }
}

/// Whole steps with several skins on a variant; `None` where it has no list.
pub(super) fn skins(
    variant: &Variant,
    blocks: &Blocks<'_>,
    progress: &mut dyn Progress,
) -> Result<Option<SkinStudy>, BenchError> {
    let own = variant.plan.skin;
    if own <= 0.0 {
        return Ok(None);
    }
    let room = blocks.start.cell.largest_cutoff() - variant.scene.truncation.r_cut;
    let skins: Vec<f64> =
        TRIED.iter().map(|factor| factor * own).filter(|skin| *skin <= room).collect();
    let with = |skin: &f64| {
        let mut tried = Variant { name: format!("skin {skin:.3} σ"), ..variant.clone() };
        tried.scene.neighbor.skin = Some(*skin);
        tried
    };
    let variants: Vec<Variant> = skins.iter().map(with).collect();
    let by_processor = variant.threads == 1 && Stopwatch::tells_processor_time();
    let seconds = |b: &Block| if by_processor { b.on_processor } else { b.seconds };
    let found = blocks.measure(&variants, progress, |_| Ok(()))?;
    let point = |(skin, found): (&f64, &Vec<(Block, ())>)| SkinPoint {
        skin: *skin,
        step_ns: spread(found.iter().map(|(b, ())| seconds(b))).scaled(blocks.ns_per_second()),
    };
    let points: Vec<SkinPoint> = skins.iter().zip(&found).map(point).collect();
    let cost = |p: &&SkinPoint| p.step_ns.median;
    let cheapest = points.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let chosen = points.iter().find(|p| p.skin == own);
    let (Some(cheapest), Some(chosen)) = (cheapest, chosen) else {
        return Ok(None);
    };
    let clock = if by_processor { "processor time" } else { "wall clock" };
    Ok(Some(SkinStudy {
        with: format!("{}, {clock}", variant.name),
        clock,
        chosen: chosen.skin,
        cheapest: cheapest.skin,
        excess: chosen.step_ns.median / cheapest.step_ns.median - 1.0,
        points,
    }))
}
