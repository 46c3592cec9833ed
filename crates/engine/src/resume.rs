//! Going on from a checkpoint.

use std::io;
use std::path::{Path, PathBuf};

use lennard_core::{DVec3, Own, Team};
use lennard_io::{
    Checkpoint, CheckpointFolder, CheckpointProblem, TrajectoryFormat, path_in_shell,
};
use lennard_scene::Scene;

use crate::build;
use crate::checkpointing::{self, Past};
use crate::error::{RanksError, ResumeError, Unfit, again};
use crate::files::Marks;
use crate::names::{SCENE, THERMO};
use crate::own::OwnParts;
use crate::start::Start;
use crate::{EngineError, Simulation, together};

/// What may be different from the run as it was.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ResumeOptions {
    /// Steps of the last stage beyond the number in the scene.
    pub more_steps: u64,
    /// Another instruction set, by its name in scenes; the bits may then differ.
    pub isa: Option<String>,
    /// Go on from the checkpoint before the newest.
    pub older: bool,
    /// Other values of keys of `[output]`, as `("output.precision", "100")`.
    pub output: Vec<(String, String)>,
}

/// A run brought back from its checkpoint.
pub struct Resumed {
    /// The simulation, as it was to the bit.
    pub simulation: Simulation,
    /// How far the growing files were.
    pub marks: Marks,
    /// What it brings along.
    pub past: Past,
    /// The checkpoint that it comes from.
    pub checkpoint: PathBuf,
}

/// What to do with the folder of a run that did not finish: to go on where it has a checkpoint, else to start again.
#[must_use]
pub fn way_on(folder: &Path) -> String {
    let checkpoints = CheckpointFolder::new(folder).list();
    if checkpoints.is_ok_and(|all| !all.is_empty()) {
        format!("to go on: lennard resume {}", path_in_shell(folder))
    } else {
        format!("it has no checkpoint to go on from; {}", again(folder))
    }
}

/// Brings a run back from the newest checkpoint of its output folder.
///
/// Nothing in the folder is changed; [`crate::go_on`] does that.
///
/// # Errors
/// [`EngineError::Resume`] where there is no checkpoint or it is refused, [`EngineError::Scene`] where
/// `options` do not fit its scene.
pub fn resume(folder: &Path, options: &ResumeOptions) -> Result<Resumed, EngineError> {
    resume_on(folder, options, None)
}

/// As [`resume`], on one of several ranks where there is a team. Every rank has to call it, and keeps some of the particles, whatever
/// number of ranks wrote the checkpoint.
///
/// # Errors
/// As [`resume`] and [`crate::prepare_on`].
pub fn resume_on(
    folder: &Path,
    options: &ResumeOptions,
    team: Option<&Team>,
) -> Result<Resumed, EngineError> {
    let loaded = together::alike(team, loaded(folder, options, team))?;
    let Loaded { path, checkpoint, scene, marks } = loaded;
    let mut overrides = Vec::new();
    if options.more_steps > 0 {
        let last = scene.stages.len() - 1;
        if scene.stages[last].is_ramp() {
            let key = format!("stage.{last}.steps");
            let found = format!("{} more steps of a ramp", options.more_steps);
            let allowed =
                "no more steps: a longer ramp is another one; start a new run from final.xyz";
            return Err(scene.invalid(&key, found, allowed).into());
        }
        let steps = scene.stages[last].steps.saturating_add(options.more_steps);
        overrides.push((format!("stage.{last}.steps"), steps.to_string()));
    }
    let saved = Saved { checkpoint: &checkpoint, path: &path, own: &OwnParts::none(), team };
    let (mut simulation, remark) = saved.with_isa(overrides, options.isa.as_deref())?;
    let past = saved.reinstated(&mut simulation).map_err(EngineError::from);
    let mut past = together::alike(team, past)?;
    past.remarks.extend(remark);
    Ok(Resumed { simulation, marks, past, checkpoint: path })
}

