//! What records are made of: shortened scenes, checksums, numbers and names.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::workspace::Workspace;

/// What reading a record gives; threads pass its errors on.
pub type Fallible<T> = Result<T, Box<dyn Error + Send + Sync>>;
/// Lines of a record: what each is about, and what is there.
pub type Record = BTreeMap<String, String>;

/// Steps of a stage at most.
const STEPS: i64 = 200;
/// Fields of records that name the machine, its speed or its clock.
const OF_THE_MACHINE: [&str; 6] =
    ["wall_s", "performance", "host", "threads", "ns_per_atom_step", "cost"];
/// Files that hold costs by the clock.
const FILES_OF_CLOCKS: [&str; 2] = ["ensemble.csv", "pace.svg"];

/// Fields of run.json that repeat the scene.
const OF_THE_SCENE: [&str; 5] = ["scene", "atoms", "n_dof", "seed", "steps"];

/// The command for a scene or a sweep, and overrides that leave at most [`STEPS`] steps to each stage.
pub fn shortened(root: &Path, scene: &str) -> Fallible<(&'static str, Vec<String>)> {
    let file = root.join("inputs").join(format!("{scene}.toml"));
    let mut table: toml::Table = fs::read_to_string(&file)?.parse()?;
    let mut verb = "run";
    if let Some(base) = table.get("base").and_then(toml::Value::as_str) {
        verb = "sweep";
        let base = file.parent().ok_or("no folder")?.join(base);
        table = fs::read_to_string(base)?.parse()?;
    }
    let stages = table.get("stage").and_then(toml::Value::as_array);
    let mut overrides = Vec::new();
    for (index, stage) in stages.into_iter().flatten().enumerate() {
        let steps = stage.get("steps").and_then(toml::Value::as_integer);
        let name = stage.get("name").and_then(toml::Value::as_str);
        let name = name.map_or_else(|| index.to_string(), str::to_owned);
        let steps = steps.unwrap_or(STEPS).min(STEPS);
        overrides.extend(["--set".to_owned(), format!("stage.{name}.steps={steps}")]);
    }
    Ok((verb, overrides))
}

/// Checksums of the files of a run: the record by field, tables and trajectories whole; checkpoints hold wall times.
pub fn checksums(folder: &Path) -> Fallible<String> {
    let mut sums = BTreeMap::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            continue;
        }
        let name = entry.file_name().to_string_lossy().into_owned();
        if FILES_OF_CLOCKS.contains(&name.as_str()) {
            continue;
        }
        let bytes = fs::read(entry.path())?;
        if name.ends_with(".json") {
            let record: Value = serde_json::from_slice(&bytes)?;
            for (field, value) in record.as_object().ok_or("a record is no object")? {
                let text = numbers(value);
                let left_out = [&OF_THE_SCENE[..], &OF_THE_MACHINE]
                    .iter()
                    .any(|fields| fields.contains(&field.as_str()));
                if !left_out && !text.is_empty() {
                    sums.insert(format!("{name}/{field}"), checksum(text.as_bytes()));
                }
            }
        } else if ![".lennard", ".toml", ".html"].iter().any(|end| name.ends_with(end)) {
            sums.insert(name, checksum(&bytes));
        }
    }
    Ok(sums.iter().map(|(name, sum)| format!("{name}={sum}")).collect::<Vec<_>>().join(" "))
}

pub fn checksum(bytes: &[u8]) -> String {
    format!("{:08x}", crc32fast::hash(bytes))
}

/// The numbers of a document with the path of each; sentences may change without them.
pub fn numbers(document: &Value) -> String {
    let mut lines = Vec::new();
    visit("", "", document, &mut |path, value| {
        let of_the_machine = path.split('.').any(|part| OF_THE_MACHINE.contains(&part));
        if value.is_number() && !of_the_machine {
            lines.push(format!("{path}={value}"));
        }
    });
    lines.sort();
    lines.join("\n")
}

