//! Commands in README and docs/ have the names and options of the program.

use std::fs;
use std::path::Path;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};

use super::Cli;

/// The commands of a text: inline code, lines of blocks, and the part of `cargo run … -- COMMAND`.
fn commands(text: &str) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let mut is_fenced = false;
    for line in text.lines() {
        is_fenced ^= line.starts_with("```");
        let code: Vec<&str> = match is_fenced || line.starts_with("    ") {
            true => vec![line],
            false => line.split('`').skip(1).step_by(2).collect(),
        };
        for code in code {
            let code = code.trim().trim_start_matches("$ ");
            let words = match code.split_once(" -- ") {
                Some(("cargo run --profile first", words)) => words,
                _ => code.strip_prefix("lennard ").unwrap_or_default(),
            };
            let is_end = |word: &&str| !word.starts_with(['|', '>', '#', '&', ';', '\\']);
            let words: Vec<String> =
                words.split_whitespace().take_while(is_end).map(str::to_owned).collect();
            if words.first().is_some_and(|w| w.chars().all(|c| c.is_ascii_lowercase() || c == '-'))
            {
                found.push(words);
            }
        }
    }
    found
}

/// Whether the program has a command and its options; values may be stand-ins such as N.
fn is_known(words: &[String]) -> bool {
    let arguments = ["lennard"].into_iter().chain(words.iter().map(String::as_str));
    let unknown = [ErrorKind::UnknownArgument, ErrorKind::InvalidSubcommand];
    Cli::try_parse_from(arguments).err().is_none_or(|error| !unknown.contains(&error.kind()))
}

#[test]
fn commands_of_documents_are_known() {
    Cli::command().debug_assert();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut count = 0;
    for folder in [".", "docs", "docs/tutorials"] {
        for entry in fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let is_page = path.extension().is_some_and(|e| e == "md");
            if !is_page || path.ends_with("CHANGELOG.md") {
                continue;
            }
            for words in commands(&fs::read_to_string(&path).unwrap()) {
                count += 1;
                assert!(is_known(&words), "{}: lennard {}", path.display(), words.join(" "));
            }
        }
    }
    assert!(count > 50, "{count}");
}

/// Whether a command and the commands below it show examples that are parsed, on lines that no terminal of 100 columns breaks.
fn examples_are_typed_well(command: &clap::Command) {
    let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    for line in help.lines().filter(|line| line.starts_with("  lennard ")) {
        assert!(line.chars().count() < 100, "{line}");
        let typed = line.split("   ").find(|part| !part.is_empty()).unwrap();
        let words = &commands(&format!("`{}`", typed.trim()));
        let error = words.first().and_then(|words| {
            Cli::try_parse_from(["lennard"].into_iter().chain(words.iter().map(String::as_str)))
                .err()
        });
        assert!(error.is_none(), "{line}: {error:?}");
    }
    command.get_subcommands().for_each(examples_are_typed_well);
}

#[test]
fn examples_of_every_command_are_parsed() {
    examples_are_typed_well(&Cli::command());
}

#[test]
fn an_unknown_command_and_an_unknown_option_are_found() {
    let of = |text| commands(text).iter().all(|words| is_known(words));
    assert!(of(
        "`lennard run x --threads N`, `cargo run --profile first -- list bonds`, `lennard`"
    ));
    for text in ["    lennard fly", "`cargo run --profile first -- fly`", "`lennard run x --fast`"]
    {
        assert!(!of(text), "{text}");
    }
}
