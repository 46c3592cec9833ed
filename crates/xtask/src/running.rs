//! Running tiers of checks, one after another or side by side, and summing up.

use std::error::Error;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use crate::counts::{Counts, Format};
use crate::workspace::Workspace;

/// What a tier says: its counts, or why it could not do its work.
pub type Outcome = Result<Counts, Box<dyn Error>>;

/// A group of checks.
pub struct Tier {
    /// Its name in headings and in the closing table.
    pub name: &'static str,
    /// Its checks.
    pub work: Work,
}

/// How a tier does its checks.
pub enum Work {
    /// They speak while they run.
    Live(fn(&Workspace) -> Outcome),
    /// One command: later tiers run beside it, and what it says is shown when all have ended.
    ///
    /// A test program ends on one processor, and the next one waits for it. Alone, a third of two processors was idle.
    Beside(fn(&Workspace) -> Command, Format),
}

impl Work {
    /// Does the checks now, and shows what they say as they say it.
    fn run_live(&self, workspace: &Workspace) -> Outcome {
        match self {
            Self::Live(run) => run(workspace),
            Self::Beside(command, format) => by_counts(command(workspace), *format),
        }
    }
}

/// One check that passed.
pub const ONE_PASSED: Counts = Counts { passed: 1, failed: 0, skipped: 0 };
/// One check that failed.
pub const ONE_FAILED: Counts = Counts { passed: 0, failed: 1, skipped: 0 };

/// One check: the exit status tells.
pub fn by_status(mut command: Command) -> Outcome {
    Ok(if command.status()?.success() { ONE_PASSED } else { ONE_FAILED })
}

/// Counts the checks in the output of a command, and prints the output.
pub fn by_counts(mut command: Command, format: Format) -> Outcome {
    let mut child = command.stdout(Stdio::piped()).spawn()?;
    let output = child.stdout.take().ok_or("no pipe")?;
    let counts = count(output, format, |line| println!("{line}"))?;
    Ok(with_status(counts, child.wait()?.success()))
}

/// Counts the checks in the output of a command, errors included, and keeps the output.
fn by_counts_aside(mut command: Command, format: Format) -> (Counts, Vec<String>) {
    let mut lines = Vec::new();
    let mut follow = || {
        let (output, input) = std::io::pipe()?;
        command.stdout(input.try_clone()?).stderr(input);
        let mut child = command.spawn()?;
        // The command still holds the ends into which it writes, and with them open the reader would wait for ever.
        command.stdout(Stdio::null()).stderr(Stdio::null());
        let counts = count(output, format, |line| lines.push(line))?;
        Ok(with_status(counts, child.wait()?.success()))
    };
    let counts = follow().unwrap_or_else(|error: std::io::Error| {
        lines.push(error.to_string());
        ONE_FAILED
    });
    (counts, lines)
}

/// Counts the checks in what a command prints; each line is handed on.
fn count(
    output: impl Read,
    format: Format,
    mut show: impl FnMut(String),
) -> std::io::Result<Counts> {
    let mut counts = Counts::default();
    for line in BufReader::new(output).split(b'\n') {
        let line = String::from_utf8_lossy(&line?).into_owned();
        if let Some(more) = format.counts_in(line.trim_end()) {
            counts += more;
        }
        show(line);
    }
    Ok(counts)
}

/// A command that fails without a failed check, for instance in compilation, counts as one failed check.
fn with_status(mut counts: Counts, succeeded: bool) -> Counts {
    if !succeeded && counts.failed == 0 {
        counts += ONE_FAILED;
    }
    counts
}

