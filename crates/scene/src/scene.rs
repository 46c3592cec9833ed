//! What a scene says, with every default filled in.

use std::fmt::Display;

use lennard_core::random::Streams;
use lennard_core::{DVec3, Integrator};
use lennard_forcefield::{
    ForceFieldOptions, KernelOptions, NeighborOptions, PotentialOptions, TruncationOptions,
};
use lennard_io::in_shell;
use lennard_literature::units::Units;

use crate::{
    Accuracy, Checkpoint, ContactTable, IntegratorTable, MixtureTables, Molecule, Name,
    ObservableTable, Output, ProgramParts, SceneError, Source, Stage, System, WallTable,
};

mod confined;
mod insertion;
pub(crate) mod model;
mod species;
mod start;

/// A scene: everything that a run depends on but the machine. Reduced units throughout.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Its name; the file's stem unless the file gives another.
    pub name: Name,
    /// The units that its quantities are written and shown in besides reduced ones; `None` for reduced units alone.
    pub units: Option<Units>,
    /// Where the particles start.
    pub system: System,
    /// The species of the particles and their pairs; `None` where the scene names none: σ = ε = m = 1 for all.
    pub mixture: Option<MixtureTables>,
    /// What molecules the particles are bonded to; `None` for atoms.
    pub molecule: Option<Molecule>,
    /// The errors that are accepted, where the scene asks for an accuracy.
    pub accuracy: Option<Accuracy>,
    /// The settings that the accuracy leaves to be chosen and that no lock file has brought. While there are
    /// any, their fields hold defaults, and the scene must not be run.
    pub free: Vec<&'static str>,
    /// The pair potential.
    pub potential: PotentialOptions,
    /// How the potential ends.
    pub truncation: TruncationOptions,
    /// Whether what lies beyond the cutoff acts as a force across flat surfaces, in place of a number added to means.
    pub planar_tail: bool,
    /// How neighbors are found.
    pub neighbor: NeighborOptions,
    /// Which pair kernel computes them.
    pub kernel: KernelOptions,
    /// The method that advances time.
    pub integrator: IntegratorTable,
    /// Walls, one pair per axis at most; empty for a periodic fluid.
    pub walls: Vec<WallTable>,
    /// Contacts between bodies; `None` where particles are points.
    pub contact: Option<ContactTable>,
    /// Acceleration by a constant field, σ/τ²; zero without one.
    pub acceleration: DVec3,
    /// What happens one after the other; at least one.
    pub stages: Vec<Stage>,
    /// What is measured besides thermodynamics.
    pub observables: Vec<ObservableTable>,
    /// What is written.
    pub output: Output,
    /// When checkpoints are written.
    pub checkpoint: Checkpoint,
    /// What the program of the run added; empty for a scene that runs by itself.
    pub program: ProgramParts,
    /// Where each key was written.
    pub source: Source,
}

impl Scene {
    /// The options of the force field together, with what the integrator needs: RESPA needs forces split by
    /// distance.
    #[must_use]
    pub fn force_field(&self) -> ForceFieldOptions {
        ForceFieldOptions {
            split: self.integrator.split,
            canonical: false,
            potential: self.potential,
            truncation: self.truncation,
            neighbor: self.neighbor,
            kernel: self.kernel,
            exclusions: self.molecules().exclusions(),
        }
    }

    /// The method of a stage with its bath: a bath that stands inside the step takes the place of the integrator. It draws from
    /// a stream of its own, and serves to ask what the method is.
    #[must_use]
    pub fn method_of(&self, stage: &Stage) -> Integrator {
        let method = lennard_integrators::build(&self.integrator.method);
        match &stage.thermostat {
            Some(bath) => {
                let noise = Streams::new(0).noise("check");
                bath.couple(method, stage.temperature_ramp(0), noise)
            }
            None => method,
        }
    }

    /// The mass of the lightest species; 1 where particles are alike.
    pub(crate) fn lightest_mass(&self) -> f64 {
        let masses = self.mixture.iter().flat_map(|m| &m.species).map(|s| s.mass);
        masses.reduce(f64::min).unwrap_or(1.0)
    }

