//! `lennard study bench`: force loop alone, list build alone and whole steps, for each kernel, precision and number of threads.
//!
//! Every block of steps starts from the same state, so that all variants do the same work. Each repeat shuffles the order
//! of the blocks, so that a machine that slows down slows all variants down. Nothing here decides anything about a run.

mod kernels;
mod page;

use std::path::{Path, PathBuf};
use std::time::Duration;

use kernels::{Blocks, Variant};
use lennard_core::parallel::pool;
use lennard_engine::stopwatch::{BUSY, Spread};
use lennard_forcefield::measure;
use lennard_observables::Table;
use lennard_scene::{Scene, SceneError};
pub use page::kernels as kernel_table;
use serde::Serialize;

use crate::jobs::Part;
use crate::lab::{Start, to_temperature};
use crate::lists::unique;
use crate::report::{Page, significant};
use crate::{Progress, Study, StudyError};

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

/// A benchmark that can run here.
#[derive(Debug)]
pub struct Bench {
    /// The scene as it was asked for.
    pub scene: Scene,
    options: BenchOptions,
    plan: Vec<Variant>,
}

impl Bench {
    /// Builds each variant; nothing is measured.
    ///
    /// # Errors
    /// [`StudyError`] where the scene is wrong, or a variant is not to be had on this machine.
    pub fn new(options: BenchOptions) -> Result<Self, StudyError> {
        let scene = load(&options.scene, &options.overrides)?;
        let plan = kernels::variants(&options)?;
        Ok(Self { scene, options, plan })
    }

    /// Measures.
    ///
    /// # Errors
    /// [`StudyError`] where the run of a variant fails.
    pub fn run(&self, progress: &mut dyn Progress) -> Result<BenchStudy, StudyError> {
        let Self { scene: asked, options, plan } = self;
        let scene = &plan[0].scene;
        let most = plan.iter().map(|variant| variant.threads).max();
        progress.update("warming up", 0.0);
        let (warm_steps, block) = if options.quick { WARM_QUICK } else { WARM };
        // Where the scene of the user has a bath, the state has the temperature of its measured stage. Without one a lattice melts at
        // constant energy and cools, as it does in a run.
        let mut warming = scene.clone();
        if asked.stages.iter().any(|stage| stage.thermostat.is_some()) {
            warming.stages = vec![to_temperature(scene, lennard_engine::ENDLESS)];
        }
        let warmed =
            pool(most.unwrap_or(1))?.install(|| Start::warmed(warming, warm_steps, WARM_FOR));
        let (start, seconds) = warmed?;
        let steps = ((block / seconds) as u64).clamp(FEWEST_STEPS, MOST_STEPS);
        let pairs = measure::work(&mut start.forces(scene)?, start.configuration())?.pairs;
        let pairs_per_atom = pairs as f64 / start.len() as f64;
        let blocks = Blocks { start: &start, steps, repeats: options.repeats };
        let kernels =
            kernels::kernels(plan, &blocks, pairs_per_atom, &mut Part::of(progress, 0.05, 0.8))?;
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

/// The shipped scene that runs where no scene is named: 32,000 particles melting.
const MELT: &str = "shipped:/bench/melt-32k.toml";
/// The shipped scene of a quick look: 864 particles.
const FLUID: &str = "shipped:/bench/fluid-864.toml";

/// The file of the scene that is measured where none is named: the small one for a quick look.
#[must_use]
pub fn usual_scene(quick: bool) -> PathBuf {
    if quick { FLUID } else { MELT }.into()
}

/// The scene of a file with overrides.
///
/// # Errors
/// [`SceneError`] where the file or an override is wrong, or the scene is no homogeneous fluid.
pub fn load(file: &Path, overrides: &[(String, String)]) -> Result<Scene, SceneError> {
    let scene = Scene::load(file, overrides)?;
    scene.homogeneous_for("lennard study bench")?;
    Ok(scene)
}

/// What to measure and how often.
#[derive(Debug, Clone)]
pub struct BenchOptions {
    /// The file of the scene.
    pub scene: PathBuf,
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
    /// The command that is printed below figures and tables.
    pub command: String,
    /// Names and values of the machine, for the record.
    pub machine: Vec<(String, String)>,
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
    /// The variants, fastest instruction set first.
    pub kernels: Vec<KernelResult>,
    /// How the skin was found to be; `None` where there is no list.
    pub skin: Option<SkinStudy>,
}

impl BenchStudy {
    /// What speaks against the figures, in sentences, each once; empty where nothing does.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        let of_skins = self.skin.iter().flat_map(|skin| &skin.points);
        let scattered = of_skins.filter(|p| p.step_ns.is_scattered()).map(|_| Doubt::Scattered);
        let of_kernels = self.kernels.iter().flat_map(|k| k.doubts.iter().copied());
        unique(of_kernels.chain(scattered).map(Doubt::sentence))
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
    pub(crate) fn marked_speed(&self) -> String {
        let is_doubted = self.doubts.iter().any(|doubt| doubt.is_of_speed());
        with_range(self.speed) + if is_doubted { " (?)" } else { "" }
    }

    /// The share of the limit in per cent, marked where it is not possible.
    pub(crate) fn marked_limit_share(&self) -> String {
        let is_doubted = self.doubts.contains(&Doubt::AboveLimit);
        self.limit_share.map_or_else(
            || "–".into(),
            |share| format!("{:.1} %{}", 100.0 * share, if is_doubted { " (?)" } else { "" }),
        )
    }
}

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

/// A block below this, s, is as long as what disturbs it.
const SHORT: f64 = 0.02;
/// Fewest list builds of a block of which one more or less changes little.
const FEWEST_BUILDS: f64 = 3.0;

/// Why a figure is to be doubted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Doubt {
    /// Blocks of the same work took times that differ by more than a fifth.
    Scattered,
    /// Blocks were too short for the clock of a shared machine.
    ShortBlocks,
    /// Blocks hold so few list builds that one more or less is seen.
    FewBuilds,
    /// The arithmetic limit was passed, which nothing can.
    AboveLimit,
}

impl Doubt {
    /// What it means for the reader.
    pub(crate) fn sentence(self) -> String {
        match self {
            Self::Scattered => format!(
                "times of blocks differ by more than {:.0} % of their median: the machine was busy",
                100.0 * BUSY
            ),
            Self::ShortBlocks => format!(
                "blocks took less than {:.0} ms, too short for a figure to rest on",
                1e3 * SHORT
            ),
            Self::FewBuilds => format!(
                "blocks hold fewer than {FEWEST_BUILDS:.0} list builds, so that one more or less changes the figure"
            ),
            Self::AboveLimit => {
                "a share of the limit above 100 % means that the limit was measured on a busy machine, or does not hold for this model"
                    .into()
            }
        }
    }

