//! Kernels, precisions and numbers of threads beside one another.

use lennard_core::Want;
use lennard_core::stopwatch::{Spread, Stopwatch};
use lennard_engine::{bare, take};
use lennard_forcefield::{ForcePlan, Isa, measure};
use lennard_scene::Scene;
use serde::Serialize;

use super::blocks::{Blocks, in_turns, spread};
use super::doubts::{self, Doubt};
use super::{BenchError, BenchOptions, Subject, with_range};
use crate::Progress;
use crate::jobs::pool;

/// Evaluations and builds that each repeat times alone. The best counts: on a busy machine most of such short times are
/// disturbed.
const ROUNDS: usize = 3;
/// Bytes per particle of position, velocity and force.
const STATE_BYTES: f64 = 72.0;
/// A full list meets each pair twice.
const MEETINGS: f64 = 2.0;

/// One kernel in one precision on one number of threads.
#[derive(Debug, Clone)]
pub(super) struct Variant {
    /// The scene with these settings and nothing to observe, write or couple to.
    pub(super) scene: Scene,
    /// What the forces really run.
    pub(super) plan: ForcePlan,
    pub(super) threads: usize,
}

impl Variant {
    /// Instruction set and precision: `avx2 mixed`.
    pub(super) fn kernel(&self) -> String {
        format!("{} {}", self.plan.isa, self.plan.precision.name())
    }

    fn is_same(&self, plan: &ForcePlan, threads: usize) -> bool {
        (self.plan.isa, self.plan.precision, self.plan.kernel)
            == (plan.isa, plan.precision, plan.kernel)
            && self.threads == threads
    }
}

/// What one variant did.
#[derive(Debug, Clone, Serialize)]
pub struct KernelResult {
    /// The loop: `rows`, `canonical`, `direct` or `reference`.
    pub kernel: String,
    /// Its instruction set.
    pub isa: String,
    /// Its precision: `double` or `mixed`.
    pub precision: String,
    /// Threads.
    pub threads: usize,
    /// Whole steps, million atom-steps per second.
    pub speed: Spread,
    /// Nanoseconds per particle and whole step.
    pub step_ns: Spread,
    /// The same on the clock of the processor, steadier on a shared machine. `None` for more than one thread, or where
    /// the system does not tell.
    pub processor_ns: Option<Spread>,
    /// Nanoseconds per particle for the forces alone, the list given: packing, check and pair loop.
    pub forces_ns: Spread,
    /// The same with energy, virial and Laplacian.
    pub totals_ns: Spread,
    /// Nanoseconds per particle for one list build; `None` where there is no list.
    pub build_ns: Option<Spread>,
    /// Share of list building in the whole steps.
    pub list_share: Spread,
    /// Steps for each build.
    pub steps_per_build: Option<f64>,
    /// Skin, σ.
    pub skin: f64,
    /// Lanes computed for each pair that counts, met as often as the loop meets it.
    pub lanes_per_pair: f64,
    /// Pairs per second and thread with everything in registers, measured; `None` where this loop has no such measurement.
    pub limit: Option<f64>,
    /// The time of that arithmetic as a share of the shortest force time: the limit is a best time too.
    pub limit_share: Option<f64>,
    /// Bytes per particle in state, lists and private copies.
    pub bytes_per_atom: f64,
    /// What speaks against these figures; empty where nothing does.
    pub doubts: Vec<Doubt>,
}

impl KernelResult {
    /// What its bars are called.
    pub(super) fn label(&self) -> String {
        format!("{} {}", self.isa, self.precision)
    }

    /// The speed with its range, marked where it is to be doubted.
    #[must_use]
    pub fn marked_speed(&self) -> String {
        let is_doubted = self.doubts.iter().any(|doubt| doubt.is_of_speed());
        with_range(self.speed) + if is_doubted { " (?)" } else { "" }
    }

    /// The share of the limit in per cent, marked where it is not possible.
    #[must_use]
    pub fn marked_limit_share(&self) -> String {
        let is_doubted = self.doubts.contains(&Doubt::AboveLimit);
        self.limit_share.map_or_else(
            || "–".into(),
            |share| format!("{:.1} %{}", 100.0 * share, if is_doubted { " (?)" } else { "" }),
        )
    }
}

