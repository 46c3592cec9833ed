//! Kernels, precisions and numbers of threads beside one another.

use lennard_forcefield::{Isa, Precision, measure};
use lennard_scene::Scene;
use serde::Serialize;

use super::blocks::{Start, take};
use super::clock::{Clock, tells_processor_time};
use super::doubts::{self, Doubt};
use super::{BenchError, BenchOptions, Spread, Subject};
use crate::Progress;
use crate::jobs::pool;
use crate::settings::shuffled;

/// Steps of the one stage that is measured: more than any block takes.
const ENDLESS: u64 = 1_000_000_000_000_000;
/// Evaluations and builds that each repeat times alone, of which the best counts: they are too short for a machine that is
/// not alone to be undisturbed in most of them.
const ROUNDS: usize = 3;
/// Bytes of position, velocity and force of a particle.
const STATE_BYTES: f64 = 72.0;
/// A full list meets each pair twice.
const MEETINGS: f64 = 2.0;

/// One kernel in one precision on one number of threads.
#[derive(Debug, Clone)]
pub(super) struct Variant {
    /// The scene with these settings and nothing to observe, write or couple to.
    pub(super) scene: Scene,
    pub(super) isa: &'static str,
    pub(super) precision: Precision,
    pub(super) kernel: &'static str,
    pub(super) skin: f64,
    pub(super) threads: usize,
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
    /// Million atom-steps a second, whole steps.
    pub speed: Spread,
    /// Nanoseconds an atom and whole step.
    pub step_ns: Spread,
    /// The same in time that the thread really had a processor, on a shared machine a steadier measure; `None` for more
    /// than one thread, or where the system does not tell.
    pub processor_ns: Option<Spread>,
    /// Nanoseconds an atom for the forces alone, the list given: packing, check and pair loop.
    pub forces_ns: Spread,
    /// The same with energy, virial and Laplacian.
    pub totals_ns: Spread,
    /// Nanoseconds an atom for one list build; `None` where there is no list.
    pub build_ns: Option<Spread>,
    /// Share of list building in the whole steps.
    pub list_share: Spread,
    /// Steps for each build.
    pub steps_per_build: Option<f64>,
    /// Skin, σ.
    pub skin: f64,
    /// Lanes computed for each pair that counts, met as often as the loop meets it.
    pub lanes_per_pair: f64,
    /// Pairs a second and thread with everything in registers, measured; `None` where this loop has no such measurement.
    pub limit: Option<f64>,
    /// The time of that arithmetic as a share of the shortest force time: the limit is a best time too.
    pub limit_share: Option<f64>,
    /// Bytes an atom in state, lists and private copies.
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
        self.speed.with_range() + if is_doubted { " (?)" } else { "" }
    }

    /// The share of the limit in per cent, marked where it is not possible.
    #[must_use]
    pub fn marked_limit_share(&self) -> String {
        let is_doubted = self.doubts.contains(&Doubt::AboveLimit);
        self.limit_share.map_or_else(
            || "–".into(),
            |share| {
                format!(
                    "{:.1} %{}",
                    100.0 * share,
                    if is_doubted { " (?)" } else { "" }
                )
            },
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
        if given.is_empty() {
            all.into_iter().map(str::to_owned).collect()
        } else {
            given.to_vec()
        }
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
            let scene = bare(subject.load(&overrides)?);
            // Says here what does not fit, with the key; and what really runs.
            let beginning = lennard_engine::begin(&scene)?;
            let (_, forces) =
                lennard_engine::forces(&scene, beginning.cell, beginning.positions.len())?;
            let plan = forces.plan();
            for &threads in &threads {
                let known = variants.iter().any(|v| {
                    (v.isa, v.precision, v.kernel, v.threads)
                        == (plan.isa, plan.precision, plan.kernel, threads)
                });
                if !known {
                    variants.push(Variant {
                        scene: scene.clone(),
                        isa: plan.isa,
                        precision: plan.precision,
                        kernel: plan.kernel,
                        skin: plan.skin,
                        threads,
                    });
                }
            }
        }
    }
    Ok(variants)
}