/// What was read of a folder, before anything is made of it.
struct Loaded {
    path: PathBuf,
    checkpoint: Checkpoint,
    scene: Scene,
    marks: Marks,
}

/// Reads the newest checkpoint of a folder, of which a rank takes the particles that it keeps.
fn loaded(
    folder: &Path,
    options: &ResumeOptions,
    team: Option<&Team>,
) -> Result<Loaded, EngineError> {
    let (path, mut checkpoint) = load(folder, options.older, team)?;
    let saved = Saved { checkpoint: &checkpoint, path: &path, own: &OwnParts::none(), team };
    saved.is_of_this_program()?;
    let name = path.display().to_string();
    let scene = Scene::parse(&checkpoint.scene, &name, &[]).map_err(|e| saved.misfit(e))?;
    saved.is_of_scene(&folder.join(SCENE), &scene)?;
    let mark = |file: &str| checkpoint.metadata.files.get(file).copied();
    let thermo = mark(THERMO)
        .ok_or_else(|| saved.misfit(format!("it does not say how long {THERMO} was")))?;
    let before = mark(scene.output.format.spec().file);
    if scene.output.trajectory_every.is_some() != before.is_some() {
        let file = scene.output.format.spec().file;
        let reason = format!("scene and checkpoint disagree whether there is a {file}");
        return Err(saved.misfit(reason).into());
    }
    let scene = with_output(scene, &options.output)?;
    let file = scene.output.format.spec().file;
    let trajectory = scene.output.trajectory_every.map(|_| mark(file));
    if trajectory == Some(None) && folder.join(file).exists() {
        let found = format!("an earlier {file} in the folder, which the checkpoint does not know");
        let allowed = "another format, or a folder from which this file was moved away";
        return Err(scene.invalid("output.format", found, allowed).into());
    }
    let marks = Marks { thermo, trajectory: trajectory.map(Option::unwrap_or_default) };
    checkpoint.scene = scene.resolved_toml();
    Ok(Loaded { path, checkpoint, scene, marks })
}

/// Brings a simulation back from a checkpoint alone, whatever folder it may belong to, in a program that brings the parts that
/// the simulation had; `path` is its name in messages.
///
/// # Errors
/// [`EngineError::Resume`] where it is refused, and where the simulation had other parts.
pub fn restored(
    checkpoint: &Checkpoint,
    path: &Path,
    own: &OwnParts,
) -> Result<Simulation, EngineError> {
    let saved = Saved { checkpoint, path, own, team: None };
    saved.is_of_this_program()?;
    let (mut simulation, _) = saved.with_isa(Vec::new(), None)?;
    simulation.remarks = saved.reinstated(&mut simulation)?.remarks;
    Ok(simulation)
}

fn load(
    folder: &Path,
    older: bool,
    team: Option<&Team>,
) -> Result<(PathBuf, Checkpoint), EngineError> {
    let checkpoints = CheckpointFolder::new(folder);
    let owned = || folder.to_owned();
    if older {
        let all = checkpoints.list().unwrap_or_default();
        let [_, (_, path), ..] = all.as_slice() else {
            return Err(ResumeError::NoOlder(owned()).into());
        };
        let checkpoint = lennard_io::read_checkpoint_on(path, team)
            .map_err(|source| ResumeError::Refused { folder: owned(), source })?;
        return Ok((path.clone(), checkpoint));
    }
    checkpoints.load_newest(team).map_err(|source| {
        match &source.problem {
            CheckpointProblem::None if folder.join(SCENE).exists() => {
                ResumeError::NoCheckpoint { folder: owned() }
            }
            CheckpointProblem::None => ResumeError::NoRun(owned()),
            CheckpointProblem::Io(e) if !folder.is_dir() && e.kind() == io::ErrorKind::NotFound => {
                ResumeError::NoRun(owned())
            }
            _ => ResumeError::Refused { folder: owned(), source },
        }
        .into()
    })
}

