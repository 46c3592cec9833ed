//! What can go wrong with a run, sorted by whose turn it is to do something about it.

use std::fmt;
use std::path::{Path, PathBuf};

use lennard_core::parallel::PoolError;
use lennard_core::{BoxError, TooManyRanks};
use lennard_forcefield::ForceFieldError;
use lennard_io::{CheckpointError, FormatError, LARGEST, WriteError, path_in_shell};
use lennard_scene::{SceneError, Source};

use crate::failure::PhysicsFailure;
use crate::names::SCENE;
use crate::room::NoRoom;

/// Why a simulation cannot be made, run, saved or asked.
///
/// Its `Debug` form is the message too, so that a `main` that returns it prints what a reader understands.
#[derive(thiserror::Error)]
pub enum EngineError {
    /// The scene asks for something impossible: exit code 2.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A start configuration cannot be read: exit code 2.
    #[error("cannot read the start configuration: {0}")]
    Configuration(#[from] FormatError),
    /// A trajectory cannot be measured: exit code 2.
    #[error("cannot read the trajectory: {0}")]
    Trajectory(FormatError),
    /// The output folder cannot be made or is not free: exit code 2.
    #[error(transparent)]
    Folder(lennard_io::FolderError),
    /// A file cannot be written: exit code 1.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A run cannot go on from its checkpoint: exit code 2.
    #[error(transparent)]
    Resume(#[from] ResumeError),
    /// Physics stopped the run: exit code 3.
    #[error(transparent)]
    Physics(Box<PhysicsFailure>),
    /// Several ranks cannot run together: exit code 2, and 1 where their machines differ on the way.
    #[error(transparent)]
    Ranks(#[from] RanksError),
    /// The memory is not there: exit code 1.
    #[error(transparent)]
    Memory(#[from] NoRoom),
    /// A saved simulation cannot be read: exit code 2.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Arrays are no start: exit code 2.
    #[error(transparent)]
    Start(#[from] StartError),
    /// A folder holds whole runs: exit code 2.
    #[error(
        "a folder holds a run from its first step, and this simulation has done {0} steps\n  allowed: a new simulation of the same scene"
    )]
    Begun(u64),
    /// The run has no such mean or table: exit code 2.
    #[error("the run has no {kind} `{name}`\n  allowed: {known}{}", hint(.nearest))]
    NoSuchResult {
        /// `average` or `table`.
        kind: &'static str,
        /// The name asked for.
        name: String,
        /// The names that there are.
        known: String,
        /// The nearest of them.
        nearest: Option<String>,
    },
    /// There is no pool of so many threads: exit code 2 for a number that is not allowed, else 1.
    #[error("starting threads: {0}")]
    Threads(#[from] PoolError),
}

fn hint(nearest: &Option<String>) -> String {
    let line = |name| format!("\n  nearest: {name}");
    nearest.as_ref().map_or_else(String::new, line)
}

impl fmt::Debug for EngineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl EngineError {
    /// Whether another process has taken over the output folder.
    #[must_use]
    pub fn is_of_lost_folder(&self) -> bool {
        matches!(self, Self::Folder(lennard_io::FolderError::Lost { .. }))
    }

    /// The exit code of the command line: 2 for input, 3 for physics, 1 for anything else.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Folder(_) if self.is_of_lost_folder() => 1,
            Self::Scene(_)
            | Self::Configuration(_)
            | Self::Trajectory(_)
            | Self::Folder(_)
            | Self::Resume(_)
            | Self::Checkpoint(_)
            | Self::Start(_)
            | Self::Begun(_)
            | Self::NoSuchResult { .. }
            | Self::Threads(PoolError::Number(_)) => 2,
            Self::Physics(_) => 3,
            Self::Write(_) | Self::Memory(_) | Self::Threads(_) => 1,
            Self::Ranks(error) => error.exit_code(),
        }
    }
}

/// Why arrays are no start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StartError {
    /// The arrays differ in length.
    #[error("one velocity for each position is wanted")]
    OneVelocityEach,
    /// A number is not finite, or too large.
    #[error("a position or velocity is not a finite number from -{LARGEST:e} to {LARGEST:e}")]
    OutOfBounds,
    /// The sides make no box.
    #[error(transparent)]
    Box(#[from] BoxError),
}

/// A force field that does not fit, put on the line of the scene that it is about.
#[must_use]
pub fn misfit(source: &Source, error: &ForceFieldError) -> EngineError {
    source.invalid(&error.key(), error.found(), error.allowed()).into()
}

/// Why a run cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// The folder holds no run.
    #[error("{} holds no run: it has no {SCENE} and no checkpoint\n  allowed: the output folder of a run, such as runs/gas-1", .0.display())]
    NoRun(PathBuf),
    /// There is nothing to go on from.
    #[error("{} holds no checkpoint: the run ended before its first one, so there is nothing to go on from\n  {}", folder.display(), again(folder))]
    NoCheckpoint {
        /// The folder.
        folder: PathBuf,
    },
    /// The newest checkpoint is refused.
    #[error("{source}{}", older_command(folder, source))]
    Refused {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: CheckpointError,
    },
    /// There is no second checkpoint.
    #[error("{} holds one checkpoint only: there is no older one to go on from", .0.display())]
    NoOlder(PathBuf),
    /// No run of this program goes on from it.
    #[error("{}: {why}", checkpoint.display())]
    Unfit {
        /// The checkpoint.
        checkpoint: PathBuf,
        /// Why.
        why: Unfit,
    },
}

/// Why no run goes on from a checkpoint that is whole.
#[derive(Debug, thiserror::Error)]
pub enum Unfit {
    /// Another version of the program wrote it.
    #[error("it was written by version {found} of this program; this is version {}, whose steps may have other bits\n  go on with version {found}, or start a new run from the state in it", env!("CARGO_PKG_VERSION"))]
    OtherProgram {
        /// The version that wrote it.
        found: String,
    },
    /// The folder's scene is another one.
    #[error("it belongs to another scene than {}: {difference}\n  put the scene file back as the run wrote it, or start a new run from the changed scene", scene.display())]
    OtherScene {
        /// The scene file.
        scene: PathBuf,
        /// Where they differ.
        difference: String,
    },
    /// Another instruction set would be used.
    #[error(
        "it was made with the instruction set {recorded}; {here}, which gives other bits\n  {advice}"
    )]
    OtherIsa {
        /// The set that was used.
        recorded: String,
        /// What is so on this machine.
        here: String,
        /// What to do.
        advice: String,
    },
    /// It is whole and does not fit this program: a bug, or a file made by hand.
    #[error("it does not fit its own scene: {0}")]
    OwnScene(String),
}

