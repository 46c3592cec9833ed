//! The ledger: bits of every shipped scene and the names that users know, against a record: `cargo xtask ledger`.
//!
//! Scenes are shortened by overrides. Each runs with each instruction set of the machine, on one thread and on three, which must agree.

mod documents;

use std::collections::BTreeSet;
use std::error::Error;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output, Stdio};

use rayon::prelude::*;
use serde_json::Value;

pub use self::documents::commands;
use self::documents::{
    Fallible, Record, checksum, checksums, difference, keys_of_schema, numbers, public_items,
    shortened, visit,
};
use crate::workspace::{Workspace, cargo};

/// The records, relative to the workspace.
const BITS: &str = "validation/ledger/bits.txt";
const NAMES: &str = "validation/ledger/names.txt";

/// Lists of methods whose names scenes use.
const LISTS: [&str; 12] = [
    "observables",
    "integrators",
    "thermostats",
    "barostats",
    "exchanges",
    "potentials",
    "truncations",
    "combining-rules",
    "walls",
    "contacts",
    "bonds",
    "formats",
];

/// The instruction set of sweeps.
const SET_OF_SWEEPS: &str = "avx2";
/// Scenes whose systems, or whose numbers of runs, take longer than all others together.
const LEFT_OUT: [&str; 4] =
    ["bench/melt-953k", "studies/coverage", "studies/coverage-quick", "sweep/seeds"];
/// Studies whose numbers depend on no clock.
const STUDIES: [&[&str]; 2] =
    [&["study", "stability", "--quick", "--json"], &["study", "mechanics", "--quick", "--json"]];

