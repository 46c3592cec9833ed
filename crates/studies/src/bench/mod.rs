//! `lennard study bench`: force loop alone, list build alone and whole steps, for each kernel, precision and number of threads.
//!
//! Every block of steps starts from the same state, so that all variants do the same work. Each repeat shuffles the order
//! of the blocks, so that a machine that slows down slows all variants down. Nothing here decides anything about a run.

mod kernels;
mod page;
mod types;
mod variants;

pub use page::kernels as kernel_table;
pub use types::{
    BenchError, BenchOptions, BenchStudy, Doubt, KernelResult, SkinPoint, SkinStudy, load,
    usual_scene, with_range,
};

use std::path::Path;
use std::time::Duration;

use lennard_forcefield::measure;
use lennard_observables::Table;

use crate::jobs::pool;
use crate::lab::{Start, to_temperature};
use crate::progress::Part;
use crate::report::Page;
use crate::{Progress, Study, StudyError};
use variants::Blocks;

/// Least number of steps before the measurement, in which a lattice melts, and how long a block of them should take, s.
const WARM: (u64, f64) = (300, 0.1);
/// The same for a quick look, where a half-molten crystal is good enough.
const WARM_QUICK: (u64, f64) = (100, 0.025);
/// How long the warm-up may take.
const WARM_FOR: Duration = Duration::from_secs(5);
/// Fewest steps of a block: several lives of a list.
const FEWEST_STEPS: u64 = 20;
/// Longer blocks of a tiny system say nothing more.
const MOST_STEPS: u64 = 20_000;

/// Whether everything that is asked for can run here; nothing is measured.
///
/// # Errors
/// [`BenchError`] as from [`run`].
pub fn check(
    scene: &Path,
    overrides: &[(String, String)],
    isas: &[String],
    precisions: &[String],
) -> Result<(), BenchError> {
    kernels::variants(scene, overrides, isas, precisions, &[1]).map(drop)
}

/// Measures.
///
/// # Errors
/// [`BenchError`] where the scene is wrong, a variant is not to be had on this machine, or its run fails.
pub fn run(options: &BenchOptions, progress: &mut dyn Progress) -> Result<BenchStudy, BenchError> {
    let plan = kernels::variants(
        &options.scene,
        &options.overrides,
        &options.isas,
        &options.precisions,
        &options.threads,
    )?;
    let scene = &plan[0].scene;
    let most = plan.iter().map(|variant| variant.threads).max();
    progress.update("warming up", 0.0);
    let (warm_steps, block) = if options.quick { WARM_QUICK } else { WARM };
    // Where the scene of the user has a bath, the state has the temperature of its measured stage. Without one a lattice melts at
    // constant energy and cools, as it does in a run.
    let mut warming = scene.clone();
    let asked = load(&options.scene, &options.overrides)?;
    if asked.stages.iter().any(|stage| stage.thermostat.is_some()) {
        warming.stages = vec![to_temperature(scene, lennard_engine::ENDLESS)];
    }
    let warmed = pool(most.unwrap_or(1))?.install(|| Start::warmed(warming, warm_steps, WARM_FOR));
    let (start, seconds) = warmed?;
    let steps = ((block / seconds) as u64).clamp(FEWEST_STEPS, MOST_STEPS);
    let pairs = measure::work(&mut start.forces(scene)?, start.configuration())?.pairs;
    let pairs_per_atom = pairs as f64 / start.len() as f64;
    let blocks = Blocks { start: &start, steps, repeats: options.repeats };
    let kernels =
        kernels::kernels(&plan, &blocks, pairs_per_atom, &mut Part::of(progress, 0.05, 0.8))?;
    let skin = kernels::skins(&plan[0], &blocks, &mut Part::of(progress, 0.8, 1.0))?;
    progress.update("done", 1.0);
    Ok(BenchStudy {
        schema: lennard_io::schema!("bench", 1),
        scene: scene.name.to_string(),
        model: scene.model_name(),
        atoms: start.len(),
        density: start.density(),
        r_cut: scene.truncation.r_cut,
        pairs_per_atom,
        temperature: start.temperature(),
        steps,
        repeats: options.repeats,
        command: options.command.clone(),
        machine: options.machine.clone(),
        kernels,
        skin,
    })
}

impl Study for BenchStudy {
    const JSON: &'static str = "bench.json";

    fn tables(&self) -> Vec<Table> {
        page::csv(self)
    }

    fn page(&self) -> Result<Page, StudyError> {
        page::page(self)
    }
}

#[cfg(test)]
mod tests;
