//! Running what is not there yet, and concluding anew what is.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use serde_json::Value;

use super::plan::Cell;

/// What went wrong.
pub type Failure = Box<dyn Error + Send + Sync>;

/// The name of the scene file in a cell's folder.
const SCENE: &str = "coverage.toml";
/// The record of a run.
const RECORD: &str = "run.json";

/// A run of a cell.
#[derive(Debug, Clone)]
pub struct Run {
    /// The cell.
    pub cell: Cell,
    /// Its number, from 1.
    pub number: u32,
}

impl Run {
    fn below(&self, root: &Path) -> PathBuf {
        root.join(self.cell.folder()).join(format!("seed-{:02}", self.number))
    }

    /// The record of the run, where it is finished.
    pub fn record(&self, root: &Path) -> Option<Value> {
        let text = fs::read(self.below(root).join(RECORD)).ok()?;
        let record: Value = serde_json::from_slice(&text).ok()?;
        (record["finished"] == true).then_some(record)
    }
}

/// The program, and how many of it run at a time.
pub struct Runner {
    /// The program.
    pub binary: PathBuf,
    /// Runs at a time.
    pub workers: usize,
}

impl Runner {
    /// Runs everything that is not finished yet.
    ///
    /// # Errors
    ///
    /// A run that fails; a folder made by another plan.
    pub fn simulate(&self, runs: &[Run], root: &Path) -> Result<(), Failure> {
        let missing: Vec<&Run> = runs.iter().filter(|run| run.record(root).is_none()).collect();
        eprintln!("{} runs, {} of them to do", runs.len(), missing.len());
        for run in &missing {
            write_scene(&run.cell, root)?;
        }
        self.each(&missing, |run| {
            let scene = root.join(run.cell.folder()).join(SCENE);
            let seed = run.cell.seed(run.number).to_string();
            self.call(&[
                "run".as_ref(),
                scene.as_ref(),
                "--seed".as_ref(),
                seed.as_ref(),
                "--out".as_ref(),
                run.below(root).as_ref(),
                "--force".as_ref(),
            ])
        })
    }

    /// Concludes finished runs of `data` with this program, from copies of their last checkpoints: the records go to
    /// `root`, and `data` stays as it is.
    ///
    /// # Errors
    ///
    /// A run that cannot be read.
    pub fn conclude(&self, runs: &[Run], data: &Path, root: &Path) -> Result<(), Failure> {
        let finished: Vec<&Run> = runs.iter().filter(|run| run.record(data).is_some()).collect();
        eprintln!("{} of {} runs are finished", finished.len(), runs.len());
        self.each(&finished, |run| {
            let (from, to) = (run.below(data), run.below(root));
            let copy = to.with_extension("copy");
            let _ = fs::remove_dir_all(&copy);
            fs::create_dir_all(&copy)?;
            for entry in fs::read_dir(&from)? {
                let entry = entry?;
                fs::copy(entry.path(), copy.join(entry.file_name()))?;
            }
            self.call(&["resume".as_ref(), copy.as_ref()])?;
            fs::create_dir_all(&to)?;
            fs::copy(copy.join(RECORD), to.join(RECORD))?;
            fs::remove_dir_all(&copy)?;
            Ok(())
        })
    }

    fn call(&self, arguments: &[&Path]) -> Result<(), Failure> {
        let output = Command::new(&self.binary)
            .args(arguments)
            .args(["--threads", "1", "--quiet", "--no-report"])
            .stdin(Stdio::null())
            .output()
            .map_err(|e| format!("{} cannot be started: {e}", self.binary.display()))?;
        if output.status.success() {
            return Ok(());
        }
        let message = String::from_utf8_lossy(&output.stderr);
        Err(format!("it ended with {}:\n{message}", output.status).into())
    }