/// Runs the command; the exit code says whether everything is as recorded.
pub fn run(workspace: Workspace, arguments: &[&str]) -> ExitCode {
    let (mut write, mut names_alone, mut binary) = (false, false, None);
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match *argument {
            "--write" => write = true,
            "--names" => names_alone = true,
            "--binary" => binary = rest.next().map(PathBuf::from),
            _ => {
                eprintln!("{}", crate::help::HELP);
                return ExitCode::from(2);
            }
        }
    }
    let done = match binary {
        Some(binary) => {
            fs::canonicalize(binary).map_err(Into::into).map(|binary| workspace.with_binary(binary))
        }
        None => built(workspace),
    };
    let done =
        done.and_then(|workspace| Ledger { workspace: &workspace }.compare(write, names_alone));
    match done {
        Ok(0) => ExitCode::SUCCESS,
        Ok(differences) => {
            println!("{differences} lines differ from the record");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("ledger failed: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Compares the names alone, with the program that is there.
///
/// # Errors
/// Where the program or the record cannot be read, or names differ.
pub fn names_alone(workspace: &Workspace) -> Result<(), Box<dyn Error>> {
    let compared = Ledger { workspace }.compare(false, true);
    match compared.map_err(|error| error as Box<dyn Error>)? {
        0 => Ok(()),
        _ => {
            Err("`cargo xtask ledger --names --write` records names that changed on purpose".into())
        }
    }
}

fn built(workspace: Workspace) -> Fallible<Workspace> {
    let mut build = workspace.command(cargo());
    build.args(["build", "--quiet", "--package", "lennard"]);
    if !build.status()?.success() {
        return Err("the program cannot be built".into());
    }
    Ok(workspace.with_tested_binary())
}

struct Ledger<'a> {
    workspace: &'a Workspace,
}

impl Ledger<'_> {
    /// Lines that differ from the record; with `write` the record is made anew.
    fn compare(&self, write: bool, names_alone: bool) -> Fallible<usize> {
        let mut records = vec![(NAMES, self.names()?)];
        if !names_alone {
            records.push((BITS, self.bits()?));
        }
        let mut differences = 0;
        for (file, now) in records {
            let path = self.workspace.root.join(file);
            if write {
                let lines: String = now
                    .iter()
                    .map(|(key, value)| format!("{key}\t{value}").trim_end().to_owned() + "\n")
                    .collect();
                fs::create_dir_all(path.parent().ok_or("no folder")?)?;
                fs::write(&path, lines)?;
                println!("{file}: {} lines written", now.len());
                continue;
            }
            let text =
                fs::read_to_string(&path).map_err(|e| format!("{file} cannot be read: {e}"))?;
            let recorded: Record = text
                .lines()
                .map(|line| line.split_once('\t').unwrap_or((line, "")))
                .map(|(key, value)| (key.to_owned(), value.to_owned()))
                .collect();
            let found = difference(&recorded, &now, self.sets()?.as_slice());
            println!("{file}: {} lines, {} differ", now.len(), found.len());
            for line in &found {
                println!("  {line}");
            }
            differences += found.len();
        }
        Ok(differences)
    }

    fn said(&self, arguments: &[&str]) -> Fallible<String> {
        let output =
            Command::new(self.workspace.binary()).args(arguments).stdin(Stdio::null()).output()?;
        if !output.status.success() {
            let message = String::from_utf8_lossy(&output.stderr);
            return Err(format!("lennard {}: {}", arguments.join(" "), message.trim()).into());
        }
        Ok(String::from_utf8(output.stdout)?)
    }

    fn listed(&self, list: &str) -> Fallible<Vec<String>> {
        let entries: Value = serde_json::from_str(&self.said(&["list", list, "--json"])?)?;
        let entries = entries["entries"].as_array().ok_or("a list is no list")?;
        Ok(entries.iter().filter_map(|e| e["name"].as_str()).map(str::to_owned).collect())
    }

    /// Instruction sets of this machine that the record is made of.
    fn sets(&self) -> Fallible<Vec<String>> {
        let about: Value = serde_json::from_str(&self.said(&["version", "--json"])?)?;
        let sets = about["isa"].as_array().ok_or("version names no instruction sets")?;
        Ok(sets.iter().filter_map(Value::as_str).map(str::to_owned).collect())
    }

    /// Checksums of what each scene leaves, by instruction set, and numbers of studies.
    fn bits(&self) -> Fallible<Record> {
        let root = self.workspace.target.join("ledger");
        let _ = fs::remove_dir_all(&root);
        fs::create_dir_all(&root)?;
        let sets = self.sets()?;
        let mut tasks = Vec::new();
        for scene in self.listed("scenes")? {
            if LEFT_OUT.contains(&scene.as_str()) {
                continue;
            }
            let (verb, _) = shortened(&self.workspace.root, &scene)?;
            // A sweep adds tables to scenes that are run with every set.
            let of_a_sweep = |set: &&String| verb == "run" || *set == SET_OF_SWEEPS;
            let here = sets.iter().filter(of_a_sweep);
            tasks.extend(here.map(|set| (scene.clone(), set.clone())));
        }
        let lines: Vec<Fallible<(String, String)>> = tasks
            .par_iter()
            .with_max_len(1)
            .map(|(scene, set)| Ok((format!("{scene} {set}"), self.scene(&root, scene, set)?)))
            .collect();
        let mut record: Record = lines.into_iter().collect::<Fallible<_>>()?;
        for study in STUDIES {
            let document: Value = serde_json::from_str(&self.said(study)?)?;
            record.insert(study[1].to_owned(), checksum(numbers(&document).as_bytes()));
        }
        let _ = fs::remove_dir_all(&root);
        Ok(record)
    }

    /// Columns of tables and fields of run.json, from scenes that ask for everything.
    fn names_in_files(&self) -> Fallible<BTreeSet<(String, String)>> {
        let folder = self.workspace.target.join("ledger-names");
        let mut names = BTreeSet::new();
        for scene in self.listed("scenes")?.iter().filter(|scene| scene.ends_with("/everything")) {
            let _ = fs::remove_dir_all(&folder);
            self.run_scene(scene, &["--out".as_ref(), folder.as_os_str()])?;
            for entry in fs::read_dir(&folder)? {
                let file = entry?.file_name().to_string_lossy().into_owned();
                let path = folder.join(&file);
                if file.ends_with(".csv") {
                    let text = fs::read_to_string(&path)?;
                    let heading = text.lines().next().unwrap_or_default();
                    names.extend(
                        heading.split(',').map(|name| (format!("column {file}"), name.to_owned())),
                    );
                } else if file.ends_with(".json") {
                    let document: Value = serde_json::from_slice(&fs::read(&path)?)?;
                    visit("", "[]", &document, &mut |path, _| {
                        // The scene's own keys are named by its schema.
                        if !path.starts_with("scene.") {
                            names.insert((format!("field {file}"), path.to_owned()));
                        }
                    });
                }
            }
        }
        let _ = fs::remove_dir_all(&folder);
        Ok(names)
    }

    /// Runs a scene, shortened.
    fn run_scene(&self, scene: &str, arguments: &[&OsStr]) -> Fallible<Output> {
        let (verb, shortened) = shortened(&self.workspace.root, scene)?;
        let mut command = Command::new(self.workspace.binary());
        command.arg(verb).arg(scene).args(["--quiet", "--no-report"]);
        command.args(arguments).args(shortened);
        Ok(command.stdin(Stdio::null()).output()?)
    }

    /// Exit code and checksums of the files of one scene or sweep.
    fn scene(&self, root: &Path, scene: &str, set: &str) -> Fallible<String> {
        let mut found = Vec::new();
        for threads in ["1", "3"] {
            let folder = root.join(format!("{}-{set}-{threads}", scene.replace('/', "-")));
            let set = format!("kernel.isa={set}");
            let arguments = ["--set", &set, "--threads", threads, "--out"].map(OsStr::new);
            let output =
                self.run_scene(scene, &[&arguments[..], &[folder.as_os_str()]].concat())?;
            let files = if folder.exists() { checksums(&folder)? } else { String::new() };
            let code = output.status.code().unwrap_or(-1);
            found.push(format!("exit={code} {files}").trim_end().to_owned());
            let _ = fs::remove_dir_all(&folder);
        }
        if found[0] != found[1] {
            return Err(format!(
                "{scene} {set}: bits depend on threads:\n{}\n{}",
                found[0], found[1]
            )
            .into());
        }
        Ok(found.swap_remove(0))
    }

    /// Names that users know: each a line, with where it stands.
    fn names(&self) -> Fallible<Record> {
        let mut all = Record::new();
        let mut add = |kind: &str, name: &str| {
            all.insert(format!("{kind} {name}"), String::new());
        };
        let schema: Value = serde_json::from_str(&self.said(&["generate", "schema"])?)?;
        for path in keys_of_schema(&schema) {
            add("key", &path);
        }
        for (command, options) in commands(self.workspace)? {
            add("command", &command);
            options.iter().for_each(|option| add("option", &format!("{command} {option}")));
        }
        for list in LISTS {
            for name in self.listed(list)? {
                add(list, &name);
            }
        }
        for (file, name) in self.names_in_files()? {
            add(&file, &name);
        }
        for name in public_items(self.workspace)? {
            add("public", &name);
        }
        Ok(all)
    }
}