/// The command that starts the run of a folder again, elsewhere: no command replaces the scene that it reads.
#[must_use]
pub fn again(folder: &Path) -> String {
    format!(
        "to start again: lennard run {} --out FOLDER, with another folder",
        path_in_shell(&folder.join(SCENE))
    )
}

fn older_command(folder: &Path, error: &CheckpointError) -> String {
    if error.older.is_some() {
        format!("\n  to go on from that one: lennard resume {} --older", path_in_shell(folder))
    } else {
        format!("\n  no older one is whole; {}", again(folder))
    }
}

/// Why several ranks cannot run a scene together, or not any longer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RanksError {
    /// A rank would have nothing to do.
    #[error(transparent)]
    TooMany(#[from] TooManyRanks),
    /// So few or so many particles are not shared.
    #[error(
        "{particles} particles on several ranks\n  allowed: {fewest} to {most} particles, or one process"
    )]
    Particles {
        /// The number of particles.
        particles: usize,
        /// The least number.
        fewest: usize,
        /// The largest number.
        most: usize,
    },
    /// A rank was started with something else.
    #[error(
        "rank {rank} has another {what} than rank 0: all ranks need the same program, input and kind of processor{advice}"
    )]
    Differs {
        /// The rank.
        rank: usize,
        /// What it has.
        what: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// Another rank failed, which tells why.
    #[error("another rank failed")]
    Elsewhere,
}

impl RanksError {
    /// The exit code of the command line.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::TooMany(_) | Self::Particles { .. } | Self::Differs { .. } => 2,
            Self::Elsewhere => 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_rank_and_what_is_allowed() {
        let differs = RanksError::Differs { rank: 3, what: "instruction set", advice: "" };
        assert!(
            differs
                .to_string()
                .starts_with("rank 3 has another instruction set than rank 0: all ranks need the same program, input and kind of processor")
        );
        assert_eq!(differs.exit_code(), 2);
        let few = RanksError::Particles { particles: 864, fewest: 4000, most: 1_000_000_000 };
        assert_eq!(
            few.to_string(),
            "864 particles on several ranks\n  allowed: 4000 to 1000000000 particles, or one process"
        );
        assert_eq!(few.exit_code(), 2);
        assert_eq!(RanksError::Elsewhere.exit_code(), 1);
    }
}
