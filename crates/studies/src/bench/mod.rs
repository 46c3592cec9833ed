//! `lennard bench`: force loop alone, list build alone and whole steps, for each kernel, precision and number of threads.
//!
//! Every block of steps starts from the same state, so that all variants do the same work. Each repeat shuffles the order
//! of the blocks, so that a machine that slows down slows all variants down. Nothing here decides anything about a run.

mod blocks;
mod doubts;
mod features;
mod figures;
mod page;
mod skins;
mod variants;

use std::path::{Path, PathBuf};

use crate::report::significant;
use blocks::Blocks;
use lennard_core::stopwatch::Spread;
use lennard_engine::EngineError;
use lennard_scene::{Scene, SceneError};
use serde::Serialize;

pub use doubts::Doubt;
pub use features::{Feature, FeatureStudy};
pub use page::{features as feature_table, kernels as kernel_table};
pub use skins::{SkinPoint, SkinStudy};
pub use variants::KernelResult;

use crate::{Progress, StudyError, files};

/// The shipped scene that runs where no scene is named: 32,000 particles melting.
const MELT: &str = "shipped:/bench/melt-32k.toml";
/// The shipped scene of a quick look: 864 particles.
const FLUID: &str = "shipped:/bench/fluid-864.toml";

/// What is measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Subject {
    /// A built-in case: `inputs/bench/melt-32k.toml`, or `inputs/bench/fluid-864.toml` for a quick look.
    BuiltIn {
        /// Whether the small one.
        quick: bool,
    },
    /// A scene file.
    File(PathBuf),
}

impl Subject {
    /// The scene with overrides.
    ///
    /// # Errors
    /// [`SceneError`] where the file or an override is wrong.
    pub fn load(&self, overrides: &[(String, String)]) -> Result<Scene, SceneError> {
        match self {
            Self::BuiltIn { quick } => {
                let name = if *quick { FLUID } else { MELT };
                Scene::load(Path::new(name), overrides)
            }
            Self::File(path) => {
                let scene = Scene::load(path, overrides)?;
                scene.homogeneous_for("lennard bench")?;
                Ok(scene)
            }
        }
    }
}

/// What to measure and how often.
#[derive(Debug, Clone)]
pub struct BenchOptions {
    /// The scene.
    pub subject: Subject,
    /// Overrides of its keys.
    pub overrides: Vec<(String, String)>,
    /// Instruction sets; empty for all that this processor has.
    pub isas: Vec<String>,
    /// Precisions; empty for both.
    pub precisions: Vec<String>,
    /// Numbers of threads; empty for 1 and all.
    pub threads: Vec<usize>,
    /// Blocks of steps for each variant.
    pub repeats: usize,
    /// Shorter blocks.
    pub quick: bool,
    /// Measure what each feature of a scene costs, in place of the kernels.
    pub features: bool,
    /// A folder for the files that measuring writes.
    pub scratch: PathBuf,
    /// The command that is printed below figures and tables.
    pub command: String,
    /// Names and values of the machine, for the record.
    pub machine: Vec<(String, String)>,
}