    /// Does something for every run, several at a time; the first failure stops what has not begun.
    fn each(
        &self,
        runs: &[&Run],
        work: impl Fn(&Run) -> Result<(), Failure> + Sync,
    ) -> Result<(), Failure> {
        let start = Instant::now();
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let stop = AtomicBool::new(false);
        let first = Mutex::new(None);
        std::thread::scope(|scope| {
            for _ in 0..self.workers {
                scope.spawn(|| {
                    while let Some(run) = runs.get(next.fetch_add(1, Ordering::Relaxed)) {
                        if stop.load(Ordering::Relaxed) {
                            return;
                        }
                        if let Err(error) = work(run) {
                            stop.store(true, Ordering::Relaxed);
                            let text =
                                format!("{}, run {}: {error}", run.cell.folder(), run.number);
                            if let Ok(mut first) = first.lock() {
                                first.get_or_insert(text);
                            }
                            return;
                        }
                        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                        if done.is_multiple_of(EVERY) || done == runs.len() {
                            eprintln!(
                                "{done} of {} after {:.0} s, last {}",
                                runs.len(),
                                start.elapsed().as_secs_f64(),
                                run.cell.folder()
                            );
                        }
                    }
                });
            }
        });
        match first.into_inner() {
            Ok(Some(text)) => Err(text.into()),
            _ => Ok(()),
        }
    }
}

/// Runs between two lines of progress.
const EVERY: usize = 30;

/// Writes the scene of a cell, unless another one is there.
fn write_scene(cell: &Cell, root: &Path) -> Result<(), Failure> {
    let folder = root.join(cell.folder());
    let path = folder.join(SCENE);
    let wanted = cell.scene();
    match fs::read_to_string(&path) {
        Ok(found) if found == wanted => return Ok(()),
        Ok(_) => {
            return Err(format!(
                "{} holds runs of another scene; give another folder with --out",
                folder.display()
            )
            .into());
        }
        Err(_) => {}
    }
    fs::create_dir_all(&folder)?;
    fs::write(&path, wanted).map_err(|e| format!("{}: {e}", path.display()).into())
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::super::plan::{Ensemble, STATES};
    use super::*;

    /// In place of the program: a run counts itself, a resumed one writes another record.
    const SCRIPT: &str = r#"#!/bin/sh
case $1 in
run)
    case $4 in *000013) echo "seed $4 is unlucky" >&2; exit 3;; esac
    mkdir -p "$6"; echo x >> "$6/times"; echo '{"finished": true, "by": "run"}' > "$6/run.json";;
resume) echo '{"finished": true, "by": "resume"}' > "$2/run.json";;
esac
"#;

    fn runs(numbers: std::ops::RangeInclusive<u32>) -> Vec<Run> {
        let cell = Cell { state: &STATES[0], ensemble: Ensemble::Bussi, length: 2500 };
        numbers.map(|number| Run { cell, number }).collect()
    }

    #[test]
    fn finished_runs_are_kept_concluded_from_copies_and_a_failure_is_told() {
        let root = std::env::temp_dir().join(format!("coverage-runner-{}", std::process::id()));
        let (data, again) = (root.join("data"), root.join("again"));
        fs::create_dir_all(&root).unwrap();
        let runner = Runner { binary: root.join("program"), workers: 2 };
        fs::write(&runner.binary, SCRIPT).unwrap();
        fs::set_permissions(&runner.binary, fs::Permissions::from_mode(0o755)).unwrap();
        runner.simulate(&runs(1..=3), &data).unwrap();
        // As a run that was killed leaves its folder.
        fs::remove_file(runs(2..=2)[0].below(&data).join(RECORD)).unwrap();
        runner.simulate(&runs(1..=4), &data).unwrap();
        let times = |n| fs::read_to_string(runs(n..=n)[0].below(&data).join("times")).unwrap();
        assert_eq!([1, 2, 3, 4].map(|n| times(n).lines().count()), [1, 2, 1, 1]);

        runner.conclude(&runs(1..=5), &data, &again).unwrap();
        for run in runs(1..=4) {
            assert_eq!(run.record(&data).unwrap()["by"], "run");
            assert_eq!(run.record(&again).unwrap()["by"], "resume");
        }
        assert!(runs(5..=5)[0].record(&again).is_none());

        let text = runner.simulate(&runs(12..=14), &data).unwrap_err().to_string();
        assert!(
            text.contains("rho0.003-T0.9/bussi/2500, run 13: it ended with exit status: 3"),
            "{text}"
        );
        assert!(text.contains("is unlucky"), "{text}");

        fs::write(data.join("rho0.003-T0.9/bussi/2500").join(SCENE), "other").unwrap();
        let text = runner.simulate(&runs(20..=20), &data).unwrap_err().to_string();
        assert!(text.contains("holds runs of another scene"), "{text}");
        fs::remove_dir_all(root).unwrap();
    }
}
