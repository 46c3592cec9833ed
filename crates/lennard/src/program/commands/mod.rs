//! One file a command.

pub mod bench;
pub mod chart;
pub mod compare;
pub mod documents;
pub mod energy;
pub mod eos;
pub mod export;
mod inputs;
pub mod list;
pub mod measure;
pub mod new;
pub mod plan;
pub mod resume;
pub mod run;
pub mod stability;
pub mod sweep;
pub mod tune;

use std::path::Path;
use std::sync::Arc;

use lennard_core::parallel::{self, PoolError};
use lennard_engine::EngineError;
use lennard_io::{Existing, OutputFolder};
use lennard_scene::{Scene, UsedLock};
use serde::Serialize;

use crate::program::args::SceneArgs;
pub use crate::program::commands::inputs::Inputs;
use crate::program::failure::{DONE, Failure, INPUT, OTHER};
use crate::program::out;
use crate::program::signals::{Signals, StartUp};

/// Loads the scene of a command with its overrides. Where the scene asks for an accuracy, the settings of its
/// lock file are added, if there is one. Without a lock file, a scene that leaves settings to be chosen is
/// refused where it would be built.
pub fn load_locked(args: &SceneArgs) -> Result<(Scene, Option<UsedLock>), Failure> {
    Ok(Scene::load_settled(&args.scene, &args.overrides(), args.lock.as_deref())?)
}

impl SceneArgs {
    /// The files that the scene was read from.
    pub fn inputs(&self, scene: &Scene, lock: Option<&UsedLock>) -> Inputs {
        Inputs::of_scene(&self.scene, lock.map(|l| l.path.as_path()), scene)
    }
}

/// As many threads as asked for, or as the lock file says and this machine has, or as pay for so many particles.
pub fn threads_with(asked: Option<u16>, lock: Option<&UsedLock>, n_atoms: usize) -> usize {
    let available = parallel::processors();
    match (asked, lock) {
        (None, Some(lock)) => lock.threads.min(available),
        _ => threads(asked, n_atoms),
    }
}

impl From<PoolError> for Failure {
    fn from(error: PoolError) -> Self {
        let code = match error {
            PoolError::Number(_) => INPUT,
            PoolError::System(_) => OTHER,
        };
        Self::new("starting threads", error, code)
    }
}

/// Runs `work` on a pool of so many threads.
pub fn on_threads<T: Send>(
    threads: usize,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    parallel::pool(threads)?.install(work)
}

/// As many threads as asked for, or as pay for so many particles.
pub fn threads(asked: Option<u16>, n_atoms: usize) -> usize {
    asked.map_or_else(|| lennard_engine::recommended_threads(n_atoms), usize::from)
}

/// Makes and claims an output folder: the one named, or `runs/<stem>-<n>` with the first free n.
pub fn output_folder(
    named: Option<&Path>,
    existing: Existing,
    stem: &str,
) -> Result<OutputFolder, Failure> {
    let made = match named {
        Some(folder) => lennard_io::create_named_folder(folder, existing),
        None => lennard_io::create_numbered_folder("runs".as_ref(), stem),
    };
    made.map_err(|e| EngineError::Folder(e).into())
}

/// What a study says that a signal ends and that keeps nothing of what it has measured.
const UNFINISHED: &str =
    "stopped before the end: no result was written, and there is nothing to go on from";

/// Claims the output folder of a study that keeps nothing where a signal ends it.
pub fn study_folder(
    named: Option<&Path>,
    force: bool,
    stem: &str,
) -> Result<Arc<OutputFolder>, Failure> {
    let nothing = || StartUp::of_nothing(UNFINISHED);
    let signals = Signals::listen(nothing())?;
    signals.claim(|| output_folder(named, replace_if(force), stem), |_| Some(nothing()))
}

/// What `--force` allows.
pub fn replace_if(force: bool) -> Existing {
    if force { Existing::Replace } else { Existing::Refuse }
}

/// Prints one JSON document.
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text =
        serde_json::to_string_pretty(value).map_err(|e| Failure::new("writing JSON", e, OTHER))?;
    out::json(&text);
    Ok(())
}

/// Prints what a command has found: as one JSON document, which names its schema, or as `show` does for a person, unless `quiet`.
pub fn answer(
    json: bool,
    quiet: bool,
    found: &impl Serialize,
    show: impl FnOnce(),
) -> Result<u8, Failure> {
    match json {
        true => print_json(found)?,
        false if quiet => {}
        false => show(),
    }
    Ok(DONE)
}

/// `lennard version`.
pub fn version(json: bool) -> Result<u8, Failure> {
    #[derive(Serialize)]
    struct Version {
        schema: &'static str,
        version: &'static str,
        cpu: String,
        isa: Vec<&'static str>,
        threads: usize,
    }
    let version = Version {
        schema: lennard_io::schema!("version", 1),
        version: env!("CARGO_PKG_VERSION"),
        cpu: lennard_io::cpu_name(),
        isa: lennard_forcefield::available_isas(),
        threads: parallel::processors(),
    };
    answer(json, false, &version, || {
        println!("lennard {}", version.version);
        println!("processor: {}, {} threads", version.cpu, version.threads);
        println!("instruction sets of the pair kernel: {}", version.isa.join(", "));
    })
}