    /// The step of a stage in τ: its own, or the step of the integrator table.
    #[must_use]
    pub fn stage_dt(&self, stage: &Stage) -> f64 {
        stage.dt.unwrap_or(self.integrator.dt)
    }

    /// The stages that are measured. A scene that is run has one at least.
    pub fn measured_stages(&self) -> impl DoubleEndedIterator<Item = &Stage> + Clone {
        self.stages.iter().filter(|stage| stage.measure)
    }

    /// The steps of all measured stages together.
    #[must_use]
    pub fn measured_steps(&self) -> u64 {
        self.measured_stages().map(|stage| stage.steps).sum()
    }

    /// The stage that is measured, the last of them; the last stage where none is, and `None` without a stage.
    #[must_use]
    pub fn measured_stage(&self) -> Option<&Stage> {
        self.measured_stages().next_back().or(self.stages.last())
    }

    /// The time of all measured stages together, τ.
    #[must_use]
    pub fn measured_time(&self) -> f64 {
        self.measured_stages().map(|stage| stage.steps as f64 * self.stage_dt(stage)).sum()
    }

    /// The steps of all stages together.
    #[must_use]
    pub fn total_steps(&self) -> u64 {
        self.steps_before(self.stages.len())
    }

    /// The steps of all stages before one.
    #[must_use]
    pub fn steps_before(&self, index: usize) -> u64 {
        self.stages[..index].iter().map(|stage| stage.steps).sum()
    }

    /// Whether every setting is there, so that the scene can be run.
    ///
    /// # Errors
    /// [`SceneError`] where an accuracy leaves settings to be chosen and no lock file has brought them.
    pub fn settled(&self) -> Result<(), SceneError> {
        if self.free.is_empty() {
            return Ok(());
        }
        Err(self
            .refuse("accuracy", "needs settings that have not been chosen yet")
            .found(format!("no value for {}", self.free.join(", ")))
            .allowed(format!(
                "a lock file with them, which `lennard tune {}` writes, or values written by hand",
                in_shell(self.source.file())
            )))
    }

    /// Whether U and P of the potential without any cutoff are wanted. This is so unless the scene fixes
    /// both kind and cutoff radius of the truncation, or the potential ends by itself.
    #[must_use]
    pub fn wants_full_potential(&self) -> bool {
        let wrote = |key| self.source.wrote(key);
        let fixed = wrote("truncation.kind") && wrote("truncation.r_cut");
        !(fixed || self.potential.own_end().is_some())
    }

    /// The scene with every free setting at its present value, as a study that tries settings needs it.
    #[must_use]
    pub fn without_accuracy(&self) -> Self {
        Self { accuracy: None, free: Vec::new(), ..self.clone() }
    }

    /// The error that a key of the scene has this trouble, with file and line.
    #[must_use]
    pub fn refuse(&self, key: &str, message: impl Into<String>) -> SceneError {
        self.source.refuse(key, message)
    }

    /// The error for a value of the scene that turned out not to fit, with file and line.
    #[must_use]
    pub fn invalid(&self, key: &str, found: impl Display, allowed: impl Display) -> SceneError {
        self.source.invalid(key, found, allowed)
    }

    /// The error that an accuracy cannot be met, on the line of the `key` that is to blame.
    #[must_use]
    pub fn contradiction(
        &self,
        key: &str,
        message: &str,
        found: &str,
        reachable: &str,
    ) -> SceneError {
        self.refuse(key, message).found(found).allowed(reachable)
    }

    /// The same scene with parts of a program.
    ///
    /// # Errors
    /// [`SceneError`] where another table does not go with them, such as a tail correction with a field.
    pub fn with_program(mut self, program: ProgramParts) -> Result<Self, SceneError> {
        self.program = program;
        self.check()?;
        Ok(self)
    }

    /// The name of the method that advances time: of the program where it brings one, else of `[integrator]`.
    #[must_use]
    pub fn method_name(&self) -> &str {
        let own = self.program.integrator.as_deref();
        own.unwrap_or_else(|| self.integrator.method.name())
    }
}