/// Visits each value that holds no others, with its path, but no cells of a column that counts ns. Entries of a list are called
/// `entry`, or by their numbers where it is empty.
pub fn visit(path: &str, entry: &str, value: &Value, visitor: &mut impl FnMut(&str, &Value)) {
    match value {
        Value::Object(fields) => {
            let is_clock =
                fields.get("unit").and_then(Value::as_str).is_some_and(|u| u.starts_with("ns "));
            fields
                .iter()
                .filter(|(key, _)| !(is_clock && *key == "cells"))
                .for_each(|(key, value)| visit(&format!("{path}.{key}"), entry, value, visitor));
        }
        Value::Array(entries) => {
            for (number, value) in entries.iter().enumerate() {
                let name = if entry.is_empty() { number.to_string() } else { entry.to_owned() };
                visit(&format!("{path}.{name}"), entry, value, visitor);
            }
        }
        _ => visitor(path.trim_start_matches('.'), value),
    }
}

/// Dotted paths of all keys of a schema.
pub fn keys_of_schema(schema: &Value) -> BTreeSet<String> {
    fn walk(path: &str, schema: &Value, keys: &mut BTreeSet<String>) {
        match schema {
            Value::Object(fields) => {
                for (word, inner) in fields {
                    match (word.as_str(), inner) {
                        ("properties", Value::Object(properties)) => {
                            for (key, inner) in properties {
                                let path = format!("{path}.{key}");
                                walk(&path, inner, keys);
                                keys.insert(path.trim_start_matches('.').to_owned());
                            }
                        }
                        _ => walk(path, inner, keys),
                    }
                }
            }
            Value::Array(entries) => entries.iter().for_each(|entry| walk(path, entry, keys)),
            _ => {}
        }
    }
    let mut keys = BTreeSet::new();
    walk("", schema, &mut keys);
    keys
}

/// Public items of the library that users depend on, by file.
pub fn public_items(workspace: &Workspace) -> Fallible<Vec<String>> {
    let files =
        workspace.tracked(&[":(glob)crates/lennard/src/*.rs"]).map_err(|e| e.to_string())?;
    let mut items = Vec::new();
    for file in files {
        let text = fs::read_to_string(workspace.root.join(&file))?;
        for line in text.lines().map(str::trim_start) {
            let Some(rest) = line.strip_prefix("pub ") else {
                continue;
            };
            let rest = rest.trim_start_matches("const ").trim_start_matches("unsafe ");
            let name: String = rest
                .chars()
                .take_while(|c| !matches!(c, '(' | '<' | '{' | ':' | '=' | ';'))
                .collect();
            items.push(name.trim().to_owned());
        }
    }
    Ok(items)
}

/// Lines that are missing, new or other. Lines of an instruction set that this machine lacks are left out.
pub fn difference(recorded: &Record, now: &Record, sets: &[String]) -> Vec<String> {
    let judged = |key: &String| {
        let set = key.split(' ').nth(1);
        set.is_none_or(|set| !matches!(set, "avx2" | "avx512") || sets.iter().any(|s| s == set))
    };
    let mut lines = Vec::new();
    for key in recorded.keys().chain(now.keys()).collect::<BTreeSet<_>>() {
        match (recorded.get(key), now.get(key)) {
            (Some(old), Some(new)) if old != new => {
                let old: BTreeSet<&str> = old.split(' ').collect();
                let changed: Vec<&str> =
                    new.split(' ').filter(|part| !old.contains(part)).collect();
                let changed: Vec<&str> =
                    changed.iter().filter_map(|part| part.split('=').next()).collect();
                lines.push(format!("{key}: {}", changed.join(", ")));
            }
            (Some(_), None) if judged(key) => lines.push(format!("{key}: gone")),
            (None, Some(_)) => lines.push(format!("{key}: new")),
            _ => {}
        }
    }
    lines
}