/// A scene with other values of keys of `[output]`.
///
/// # Errors
/// [`EngineError::Scene`] where another key is named, or a value does not fit.
fn with_output(mut scene: Scene, changes: &[(String, String)]) -> Result<Scene, EngineError> {
    if changes.is_empty() {
        return Ok(scene);
    }
    let is_of_output = |key: &str| key.starts_with("output.") && key != "output.thermo_every";
    if let Some((key, value)) = changes.iter().find(|(key, _)| !is_of_output(key)) {
        let allowed =
            "keys of [output] other than thermo_every: the rest of the scene stays as it is";
        return Err(scene.invalid(key, value, allowed).into());
    }
    let written = changes.iter().rfind(|(key, _)| key == "output.format");
    let named = written.and_then(|(_, name)| {
        let name = name.trim_matches('"');
        TrajectoryFormat::ALL.iter().find(|f| f.name() == name)
    });
    // What has no place in the other format must not be asked for.
    let format = named.copied().unwrap_or(scene.output.format);
    scene.output = scene.output.in_format(format);
    let name = scene.source.file().to_owned();
    Ok(Scene::parse(&scene.resolved_toml(), &name, changes)?)
}

/// A checkpoint with its name in messages, and with the parts of the program that goes on from it.
#[derive(Clone, Copy)]
struct Saved<'a> {
    checkpoint: &'a Checkpoint,
    path: &'a Path,
    own: &'a OwnParts,
    team: Option<&'a Team>,
}

