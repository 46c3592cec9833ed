//! Counted runs: `cargo xtask fuzz [--runs N] [--target NAME] [--seed N]`.
#![allow(clippy::print_stdout, clippy::print_stderr)] // a command-line tool speaks on both

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use lennard_fuzz::{Mutator, TARGETS, Target};

/// Inputs a reader where nothing else is said: some seconds each.
const DEFAULT_RUNS: u64 = 100_000;

/// Reading one input takes microseconds; more than this is hanging, however busy the machine is.
const LONGEST_READ: Duration = Duration::from_secs(30);

/// The most memory (kB) that the whole process may ever have held: inputs are below 64 kB.
const MOST_MEMORY: u64 = 256 << 10;

fn help() -> String {
    let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
    format!(
        "Usage: cargo xtask fuzz [--runs N] [--target NAME] [--seed N]\n\n\
         \x20 --runs N       Inputs for each reader (default {DEFAULT_RUNS})\n\
         \x20 --target NAME  One of them; all by default:\n\
         \x20                {}\n\
         \x20 --seed N       Seed of the mutations (default 1)",
        names.join(", ")
    )
}

struct Arguments {
    runs: u64,
    seed: u64,
    target: Option<String>,
}

fn arguments() -> Result<Arguments, String> {
    let mut found = Arguments { runs: DEFAULT_RUNS, seed: 1, target: None };
    let mut given = std::env::args().skip(1);
    while let Some(name) = given.next() {
        let value = given.next().ok_or_else(|| format!("{name} wants a value"))?;
        let number = || {
            value
                .parse::<u64>()
                .map_err(|_| format!("{name} wants a whole number, found `{value}`"))
        };
        match name.as_str() {
            "--runs" => found.runs = number()?,
            "--seed" => found.seed = number()?,
            "--target" if TARGETS.iter().any(|t| t.name == value) => found.target = Some(value),
            _ => return Err(format!("unknown: {name} {value}")),
        }
    }
    Ok(found)
}

fn main() -> ExitCode {
    let arguments = match arguments() {
        Ok(arguments) => arguments,
        Err(fault) => {
            eprintln!("{fault}\n\n{}", help());
            return ExitCode::from(2);
        }
    };
    let mut failed = false;
    for target in
        TARGETS.iter().filter(|t| arguments.target.as_ref().is_none_or(|name| name == t.name))
    {
        if let Err(error) = count(target, &arguments) {
            eprintln!("{}: {error}", target.name);
            failed = true;
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Feeds one reader, and says how many inputs it took and how many it accepted.
fn count(target: &Target, arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let corpus = corpus(target)?;
    for (path, bytes) in &corpus {
        read(target, bytes, path)?;
    }
    let files = corpus.len();
    let mut mutator =
        Mutator::new(target, corpus.into_iter().map(|(_, bytes)| bytes).collect(), arguments.seed);
    let start = Instant::now();
    let (mut accepted, mut slowest) = (0_u64, Duration::ZERO);
    for run in 0..arguments.runs {
        let input = mutator.input();
        let clock = Instant::now();
        let name = format!("input {run} of seed {}", arguments.seed);
        accepted += u64::from(read(target, &input, Path::new(&name))?);
        slowest = slowest.max(clock.elapsed());
    }
    let seconds = start.elapsed().as_secs_f64();
    let memory = most_memory();
    println!(
        "{:<14}{:>10} inputs from {files} files (seed {}), {accepted} accepted, {} refused, none crashed; {:.0} a second, \
         slowest {:.1} ms, at most {} kB of memory",
        target.name,
        arguments.runs,
        arguments.seed,
        arguments.runs - accepted,
        arguments.runs as f64 / seconds,
        1e3 * slowest.as_secs_f64(),
        memory.map_or_else(|| "unknown".into(), |kb| kb.to_string()),
    );
    if slowest > LONGEST_READ {
        return Err(format!("one input took {slowest:?}").into());
    }
    match memory {
        Some(kb) if kb > MOST_MEMORY => {
            Err(format!("{kb} kB of memory, more than {MOST_MEMORY} kB").into())
        }
        _ => Ok(()),
    }
}

/// Reads one input; where that panics, keeps it as a file.
fn read(target: &Target, input: &[u8], name: &Path) -> Result<bool, Box<dyn Error>> {
    std::panic::catch_unwind(|| (target.body)(input)).map_err(|_| {
        let kept = std::env::temp_dir().join(format!(
            "lennard-fuzz-{}-{}",
            target.name,
            std::process::id()
        ));
        match fs::write(&kept, input) {
            Ok(()) => format!("{} crashed it; kept as {}", name.display(), kept.display()).into(),
            Err(e) => format!("{} crashed it, and could not be kept: {e}", name.display()).into(),
        }
    })
}

/// Path and content.
type CorpusFile = (PathBuf, Vec<u8>);

/// The files that mutations start from, in the order of their names.
fn corpus(target: &Target) -> Result<Vec<CorpusFile>, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target.name);
    let mut files = Vec::new();
    for entry in fs::read_dir(&folder)? {
        let path = entry?.path();
        files.push((path.clone(), fs::read(&path)?));
    }
    files.sort();
    Ok(files)
}

/// The most memory that this process has held so far, in kB, where the system tells.
fn most_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}
