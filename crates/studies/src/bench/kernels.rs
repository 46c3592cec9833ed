//! Kernels, precisions and numbers of threads beside one another, and skins around the one that the scene gets.

use lennard_core::Want;
use lennard_engine::stopwatch::{Spread, Stopwatch, in_turn};
use lennard_engine::{bare, take};
use lennard_forcefield::{ForcePlan, Isa, measure};
use lennard_scene::Scene;

use super::{BenchOptions, KernelResult, SkinPoint, SkinStudy, doubts, load};
use crate::lab::Start;
use crate::report::counted;
use crate::{Progress, StudyError};
use lennard_core::parallel::pool;

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
pub(super) fn variants(options: &BenchOptions) -> Result<Vec<Variant>, StudyError> {
    let or = |given: &[String], all: Vec<&'static str>| -> Vec<String> {
        if given.is_empty() { all.into_iter().map(str::to_owned).collect() } else { given.to_vec() }
    };
    let isas = or(&options.isas, lennard_forcefield::available_isas());
    let precisions = or(&options.precisions, vec!["double", "mixed"]);
    let available = lennard_core::parallel::processors();
    let mut threads = match &options.threads[..] {
        [] => vec![1, available],
        given => given.to_vec(),
    };
    threads.dedup();
    let mut variants: Vec<Variant> = Vec::new();
    for isa in &isas {
        for precision in &precisions {
            let settings = [("kernel.isa", isa), ("kernel.precision", precision)];
            let settings = settings.map(|(key, value)| (key.to_owned(), value.clone()));
            let overrides: Vec<_> = options.overrides.iter().cloned().chain(settings).collect();
            let scene = bare(&load(&options.scene, &overrides)?);
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
) -> Result<Vec<KernelResult>, StudyError> {
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
) -> Result<KernelResult, StudyError> {
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
) -> Result<Option<SkinStudy>, StudyError> {
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

/// One row of a benchmark.
#[derive(Debug, Clone)]
pub(super) struct Variant {
    /// What progress calls it.
    pub(super) name: String,
    /// The scene with these settings and nothing to observe, write or couple to.
    pub(super) scene: Scene,
    /// What the forces really run.
    pub(super) plan: ForcePlan,
    pub(super) threads: usize,
}

/// What every row starts from, and for how long.
pub(super) struct Blocks<'a> {
    pub(super) start: &'a Start,
    /// Steps of a block.
    pub(super) steps: u64,
    /// Blocks of each row.
    pub(super) repeats: usize,
}

/// One block of one row.
pub(super) struct Block {
    /// Seconds on the wall, and on the processor of the calling thread.
    pub(super) seconds: f64,
    pub(super) on_processor: f64,
    /// Seconds of list building, and the lists that were built.
    pub(super) neighbor: f64,
    pub(super) builds: u64,
    pub(super) bytes: u64,
}

impl Blocks<'_> {
    /// Times a block of each row in each round, in shuffled turns: all blocks of each row, with what `more` measures beside each.
    pub(super) fn measure<T: Send>(
        &self,
        variants: &[Variant],
        progress: &mut dyn Progress,
        more: impl Fn(&Variant) -> Result<T, StudyError> + Sync,
    ) -> Result<Vec<Vec<(Block, T)>>, StudyError> {
        let pools = variants.iter().map(|v| pool(v.threads));
        let pools = pools.collect::<Result<Vec<_>, _>>()?;
        let mut blocks: Vec<Vec<(Block, T)>> = variants.iter().map(|_| Vec::new()).collect();
        // The order is no secret and no physics: any fixed seed will do.
        in_turn(variants.len(), self.repeats, 1, |turn| {
            let variant = &variants[turn.item];
            progress.update(&variant.name, turn.done);
            let found = pools[turn.item]
                .install(|| Ok::<_, StudyError>((self.block(&variant.scene)?, more(variant)?)))?;
            blocks[turn.item].push(found);
            Ok::<(), StudyError>(())
        })?;
        Ok(blocks)
    }

    fn block(&self, scene: &Scene) -> Result<Block, StudyError> {
        let mut simulation = self.start.settled(scene.clone())?;
        let before = simulation.forces.statistics();
        let watch = Stopwatch::start();
        take(&mut simulation, self.steps, Want::NOTHING)?;
        let (seconds, on_processor) = (watch.wall(), watch.on_processor());
        let after = simulation.forces.statistics();
        Ok(Block {
            seconds,
            on_processor,
            neighbor: after.neighbor_seconds - before.neighbor_seconds,
            builds: after.builds - before.builds,
            bytes: after.bytes,
        })
    }

    /// Nanoseconds per particle and step in a second of a block.
    pub(super) fn ns_per_second(&self) -> f64 {
        1e9 / (self.start.len() as f64 * self.steps as f64)
    }
}

/// The spread of repeated blocks.
///
/// # Panics
/// Where there are no values: nothing is measured less than once.
pub(super) fn spread(values: impl IntoIterator<Item = f64>) -> Spread {
    Spread::of(values).expect("measured at least once")
}