impl Saved<'_> {
    fn refuse(&self, why: Unfit) -> ResumeError {
        ResumeError::Unfit { checkpoint: self.path.to_owned(), why }
    }

    fn misfit(&self, reason: impl ToString) -> ResumeError {
        self.refuse(Unfit::OwnScene(reason.to_string()))
    }

    /// Refuses a checkpoint of another version of the program.
    fn is_of_this_program(&self) -> Result<(), ResumeError> {
        let found = &self.checkpoint.metadata.program_version;
        match found == env!("CARGO_PKG_VERSION") {
            true => Ok(()),
            false => Err(self.refuse(Unfit::OtherProgram { found: found.clone() })),
        }
    }

    /// Refuses a checkpoint that was put beside the scene of another run. What a resumed run may have changed may differ: the number
    /// of steps of the last stage, the instruction set, and what is written.
    fn is_of_scene(&self, file: &Path, of_checkpoint: &Scene) -> Result<(), ResumeError> {
        let other = |difference: String| {
            self.refuse(Unfit::OtherScene { scene: file.to_owned(), difference })
        };
        let text = match std::fs::read_to_string(file) {
            Ok(text) => text,
            // The checkpoint holds the whole scene; the file is written anew.
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
            Err(e) => return Err(other(format!("the file cannot be read: {e}"))),
        };
        let mut there = Scene::parse(&text, &file.display().to_string(), &[])
            .map_err(|e| other(e.to_string()))?;
        there.kernel.isa = of_checkpoint.kernel.isa;
        there.output = of_checkpoint.output.clone();
        if let (Some(a), Some(b)) = (there.stages.last_mut(), of_checkpoint.stages.last()) {
            a.steps = b.steps;
        }
        if there == *of_checkpoint {
            return Ok(());
        }
        let (a, b) = (there.resolved_toml(), of_checkpoint.resolved_toml());
        let difference = a.lines().zip(b.lines()).find(|(a, b)| a != b).map_or_else(
            || "one has more tables".to_owned(),
            |(a, b)| format!("`{a}` in the scene file, `{b}` in the checkpoint"),
        );
        Err(other(difference))
    }

    /// Puts the arrays of the checkpoint into a simulation that was built for it.
    fn reinstated(&self, simulation: &mut Simulation) -> Result<Past, ResumeError> {
        let Self { checkpoint, .. } = self;
        let fits = checkpointing::check_particles(&checkpoint.archive, simulation.state.len());
        let others = simulation.team().is_some_and(|team| team.any(fits.is_err()));
        fits.map_err(|e| self.misfit(e))?;
        if others {
            return Err(self.misfit(RanksError::Elsewhere));
        }
        let past = checkpointing::reinstate(simulation, checkpoint).map_err(|e| self.misfit(e))?;
        match simulation.state.step == checkpoint.metadata.step {
            true => Ok(past),
            false => Err(self.misfit("its state belongs to another step")),
        }
    }

    /// Builds the simulation for the instruction set that the run used, or for another one on request. A
    /// remark then says that the bits may differ.
    fn with_isa(
        &self,
        overrides: Vec<(String, String)>,
        wanted: Option<&str>,
    ) -> Result<(Simulation, Option<String>), EngineError> {
        let recorded = &self.checkpoint.metadata.isa;
        let as_it_was = self.build(&overrides);
        let is_settled = match &as_it_was {
            Ok(simulation) => simulation.isa == *recorded,
            Err(error) => wanted.is_none() && !is_about_isa(error),
        };
        if is_settled && wanted.is_none_or(|wanted| wanted == recorded) {
            return as_it_was.map(|simulation| (simulation, None));
        }
        let Some(wanted) = wanted else {
            let available = lennard_forcefield::available_isas();
            let here = match as_it_was {
                Ok(s) => format!("this machine would go on with {}", s.isa),
                Err(_) => "this processor does not have it".to_owned(),
            };
            let advice = if available.contains(&recorded.as_str()) {
                format!("to go on to the bit: --isa {recorded}")
            } else {
                let other = available.first().copied().unwrap_or("portable");
                format!("to go on with bits that may differ: --isa {other}")
            };
            let recorded = recorded.clone();
            return Err(self.refuse(Unfit::OtherIsa { recorded, here, advice }).into());
        };
        let isa = [("kernel.isa".to_owned(), wanted.to_owned())];
        let overrides: Vec<_> = overrides.into_iter().chain(isa).collect();
        let simulation = self.build(&overrides)?;
        let step = self.checkpoint.metadata.step;
        let remark = (simulation.isa != *recorded).then(|| {
            format!(
                "from step {step} on with the instruction set {} in place of {recorded}: bits may differ from a run on one",
                simulation.isa
            )
        });
        Ok((simulation, remark))
    }

    /// A simulation for the scene and the start box of a checkpoint, its particles not yet in place.
    ///
    /// Neither a start configuration nor a relaxation is needed: positions come from the checkpoint.
    fn build(&self, overrides: &[(String, String)]) -> Result<Simulation, EngineError> {
        let Self { checkpoint, path, own, team } = *self;
        let name = path.display().to_string();
        let scene = Scene::parse_to_grow(&checkpoint.scene, &name, overrides)?;
        if let Some(team) = team {
            together::can_share(&scene, team)?;
        }
        let cell =
            checkpointing::saved_start_cell(&checkpoint.archive).map_err(|e| self.misfit(e))?;
        let state = checkpoint.archive.reader().section("state");
        let here = state.vec3("positions").map_err(|e| self.misfit(e))?.len();
        let n = Own::whole_of(team, here);
        if n == 0 {
            return Err(self.misfit("it has no particles").into());
        }
        let species = checkpointing::saved_species(&checkpoint.archive, &scene, n)
            .map_err(|e| self.misfit(e))?;
        let nowhere = vec![DVec3::ZERO; here];
        let start = Start::at(cell, nowhere.clone(), nowhere, species);
        build::prepare_own_from(scene, start, own.clone(), team)
    }
}

fn is_about_isa(error: &EngineError) -> bool {
    matches!(error, EngineError::Scene(e) if e.key_path() == Some("kernel.isa"))
}