/// The commands of `lennard` with their options, from its own help.
pub fn commands(workspace: &Workspace) -> Fallible<BTreeMap<String, Vec<String>>> {
    let help = |arguments: &[&str]| -> Fallible<String> {
        let output =
            workspace.command(workspace.binary()).args(arguments).arg("--help").output()?;
        Ok(String::from_utf8(output.stdout)?)
    };
    let mut commands = BTreeMap::new();
    let mut unread = names_in(&help(&[])?);
    while let Some(name) = unread.pop() {
        let text = help(&name.split(' ').collect::<Vec<_>>())?;
        unread.extend(names_in(&text).into_iter().map(|below| format!("{name} {below}")));
        commands.insert(name, options_in(&text));
    }
    if commands.is_empty() {
        return Err("`lennard --help` lists no commands".into());
    }
    Ok(commands)
}

/// The first words below `Commands:`; a description that was wrapped stands further to the right.
fn names_in(help: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| line.trim() != "Commands:").skip(1);
    lines
        .take_while(|line| !line.trim().is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .map(str::to_owned)
        .collect()
}

/// The options of a help; its examples have options of other commands too.
fn options_in(help: &str) -> Vec<String> {
    let help = help.split("Examples:").next().unwrap_or_default();
    help.split(|c: char| c.is_whitespace() || ",=[]<>`".contains(c))
        .filter(|word| word.starts_with("--"))
        .map(str::to_owned)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(lines: &[(&str, &str)]) -> Record {
        lines.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn a_changed_file_a_lost_and_a_new_name_are_named() {
        let recorded = record(&[
            ("a avx2", "thermo.csv=1 rdf.csv=2"),
            ("key x", ""),
            ("b avx512", "thermo.csv=1"),
        ]);
        let now = record(&[("a avx2", "thermo.csv=1 rdf.csv=3"), ("key y", "")]);
        let found = difference(&recorded, &now, &["avx2".to_owned()]);
        assert_eq!(found, ["a avx2: rdf.csv", "key x: gone", "key y: new"]);
    }

    #[test]
    fn numbers_are_seen_and_sentences_are_not() {
        let at = |text: &str| numbers(&serde_json::from_str(text).unwrap());
        assert_eq!(
            at(r#"{"a": [1, 2.5], "why": "short"}"#),
            at(r#"{"why": "long", "a": [1, 2.5]}"#)
        );
        assert_ne!(at(r#"{"a": [1, 2.5]}"#), at(r#"{"a": [1, 2.25]}"#));
        let column =
            |unit: &str, cell: &str| at(&format!(r#"{{"unit": "{unit}", "cells": [{cell}]}}"#));
        assert_eq!(column("ns per bond", "82.4"), column("ns per bond", "94.9"));
        assert_ne!(column("tau", "82.4"), column("tau", "94.9"));
    }

    #[test]
    fn keys_of_tables_in_lists_are_found() {
        let schema = serde_json::from_str(
            r#"{"properties": {"stage": {"items": {"properties": {"dt": {}}}}}}"#,
        )
        .unwrap();
        assert!(keys_of_schema(&schema).contains("stage.dt"));
    }

    #[test]
    fn a_folder_has_no_sum_of_its_clock() {
        let folder = std::env::temp_dir().join(format!("ledger-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let with = |wall: f64, mean: f64| {
            let text = format!(
                "{{\"wall_s\": {wall}, \"performance\": {{\"ns\": {wall}}}, \"averages\": [{mean}]}}"
            );
            fs::write(folder.join("run.json"), text).unwrap();
            checksums(&folder).unwrap()
        };
        assert_eq!(with(1.0, 2.0), with(1.5, 2.0));
        assert_ne!(with(1.0, 2.0), with(1.0, 2.5));
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn commands_and_options_are_read_from_help() {
        let help = "Usage: lennard\n\nCommands:\n  run   Run a scene\n          and wrap\n  list  List\n\nOptions:\n  -h, --help  Print help\n";
        assert_eq!(names_in(help), ["run", "list"]);
        assert_eq!(
            options_in("  -o, --out <DIR>  Folder [default: x]\n  --set <K=V>\n"),
            ["--out", "--set"]
        );
    }
}