    /// Whether it is about the speed, not about the limit.
    pub(crate) fn is_of_speed(self) -> bool {
        self != Self::AboveLimit
    }
}

/// What speaks against the figures of some blocks.
pub(super) fn doubts(
    seconds: Spread,
    builds_per_block: Option<f64>,
    limit_share: Option<f64>,
) -> Vec<Doubt> {
    [
        (Doubt::Scattered, seconds.is_scattered()),
        (Doubt::ShortBlocks, seconds.median < SHORT),
        (Doubt::FewBuilds, builds_per_block.is_some_and(|builds| builds < FEWEST_BUILDS)),
        (Doubt::AboveLimit, limit_share.is_some_and(|share| share > 1.0)),
    ]
    .into_iter()
    .filter_map(|(doubt, holds)| holds.then_some(doubt))
    .collect()
}

/// For a reader: `12.3 (11.9–13.0)`, the median with its range.
pub(crate) fn with_range(spread: Spread) -> String {
    let [median, lowest, highest] =
        [spread.median, spread.lowest, spread.highest].map(|value| significant(value, 3));
    format!("{median} ({lowest}–{highest})")
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod tests_of_types {
    use super::*;

    #[test]
    fn short_scattered_and_impossible_figures_are_doubted_and_sound_ones_are_not() {
        let of = |seconds: &[f64]| Spread::of(seconds.iter().copied()).unwrap();
        let sound = of(&[0.100, 0.105, 0.119]);
        assert_eq!(doubts(sound, Some(8.0), Some(0.93)), []);
        assert_eq!(doubts(sound, None, None), []);
        let scattered = of(&[0.100, 0.105, 0.125]);
        assert_eq!(doubts(scattered, Some(8.0), None), [Doubt::Scattered]);
        assert_eq!(
            doubts(of(&[0.0199]), Some(2.0), Some(1.82)),
            [Doubt::ShortBlocks, Doubt::FewBuilds, Doubt::AboveLimit]
        );
    }
}