/// Runs all tiers, whatever fails, and sums up; `left_out` names what this command does not run.
pub fn run_all(workspace: &Workspace, tiers: &[Tier], left_out: &[&str]) -> ExitCode {
    let results = run_in_turn(workspace, tiers);
    let (text, failed) = summary(&results, left_out);
    println!("\n{text}");
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Each tier with its counts and its time, in the order of the list.
fn run_in_turn(workspace: &Workspace, tiers: &[Tier]) -> Vec<(&'static str, Counts, Duration)> {
    std::thread::scope(|scope| {
        let mut results = Vec::new();
        let mut asides = Vec::new();
        for (place, tier) in tiers.iter().enumerate() {
            let start = Instant::now();
            let counts = match &tier.work {
                Work::Beside(command, format) if place + 1 < tiers.len() => {
                    println!("\n── {} run beside the next tiers ──", tier.name);
                    let command = command(workspace);
                    let aside = scope.spawn(move || {
                        let (counts, lines) = by_counts_aside(command, *format);
                        (counts, lines, start.elapsed())
                    });
                    asides.push((place, aside));
                    Ok(Counts::default())
                }
                work => {
                    println!("\n── {} ──", tier.name);
                    work.run_live(workspace)
                }
            };
            let counts = counts.unwrap_or_else(|error| {
                println!("{error}");
                ONE_FAILED
            });
            // What the tools print on standard error must come before the next heading.
            let _ = std::io::stdout().flush();
            results.push((tier.name, counts, start.elapsed()));
        }
        for (place, aside) in asides {
            let (counts, lines, time) =
                aside.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            let name = tiers[place].name;
            println!("\n── {name} ──\n{}", lines.join("\n"));
            results[place] = (name, counts, time);
        }
        results
    })
}

/// The closing table and whether anything failed.
fn summary(results: &[(&str, Counts, Duration)], left_out: &[&str]) -> (String, bool) {
    let mut total = Counts::default();
    let mut text =
        format!("{:<20}{:>8}{:>8}{:>9}{:>10}\n", "tier", "passed", "failed", "skipped", "time");
    for (name, counts, time) in results {
        total += *counts;
        text += &format!(
            "{name:<20}{:>8}{:>8}{:>9}{:>8.1} s\n",
            counts.passed,
            counts.failed,
            counts.skipped,
            time.as_secs_f64()
        );
    }
    if total.skipped > 0 {
        text += &format!("skipped inside the tiers: {}\n", total.skipped);
    }
    for tier in left_out {
        text += &format!("left out, {tier}\n");
    }
    text += &format!("{} passed, {} failed", total.passed, total.failed);
    (text, total.failed > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_counts_names_what_was_left_out_and_ends_plainly() {
        let some = |passed, failed, skipped| Counts { passed, failed, skipped };
        let results = [
            ("format", some(1, 0, 0), Duration::from_millis(1500)),
            ("Rust tests", some(40, 2, 3), Duration::from_secs(61)),
        ];
        let (text, failed) = summary(&results, &["physics (cargo xtask physics)"]);
        assert!(failed);
        assert!(text.contains("skipped inside the tiers: 3"));
        assert!(text.contains("left out, physics (cargo xtask physics)"));
        assert_eq!(text.lines().last(), Some("41 passed, 2 failed"));
        let (text, failed) = summary(&results[..1], &[]);
        assert!(!failed);
        assert_eq!(text.lines().last(), Some("1 passed, 0 failed"));
    }

    #[cfg(unix)]
    #[test]
    fn a_command_that_fails_without_counting_is_a_failure() {
        let run = |script: &str| {
            let mut command = Command::new("sh");
            command.args(["-c", script]);
            by_counts(command, Format::Pytest).unwrap()
        };
        assert_eq!(run("echo does not compile; exit 101"), ONE_FAILED);
        assert_eq!(run("echo '3 passed in 0.1s'; exit 0").passed, 3);
        let mixed = run("echo '3 passed, 2 failed in 0.1s'; exit 1");
        assert_eq!((mixed.passed, mixed.failed), (3, 2));
    }

    #[cfg(unix)]
    #[test]
    fn a_tier_runs_beside_later_ones_and_keeps_its_place_and_its_words() {
        let mut script = Command::new("sh");
        script.args(["-c", "echo '3 passed in 0.1s'; echo a fault >&2; exit 1"]);
        let (counts, lines) = by_counts_aside(script, Format::Pytest);
        assert_eq!((counts.passed, counts.failed), (3, 1));
        assert_eq!(lines, ["3 passed in 0.1s", "a fault"]);
        // The first ends when the second has made its file, which it does not before the first has begun.
        let root = std::env::temp_dir().join(format!("xtask-tiers-{}", std::process::id()));
        std::fs::create_dir_all(&root).unwrap();
        let metadata =
            serde_json::json!({"workspace_root": root, "target_directory": root, "packages": []});
        let workspace = Workspace::from_metadata(&metadata).unwrap();
        let waits = Tier {
            name: "waits",
            work: Work::Beside(
                |w| {
                    let mut command = w.command("sh");
                    let script = "while [ ! -e made ]; do sleep 0.01; done; echo '5 passed in 1s'";
                    command.args(["-c", script]);
                    command
                },
                Format::Pytest,
            ),
        };
        let makes = Tier {
            name: "makes",
            work: Work::Live(|w| {
                std::fs::write(w.root.join("made"), "")?;
                Ok(ONE_PASSED)
            }),
        };
        let results = run_in_turn(&workspace, &[waits, makes]);
        let told: Vec<_> = results.iter().map(|r| (r.0, r.1.passed)).collect();
        std::fs::remove_dir_all(&root).unwrap();
        assert_eq!(told, [("waits", 5), ("makes", 1)]);
    }
}
