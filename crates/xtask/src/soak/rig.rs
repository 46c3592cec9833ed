//! Starting, killing and resuming runs.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::compare;

/// A small liquid that is melted and measured, with everything that must survive switched on.
const SCENE: &str = include_str!("scene.toml");

/// Exit codes of the program.
const OTHER: i32 = 1;
const INPUT: i32 = 2;
const STOPPED: i32 = 4;

/// What happened to runs.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tally {
    /// Processes killed.
    pub kills: u32,
    /// Processes stopped by SIGTERM, which wrote a checkpoint first.
    pub stops: u32,
    /// Runs killed before their first checkpoint, and begun anew.
    pub begun_anew: u32,
    /// Writes that failed.
    pub faults: u32,
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, o: Self) {
        self.kills += o.kills;
        self.stops += o.stops;
        self.begun_anew += o.begun_anew;
        self.faults += o.faults;
    }
}

/// A run that was left alone.
pub struct Undisturbed {
    folder: PathBuf,
    /// How long it took.
    pub wall: Duration,
}

/// A temporary folder with the scene, and the program.
pub struct Rig {
    binary: PathBuf,
    root: PathBuf,
    random: Xoshiro256PlusPlus,
}

impl Drop for Rig {
    fn drop(&mut self) {
        // A folder that stays costs room and nothing else; after a failure it is wanted.
        if !std::thread::panicking() {
            let _ = fs::remove_dir_all(&self.root);
        }
    }
}

impl Rig {
    /// Makes the folder.
    pub fn new(binary: PathBuf, seed: u64) -> Result<Self, Box<dyn Error>> {
        if !binary.exists() {
            return Err(format!(
                "{} is not there: cargo build --package lennard, with --release or without",
                binary.display()
            )
            .into());
        }
        let root = std::env::temp_dir().join(format!("lennard-soak-{}", std::process::id()));
        fs::create_dir_all(&root)?;
        fs::write(root.join("soak.toml"), SCENE)?;
        Ok(Self { binary, root, random: Xoshiro256PlusPlus::seed_from_u64(seed) })
    }

    fn disturbed(&self) -> PathBuf {
        self.root.join("disturbed")
    }

    /// Arguments that start a run from the beginning, whatever is in its folder.
    fn fresh(&self, folder: &Path, overrides: &[&str], steps: u64) -> Vec<String> {
        let text = |s: &str| s.to_owned();
        let mut all = vec![text("run"), self.root.join("soak.toml").display().to_string()];
        all.extend([text("--out"), folder.display().to_string(), text("--force")]);
        for set in
            overrides.iter().copied().chain([format!("stage.production.steps={steps}").as_str()])
        {
            all.extend([text("--set"), text(set)]);
        }
        all
    }

    fn command(&mut self, arguments: &[String]) -> Command {
        let mut command = Command::new(&self.binary);
        let threads = self.random.random_range(1..=4_u32).to_string();
        command.args(arguments).args(["--quiet", "--threads", &threads]);
        command.stdin(Stdio::null()).stdout(Stdio::null());
        command
    }

    fn resume(&self) -> Vec<String> {
        vec!["resume".to_owned(), self.disturbed().display().to_string()]
    }

    /// Runs without disturbance.
    pub fn undisturbed(
        &mut self,
        overrides: &[&str],
        steps: u64,
    ) -> Result<Undisturbed, Box<dyn Error>> {
        let folder = self.root.join("whole");
        let arguments = self.fresh(&folder, overrides, steps);
        let start = Instant::now();
        success(&self.command(&arguments).output()?)?;
        Ok(Undisturbed { folder, wall: start.elapsed() })
    }

    /// Starts a run, kills it after random times up to `longest`, goes on with it, and lets it end.
    pub fn chain(
        &mut self,
        overrides: &[&str],
        steps: u64,
        kills: u32,
        longest: Duration,
    ) -> Result<Tally, Box<dyn Error>> {
        let _ = fs::remove_dir_all(self.disturbed());
        let beginning = self.fresh(&self.disturbed(), overrides, steps);
        let mut arguments = beginning.clone();
        let mut tally = Tally::default();
        loop {
            let mut process = self.command(&arguments).stderr(Stdio::piped()).spawn()?;
            let kill = tally.kills < kills;
            if kill {
                std::thread::sleep(longest.mul_f64(self.random.random_range(0.0..1.0)));
                // One in six is asked politely: it must leave with a checkpoint and say so.
                if self.random.random_range(0..6) == 0 {
                    terminate(process.id())?;
                } else {
                    process.kill()?;
                }
            }
            let output = process.wait_with_output()?;
            match output.status.code() {
                Some(0) => return Ok(tally),
                None if killed(&output) => tally.kills += 1,
                // Asked to stop before it could listen, which is as good as a kill but was none.
                None => {}
                Some(STOPPED) if kill => tally.stops += 1,
                // Asked to stop before its first step: it left nothing behind.
                Some(OTHER) if kill && before_the_first_step(&output) => {
                    tally.begun_anew += 1;
                    arguments = beginning.clone();
                    continue;
                }
                Some(INPUT) if no_checkpoint(&output) => {
                    tally.begun_anew += 1;
                    arguments = beginning.clone();
                    continue;
                }
                _ => success(&output)?,
            }
            arguments = self.resume();
        }
    }