/// Why there is nothing to show.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The scene, or a setting laid over it, is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A variant cannot be built or run.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The forces of a variant failed.
    #[error("the forces failed while they were timed: {0}")]
    Force(#[from] lennard_core::ForceError),
    /// The bare loop failed.
    #[error("the bare loop failed: {0}")]
    Step(#[from] lennard_core::StepError),
    /// Results cannot be drawn or written.
    #[error(transparent)]
    Study(#[from] StudyError),
}

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub struct BenchStudy {
    /// Schema of this document.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// The model in words.
    pub model: String,
    /// Number of particles.
    pub atoms: usize,
    /// Number density, σ⁻³.
    pub density: f64,
    /// Cutoff, σ.
    pub r_cut: f64,
    /// Pairs within the cutoff for each particle, each counted once.
    pub pairs_per_atom: f64,
    /// Temperature of the state that every block starts from, ε/k_B.
    pub temperature: f64,
    /// Steps of a block.
    pub steps: u64,
    /// Blocks for each variant.
    pub repeats: usize,
    /// The command.
    pub command: String,
    /// Names and values of the machine.
    pub machine: Vec<(String, String)>,
    /// The variants, fastest instruction set first; empty where features were measured.
    pub kernels: Vec<KernelResult>,
    /// How the skin was found to be; `None` where there is no list or features were measured.
    pub skin: Option<SkinStudy>,
    /// What features cost, where that was asked for.
    pub features: Option<FeatureStudy>,
}

impl BenchStudy {
    /// What speaks against the figures, in sentences; empty where nothing does.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        let scattered = [Doubt::Scattered];
        let of_skins = self.skin.iter().flat_map(|skin| &skin.points);
        let of_features = self.features.iter().flat_map(|f| [&f.bare_ns, &f.off_ns]);
        let others = of_skins
            .map(|point| &point.step_ns)
            .chain(of_features)
            .filter(|spread| spread.is_scattered())
            .map(|_| scattered.as_slice());
        let of_kernels = self.kernels.iter().map(|k| k.doubts.as_slice());
        doubts::sentences(of_kernels.chain(others))
    }
}

/// Whether everything that is asked for can run here; nothing is measured.
///
/// # Errors
/// [`BenchError`] as from [`run`].
pub fn check(
    subject: &Subject,
    overrides: &[(String, String)],
    isas: &[String],
    precisions: &[String],
) -> Result<(), BenchError> {
    variants::plan(subject, overrides, isas, precisions, &[1]).map(drop)
}

/// Measures.
///
/// # Errors
/// [`BenchError`] where the scene is wrong, a variant is not to be had on this machine, or its run fails.
pub fn run(options: &BenchOptions, progress: &mut dyn Progress) -> Result<BenchStudy, BenchError> {
    let plan = variants::plan(
        &options.subject,
        &options.overrides,
        &options.isas,
        &options.precisions,
        &options.threads,
    )?;
    let most = plan.iter().map(|variant| variant.threads).max();
    let blocks = Blocks::warmed(&plan[0].scene, most.unwrap_or(1), options, progress)?;
    let mut study = BenchStudy {
        schema: lennard_io::schema!("bench", 1),
        scene: plan[0].scene.name.to_string(),
        model: plan[0].scene.model_name(),
        atoms: blocks.start.len(),
        density: blocks.start.density(),
        r_cut: plan[0].scene.truncation.r_cut,
        pairs_per_atom: blocks.pairs_per_atom,
        temperature: blocks.temperature(),
        steps: blocks.steps,
        repeats: options.repeats,
        command: options.command.clone(),
        machine: options.machine.clone(),
        kernels: Vec::new(),
        skin: None,
        features: None,
    };
    if options.features {
        let progress = &mut Part(progress, 0.05, 0.95);
        study.features = Some(features::measure(&plan[0], &blocks, options, progress)?);
    } else {
        study.kernels = variants::measure(&plan, &blocks, options, &mut Part(progress, 0.05, 0.8))?;
        study.skin = skins::measure(&plan[0], &blocks, options, &mut Part(progress, 0.8, 1.0))?;
    }
    progress.update("done", 1.0);
    Ok(study)
}

/// Writes `bench.json`, CSV tables, SVG figures (in `figures/`) and `report.html` into `dir`.
///
/// # Errors
/// [`StudyError`] where a figure cannot be drawn or a file cannot be written.
pub fn write(study: &BenchStudy, dir: &Path) -> Result<(), StudyError> {
    let page = page::page(study);
    files::write_all(dir, &page::csv(study), ("bench.json", study), &page)
}

/// For a reader: `12.3 (11.9–13.0)`, the median with its range.
#[must_use]
pub fn with_range(spread: Spread) -> String {
    let [median, lowest, highest] =
        [spread.median, spread.lowest, spread.highest].map(|value| significant(value, 3));
    format!("{median} ({lowest}–{highest})")
}

/// A part of the whole work, as progress shows it.
struct Part<'a>(&'a mut dyn Progress, f64, f64);

impl Progress for Part<'_> {
    fn update(&mut self, label: &str, done: f64) {
        self.0.update(label, self.1 + (self.2 - self.1) * done);
    }
}

#[cfg(test)]
mod tests;
