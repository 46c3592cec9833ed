//! The output folder of a run, read back.

use std::path::{Path, PathBuf};

use lennard_core::PeriodicBox;
use lennard_io::{AverageRecord, FormatError, RunRecord};
use lennard_observables::{Remark, Table};
use lennard_scene::{Scene, SceneError};

/// The average of the temperature on half steps.
pub(super) const HALF_STEPS: &str = "temperature_half_steps";

/// Why a run cannot be compared or shown.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The folder holds no run.
    #[error("{} holds no run: it has no run.json\n  allowed: the output folder of a run, such as runs/triple-point-1", .0.display())]
    NoRun(PathBuf),
    /// The run has not come to its end.
    #[error("{}: the run did not finish (it has {steps} of {total} steps), and nothing in it is a result{why}\n  {}", folder.display(), lennard_engine::way_on(folder))]
    Unfinished {
        /// The folder.
        folder: PathBuf,
        /// Steps done.
        steps: u64,
        /// Steps of the scene.
        total: u64,
        /// What the record says of it, as text to append.
        why: String,
    },
    /// A file cannot be read.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The scene cannot be read.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The state of the run is not known.
    #[error("{}: the box of the run is not known: {reason}", folder.display())]
    Box {
        /// The folder.
        folder: PathBuf,
        /// Why.
        reason: String,
    },
}

/// A finished run with what its folder says.
#[derive(Debug, Clone)]
pub struct RunFolder {
    /// The folder.
    pub folder: PathBuf,
    /// The scene as resolved.
    pub scene: Scene,
    /// The run record.
    pub record: RunRecord,
    /// Number density in σ⁻³, of molecules where there are some.
    pub density: f64,
    /// The box; of the last state where a barostat changes it.
    pub cell: PeriodicBox,
    /// Shortest side of the box in σ.
    pub shortest_side: f64,
}

/// Whether a run has fewer bodies than a dozen: means over them say nothing of a fluid.
pub(super) fn is_of_few_bodies(molecules: u64) -> bool {
    const FEW: u64 = 12;
    molecules < FEW
}

/// The record and the scene in the folder of a run.
fn described(folder: &Path) -> Result<(RunRecord, Scene), ReadError> {
    let path = folder.join("run.json");
    if !path.exists() {
        return Err(ReadError::NoRun(folder.to_owned()));
    }
    Ok((lennard_io::read_run_record(&path)?, Scene::load(&folder.join("scene.toml"), &[])?))
}

impl RunFolder {
    /// Reads the folder of a finished run.
    ///
    /// # Errors
    /// [`ReadError`] where there is no run, it did not finish, or a file of it cannot be read.
    pub fn open(folder: &Path) -> Result<Self, ReadError> {
        let run = Self::open_any(folder)?;
        if run.record.finished {
            return Ok(run);
        }
        let why = run.record.remarks.first().map(|r| format!(": {r}")).unwrap_or_default();
        Err(ReadError::Unfinished {
            folder: folder.to_owned(),
            steps: run.record.steps,
            total: run.scene.total_steps(),
            why,
        })
    }

    /// Reads the folder of a finished run, or of each finished point of a sweep.
    ///
    /// # Errors
    /// As [`RunFolder::open`].
    pub fn open_each(folder: &Path) -> Result<Vec<Self>, ReadError> {
        let Ok(record) = std::fs::read(folder.join("sweep.json")) else {
            return Ok(vec![Self::open(folder)?]);
        };
        let record: serde_json::Value = serde_json::from_slice(&record).unwrap_or_default();
        let points = record["points"].as_array().into_iter().flatten();
        // A point that failed has no means.
        let names = points.filter(|p| !p["compared"].is_null()).filter_map(|p| p["name"].as_str());
        names.map(|name| Self::open(&folder.join(name))).collect()
    }

    /// Reads the folder of a run, finished or not.
    ///
    /// # Errors
    /// As [`RunFolder::open`], but for runs that did not finish.
    pub(crate) fn open_any(folder: &Path) -> Result<Self, ReadError> {
        let (record, scene) = described(folder)?;
        let box_changes = scene.stages.iter().any(|s| s.barostat.is_some());
        let cell = match scene.placement()? {
            Some(placement) if !box_changes => placement.cell,
            _ => {
                let last = folder.join("final.xyz");
                lennard_io::read_configuration(&last)
                    .map_err(|e| ReadError::Box {
                        folder: folder.to_owned(),
                        reason: e.to_string(),
                    })?
                    .cell
            }
        };
        Ok(Self::with(folder, record, scene, cell))
    }

    /// Reads the folder of a run under way, whose last state is in no file; `cell` is its box.
    pub(crate) fn under_way(folder: &Path, cell: PeriodicBox) -> Result<Self, ReadError> {
        let (record, scene) = described(folder)?;
        Ok(Self::with(folder, record, scene, cell))
    }

    fn with(folder: &Path, record: RunRecord, scene: Scene, cell: PeriodicBox) -> Self {
        let mut run = Self {
            folder: folder.to_owned(),
            density: f64::NAN,
            cell,
            shortest_side: cell.lengths().min_element(),
            scene,
            record,
        };
        let at_rest = run.molecules() as f64 / cell.volume();
        run.density = run.average("density").map_or(at_rest, |d| d.estimate.mean);
        run
    }

    /// Whether vapor and liquid stand side by side: the start has surfaces, or two phases were found by the run.
    pub(crate) fn has_two_phases(&self) -> bool {
        self.scene.surfaces().is_some() || self.average("liquid_density").is_some()
    }

    /// Why the fluid is known to have separated by itself, though its scene names no surface.
    pub(crate) fn has_separated(&self) -> Option<&str> {
        self.record.typed_remarks.iter().find_map(|remark| match remark {
            Remark::Separated { why } => Some(why.as_str()),
            _ => None,
        })
    }

    /// Number of molecules; of particles where there are none.
    #[must_use]
    pub fn molecules(&self) -> u64 {
        self.record.atoms / self.scene.molecules().sites() as u64
    }

    /// The mean volume of the box, σ³.
    pub(crate) fn volume(&self) -> f64 {
        self.molecules() as f64 / self.density
    }

    /// A mean of the run record.
    pub(crate) fn average(&self, name: &str) -> Option<&AverageRecord> {
        self.record.averages.get(name)
    }

    /// The temperature that belongs to the positions: of half steps where the method has them, else of whole steps.
    #[must_use]
    pub fn temperature(&self) -> Option<&AverageRecord> {
        self.average(self.temperature_name())
    }

    /// Its name among the averages.
    pub(crate) fn temperature_name(&self) -> &'static str {
        if self.average(HALF_STEPS).is_some() { HALF_STEPS } else { "temperature" }
    }

    /// The temperature that the bath gives the positions, ε/k_B. Half steps and whole steps differ by a ratio that hardly
    /// fluctuates. `None` without a bath that holds a temperature.
    #[must_use]
    pub(super) fn bath_temperature(&self) -> Option<f64> {
        let bath = lennard_engine::held_temperature(&self.scene)?;
        let held = if bath.half_steps { HALF_STEPS } else { "temperature" };
        let ratio = self.temperature()?.estimate.mean / self.average(held)?.estimate.mean;
        Some(bath.temperature * ratio)
    }

    /// A table of the folder; `None` where the run has none of that name.
    #[must_use]
    pub fn table(&self, name: &str) -> Option<Table> {
        lennard_io::read_table_csv(&self.table_file(name)).ok()
    }

    /// The file of a table, whether it is there or not.
    pub(super) fn table_file(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.csv"))
    }
}