/// The variants that the options ask for, each once; the first is the one that `auto` would choose.
pub(super) fn plan(
    subject: &Subject,
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
            let scene = bare(&subject.load(&overrides)?);
            // Says here what does not fit, with the key; and what really runs.
            let beginning = lennard_engine::begin(&scene)?;
            let (_, forces) = lennard_engine::forces(&scene, beginning.cell, &beginning.species)?;
            let plan = forces.plan();
            for &threads in &threads {
                if !variants.iter().any(|v| v.is_same(plan, threads)) {
                    variants.push(Variant { scene: scene.clone(), plan: plan.clone(), threads });
                }
            }
        }
    }
    Ok(variants)
}

/// One block of one variant.
struct Block {
    seconds: f64,
    on_processor: f64,
    neighbor: f64,
    builds: u64,
    bytes: u64,
    parts: measure::PartTimes,
}

fn block(variant: &Variant, blocks: &Blocks) -> Result<Block, BenchError> {
    let mut simulation = blocks.simulation(&variant.scene)?;
    let before = simulation.forces.statistics();
    let watch = Stopwatch::start();
    take(&mut simulation, blocks.steps, Want::NOTHING)?;
    let (seconds, on_processor) = (watch.wall(), watch.on_processor());
    let after = simulation.forces.statistics();
    drop(simulation);
    let mut forces = blocks.start.forces(&variant.scene)?;
    Ok(Block {
        seconds,
        on_processor,
        neighbor: after.neighbor_seconds - before.neighbor_seconds,
        builds: after.builds - before.builds,
        bytes: after.bytes,
        parts: measure::part_times(&mut forces, blocks.start.configuration(), ROUNDS)?,
    })
}

/// Measures every variant, `options.repeats` times, in an order that is shuffled each time.
pub(super) fn measure(
    variants: &[Variant],
    blocks: &Blocks,
    options: &BenchOptions,
    progress: &mut dyn Progress,
) -> Result<Vec<KernelResult>, BenchError> {
    let label = |v: &Variant| format!("{}, {} threads", v.kernel(), v.threads);
    let labels: Vec<String> = variants.iter().map(label).collect();
    let pools = variants.iter().map(|v| pool(v.threads));
    let pools = pools.collect::<Result<Vec<_>, _>>()?;
    let found =
        in_turns(&labels, options, progress, |i| pools[i].install(|| block(&variants[i], blocks)))?;
    let result = |(variant, found): (_, &Vec<Block>)| result(variant, found, blocks);
    variants.iter().zip(&found).map(result).collect()
}

fn result(variant: &Variant, found: &[Block], blocks: &Blocks) -> Result<KernelResult, BenchError> {
    let n = blocks.start.len() as f64;
    let atom_steps = n * blocks.steps as f64;
    let of = |value: &dyn Fn(&Block) -> f64| spread(found.iter().map(value));
    let builds: u64 = found.iter().map(|b| b.builds).sum();
    let has_list = found.iter().all(|b| b.parts.build > 0.0);
    let seconds = of(&|b| b.seconds);
    let forces_ns = of(&|b| b.parts.forces * 1e9 / n);
    let mut forces = blocks.start.forces(&variant.scene)?;
    let work = measure::work(&mut forces, blocks.start.configuration())?;
    let ForcePlan { kernel, isa, precision, skin, .. } = variant.plan;
    let meetings = if kernel == "reference" { 1.0 } else { MEETINGS };
    // Only loops that compute in whole registers could reach the limit.
    let limit = matches!(kernel, "rows" | "cluster")
        .then(|| measure::arithmetic_limit(isa_named(isa), precision))
        .flatten();
    let pairs_per_atom = MEETINGS * blocks.pairs_per_atom;
    let ideal_ns = |limit: f64| 1e9 * pairs_per_atom / (limit * variant.threads as f64);
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
        totals_ns: of(&|b| b.parts.totals * 1e9 / n),
        build_ns: has_list.then(|| of(&|b| b.parts.build * 1e9 / n)),
        list_share: of(&|b| b.neighbor / b.seconds),
        steps_per_build: (builds > 0)
            .then(|| (blocks.steps * found.len() as u64) as f64 / builds as f64),
        skin,
        lanes_per_pair: work.lanes as f64 / (meetings * work.pairs.max(1) as f64),
        limit,
        limit_share,
        bytes_per_atom: STATE_BYTES + found[0].bytes as f64 / n,
        doubts: doubts::doubts(seconds, builds_per_block, limit_share),
    })
}

fn isa_named(name: &str) -> Isa {
    match name {
        "avx512" => Isa::Avx512,
        "avx2" => Isa::Avx2,
        _ => Isa::Portable,
    }
}