    /// Runs with a limit on the size of files, which fails writes as a full disk does, and goes on without it.
    pub fn starve(&mut self, overrides: &[&str], steps: u64) -> Result<u32, Box<dyn Error>> {
        let undisturbed = self.undisturbed(overrides, steps)?;
        let _ = fs::remove_dir_all(self.disturbed());
        let sizes: Vec<u64> = fs::read_dir(&undisturbed.folder)?
            .filter_map(|entry| Some(entry.ok()?.metadata().ok()?.len()))
            .collect();
        let largest = sizes.iter().copied().max().unwrap_or(0);
        let mut arguments = self.fresh(&self.disturbed(), overrides, steps);
        let mut faults = 0;
        for _ in 0..3 {
            // The shell counts in blocks of 512 bytes.
            let blocks = self.random.random_range(largest / 8..largest) / 512 + 1;
            let inner = self.command(&arguments);
            let mut command = Command::new("sh");
            let script = format!("ulimit -f {blocks}; exec \"$0\" \"$@\"");
            command.args(["-c", &script]).arg(inner.get_program()).args(inner.get_args());
            let output = command.stdin(Stdio::null()).output()?;
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            match output.status.code() {
                Some(0) => break,
                Some(OTHER) if message.contains("cannot write") => faults += 1,
                Some(INPUT) if no_checkpoint(&output) => {
                    arguments = self.fresh(&self.disturbed(), overrides, steps);
                    continue;
                }
                _ => success(&output)?,
            }
            arguments = self.resume();
        }
        let mut output = self.command(&arguments).output()?;
        if output.status.code() == Some(INPUT) && no_checkpoint(&output) {
            let beginning = self.fresh(&self.disturbed(), overrides, steps);
            output = self.command(&beginning).output()?;
        }
        success(&output)?;
        self.compare(&undisturbed)?;
        Ok(faults)
    }

    /// Compares the disturbed run with one that was left alone.
    pub fn compare(&self, undisturbed: &Undisturbed) -> Result<(), Box<dyn Error>> {
        compare::folders(&undisturbed.folder, &self.disturbed())
    }

    /// A long run of 108 particles at constant energy; its record.
    pub fn conservation(&mut self, steps: u64) -> Result<serde_json::Value, Box<dyn Error>> {
        let folder = self.root.join("long");
        // A box of 108 liquid particles has a side of 5.04 σ: the cutoff must be below half of it.
        let overrides = [
            "system.n_atoms=108",
            "neighbor.mode=verlet",
            "truncation.r_cut=2.2",
            "integrator.dt=0.004",
            "observable=[]",
            "output.trajectory_every=0",
            "output.thermo_every=1000",
            "checkpoint.every_steps=1000000",
            "stage.melt.steps=10000",
        ];
        let arguments = self.fresh(&folder, &overrides, steps);
        success(&self.command(&arguments).output()?)?;
        Ok(serde_json::from_slice(&fs::read(folder.join("run.json"))?)?)
    }
}

#[cfg(unix)]
fn killed(output: &Output) -> bool {
    use std::os::unix::process::ExitStatusExt;
    const SIGKILL: i32 = 9;
    output.status.signal() == Some(SIGKILL)
}

#[cfg(not(unix))]
fn killed(_: &Output) -> bool {
    true
}

fn success(output: &Output) -> Result<(), Box<dyn Error>> {
    if output.status.success() {
        return Ok(());
    }
    let message = String::from_utf8_lossy(&output.stderr);
    Err(format!("it ended with {}:\n{message}", output.status).into())
}

/// Whether a run was asked to stop while it only started.
fn before_the_first_step(output: &Output) -> bool {
    String::from_utf8_lossy(&output.stderr).contains("stopped before the first step")
}

/// Whether a run was killed so early that there is nothing to go on from.
fn no_checkpoint(output: &Output) -> bool {
    let message = String::from_utf8_lossy(&output.stderr);
    message.contains("holds no checkpoint") || message.contains("holds no run")
}

fn terminate(process: u32) -> Result<(), Box<dyn Error>> {
    // It may have ended by itself in the meantime, which is no fault.
    Command::new("kill").args(["-TERM", &process.to_string()]).stderr(Stdio::null()).status()?;
    Ok(())
}