/// The scene's last measured stage at constant energy, without end, with nothing to observe or write.
fn bare(mut scene: Scene) -> Scene {
    let last = scene
        .stages
        .iter()
        .rposition(|s| s.measure)
        .unwrap_or(scene.stages.len() - 1);
    let mut stage = scene.stages.swap_remove(last);
    stage.steps = ENDLESS;
    stage.thermostat = None;
    stage.measure = false;
    scene.stages = vec![stage];
    scene.observables.clear();
    scene.output.trajectory_every = None;
    scene
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

fn block(variant: &Variant, start: &Start) -> Result<Block, BenchError> {
    pool(variant.threads)?.install(|| {
        let mut simulation = start.simulation(&variant.scene)?;
        let before = simulation.forces.statistics();
        let clock = Clock::start();
        take(&mut simulation, start.steps)?;
        let (seconds, on_processor) = (clock.wall(), clock.on_processor());
        let after = simulation.forces.statistics();
        drop(simulation);
        let (_, mut forces) =
            lennard_engine::forces(&variant.scene, start.cell, start.state.len())?;
        let parts = measure::part_times(&mut forces, start.configuration(), ROUNDS)?;
        Ok(Block {
            seconds,
            on_processor,
            neighbor: after.neighbor_seconds - before.neighbor_seconds,
            builds: after.builds - before.builds,
            bytes: after.bytes,
            parts,
        })
    })
}

/// Measures every variant, `options.repeats` times, in an order that is shuffled each time.
pub(super) fn measure(
    variants: &[Variant],
    start: &Start,
    options: &BenchOptions,
    progress: &mut dyn Progress,
) -> Result<Vec<KernelResult>, BenchError> {
    let mut blocks: Vec<Vec<Block>> = variants.iter().map(|_| Vec::new()).collect();
    in_shuffled_rounds(variants.len(), options.repeats, |i, share| {
        let v = &variants[i];
        progress.update(
            &format!(
                "{} {}, {} threads",
                v.isa,
                precision_name(v.precision),
                v.threads
            ),
            share,
        );
        blocks[i].push(block(v, start)?);
        Ok(())
    })?;
    variants
        .iter()
        .zip(&blocks)
        .map(|(v, b)| result(v, b, start))
        .collect()
}

/// Calls `work` for every item in every round, in another order each round; tells the share done before.
pub(super) fn in_shuffled_rounds(
    items: usize,
    rounds: usize,
    mut work: impl FnMut(usize, f64) -> Result<(), BenchError>,
) -> Result<(), BenchError> {
    // The order is no secret and no physics: any fixed seed will do.
    for round in 0..rounds {
        for (done, item) in shuffled(items, 1, round).into_iter().enumerate() {
            work(
                item,
                (round * items + done) as f64 / (rounds * items) as f64,
            )?;
        }
    }
    Ok(())
}

fn result(variant: &Variant, blocks: &[Block], start: &Start) -> Result<KernelResult, BenchError> {
    let n = start.state.len() as f64;
    let atom_steps = n * start.steps as f64;
    let spread = |of: &dyn Fn(&Block) -> f64| Spread::of(blocks.iter().map(of));
    let builds: u64 = blocks.iter().map(|b| b.builds).sum();
    let has_list = blocks.iter().all(|b| b.parts.build > 0.0);
    let forces_ns = spread(&|b| b.parts.forces * 1e9 / n);
    let (_, mut forces) = lennard_engine::forces(&variant.scene, start.cell, start.state.len())?;
    let work = measure::work(&mut forces, start.configuration())?;
    let meetings = if variant.kernel == "reference" {
        1.0
    } else {
        MEETINGS
    };
    // The limit is that of the loops that compute in whole registers: no other loop could reach it.
    let limit = matches!(variant.kernel, "rows" | "cluster")
        .then(|| measure::arithmetic_limit(isa(variant.isa), variant.precision))
        .flatten();
    let ideal_ns =
        |limit: f64| 1e9 * MEETINGS * start.pairs_per_atom / (limit * variant.threads as f64);
    let seconds = spread(&|b| b.seconds);
    let limit_share = limit.map(|l| ideal_ns(l) / forces_ns.lowest);
    let builds_per_block = has_list.then(|| builds as f64 / blocks.len() as f64);
    Ok(KernelResult {
        kernel: variant.kernel.into(),
        isa: variant.isa.into(),
        precision: precision_name(variant.precision).into(),
        threads: variant.threads,
        speed: spread(&|b| atom_steps / b.seconds * 1e-6),
        step_ns: spread(&|b| b.seconds * 1e9 / atom_steps),
        processor_ns: (variant.threads == 1 && tells_processor_time())
            .then(|| spread(&|b| b.on_processor * 1e9 / atom_steps)),
        forces_ns,
        totals_ns: spread(&|b| b.parts.totals * 1e9 / n),
        build_ns: has_list.then(|| spread(&|b| b.parts.build * 1e9 / n)),
        list_share: spread(&|b| b.neighbor / b.seconds),
        steps_per_build: (builds > 0)
            .then(|| (start.steps * blocks.len() as u64) as f64 / builds as f64),
        skin: variant.skin,
        lanes_per_pair: work.lanes as f64 / (meetings * work.pairs.max(1) as f64),
        limit,
        limit_share,
        bytes_per_atom: STATE_BYTES + blocks[0].bytes as f64 / n,
        doubts: doubts::doubts(seconds, builds_per_block, limit_share),
    })
}

fn isa(name: &str) -> Isa {
    match name {
        "avx512" => Isa::Avx512,
        "avx2" => Isa::Avx2,
        _ => Isa::Portable,
    }
}

pub(super) fn precision_name(precision: Precision) -> &'static str {
    match precision {
        Precision::Double => "double",
        Precision::Mixed => "mixed",
    }
}
