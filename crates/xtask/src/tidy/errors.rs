//! Every error text that a user can meet is in a test.
//!
//! Texts are the formats of `#[error("…")]` and the texts in calls that make errors.
//! Evidence is every text in a test (`tests/`, `#[cfg(test)]`, `python/tests`) and every line of `inputs/bad/*.expected`.
//! A text counts as tested where a piece of evidence contains the longest piece between its placeholders.
//! It also counts where a piece of evidence is part of this text and of no other text.

use std::collections::BTreeSet;
use std::error::Error;
use std::path::Path;

use super::literals::{Found, in_source};
use crate::workspace::Workspace;

/// Calls whose texts a user reads when something fails. Each is the last name before the bracket, or the last two.
const MAKERS: &[&str] = &[
    "Failure::new",
    "SceneError::new",
    "invalid",
    "malformed",
    "misfit",
    "refuse",
    "refuse_at",
    "refuse_end",
    "eprintln",
    "Err",
];

/// Folders of libraries and of the program; what they say to developers of this repository is no error text of a user.
const SOURCES: &str = "crates";
const NOT_FOR_USERS: &[&str] = &["crates/xtask", "crates/literature/examples"];

/// Texts that no user can meet, each with the reason.
const EXCEPTIONS: &[(&str, &str)] = &[
    (
        "species of the particles",
        "the writer gets the species of the state that it writes, which no input can make unlike",
    ),
    ("one for every particle", "the other half of the same refusal"),
    (
        "the calculator takes one species of particles",
        "the calculator writes its scene itself, with one species",
    ),
    (
        "an earlier run of this simulation ended in a bug of the program",
        "a simulation in Python after a panic, which no input causes",
    ),
    (
        "writing JSON",
        "documents are numbers, texts and lists under names that are texts: serde_json writes all of them",
    ),
    (
        "listening for signals",
        "a system refuses a handler for signals that no program may catch, and none of them is asked for",
    ),
    ("finite positive lengths", "the scene's own check of its box comes first"),
    (
        "a value without a key",
        "the other half of a serde protocol, in which a value is never asked for before its key",
    ),
    (
        "a name alone is not enough here",
        "the other half of a serde protocol: no key of a scene is an enumeration that holds values",
    ),
    (
        "holds a value of the wrong type",
        "what `serde` calls a wrong type is always the value of a key, which is then named",
    ),
    (
        "is not a table",
        "the shape of every table is looked at when the file is read, before anything in it",
    ),
    (
        "it was not run",
        "a worker that takes a point leaves its result; this stands for one that panicked",
    ),
    ("nothing was run to verify", "the chosen settings are always among those that are run"),
    (
        "no settings held when they were run",
        "the last trial returns what it found, whatever that is",
    ),
    ("unknown arguments:", "said to developers by the program behind `cargo xtask accuracy`"),
];

/// Evidence shorter than this (characters), or of one word, says too little.
const SHORTEST_EVIDENCE: usize = 10;
/// A piece of a text shorter than this (letters) is punctuation around what another error says.
const SHORTEST_PIECE: usize = 8;

/// An error text and where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Text {
    place: String,
    pieces: Vec<String>,
}

/// Reads the sources and the tests.
pub fn faults(workspace: &Workspace) -> Result<Vec<String>, Box<dyn Error>> {
    let (mut texts, mut evidence) = (Vec::new(), Vec::new());
    for path in files(&workspace.root.join(SOURCES), "rs")? {
        let name = path.strip_prefix(&workspace.root)?.display().to_string();
        if NOT_FOR_USERS.iter().any(|folder| name.starts_with(folder)) {
            continue;
        }
        let source = std::fs::read_to_string(&path)?;
        let found = in_source(&source, name.contains("/tests"))
            .map_err(|e| format!("{name} cannot be read as Rust: {e}"))?;
        for item in found {
            match item {
                Found::Test(text) => evidence.push(text),
                Found::Call { name: maker, line, text } if MAKERS.contains(&maker.as_str()) => {
                    texts.extend(of_user(&format!("{name}:{line}"), &text));
                }
                Found::Call { .. } => {}
                Found::ErrorAttribute { line, text } => {
                    texts.extend(of_user(&format!("{name}:{line}"), &text));
                }
            }
        }
    }
    for path in files(&workspace.root.join("inputs/bad"), "expected")? {
        let expected = std::fs::read_to_string(path)?;
        let lines = expected.lines().filter(|l| !l.starts_with('#'));
        evidence.extend(lines.map(str::to_owned));
    }
    for path in files(&workspace.root.join("python/tests"), "py")? {
        evidence.extend(in_quotes(&std::fs::read_to_string(&path)?));
    }
    Ok(untested(&texts, &evidence, EXCEPTIONS))
}

/// Texts in double quotes, line by line, as tests in Python have them.
fn in_quotes(source: &str) -> Vec<String> {
    let lines = source.lines();
    lines.flat_map(|line| line.split('"').skip(1).step_by(2)).map(str::to_owned).collect()
}

/// Files below a folder whose names end so, in the order of their names.
fn files(folder: &Path, extension: &str) -> Result<Vec<std::path::PathBuf>, Box<dyn Error>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))? {
        let path = entry?.path();
        if path.is_dir() {
            found.extend(files(&path, extension)?);
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// The text cut at its placeholders; `None` where nothing is left that says anything.
fn of_user(place: &str, text: &str) -> Option<Text> {
    let mut pieces = vec![String::new()];
    let mut depth = 0;
    let mut letters = text.chars().peekable();
    while let Some(c) = letters.next() {
        match c {
            // A doubled brace is a brace.
            '{' | '}' if depth == 0 && letters.peek() == Some(&c) => {
                letters.next();
                pieces.last_mut()?.push(c);
            }
            '{' => {
                depth += 1;
                pieces.push(String::new());
            }
            '}' => depth -= 1,
            _ if depth == 0 => pieces.last_mut()?.push(c),
            _ => {}
        }
    }
    let pieces: Vec<String> = pieces
        .iter()
        .flat_map(|piece| piece.split('\n'))
        .map(|piece| piece.trim().to_owned())
        .filter(|piece| letters_in(piece) > 0)
        .collect();
    let says_something = pieces.iter().any(|p| letters_in(p) >= SHORTEST_PIECE);
    says_something.then(|| Text { place: place.to_owned(), pieces })
}

fn letters_in(text: &str) -> usize {
    text.chars().filter(|c| c.is_alphabetic()).count()
}

/// The texts without evidence, and the exceptions that are none any more.
fn untested(texts: &[Text], evidence: &[String], exceptions: &[(&str, &str)]) -> Vec<String> {
    let told: Vec<&str> = evidence.iter().map(|e| e.trim()).collect();
    let tested = |text: &Text| {
        let longest = text.pieces.iter().max_by_key(|p| p.len());
        longest.is_some_and(|piece| told.iter().any(|e| e.contains(piece.as_str())))
            || told.iter().any(|e| {
                says_enough(e)
                    && text.pieces.iter().any(|p| p.contains(e))
                    && texts.iter().all(|other| {
                        other.pieces == text.pieces || !other.pieces.iter().any(|p| p.contains(e))
                    })
            })
    };
    let excepted = |text: &Text| {
        let mut exceptions = exceptions.iter();
        exceptions.any(|(piece, _)| text.pieces.iter().any(|p| p.contains(piece)))
    };
    let mut seen = BTreeSet::new();
    let mut faults: Vec<String> = texts
        .iter()
        .filter(|text| seen.insert(&text.pieces))
        .filter(|text| !excepted(text) && !tested(text))
        .map(|text| format!("{}: no test shows `{}`", text.place, text.pieces.join(" … ")))
        .collect();
    for (piece, reason) in exceptions {
        let still = texts.iter().any(|t| t.pieces.iter().any(|p| p.contains(piece)));
        if !still || reason.is_empty() {
            faults.push(format!("the exception `{piece}` belongs to no text, or has no reason"));
        }
    }
    faults
}

fn says_enough(evidence: &str) -> bool {
    evidence.chars().count() >= SHORTEST_EVIDENCE && evidence.contains(' ')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_text_that_a_user_can_meet_is_in_a_test() {
        let workspace = Workspace::find().unwrap();
        assert_eq!(faults(&workspace).unwrap(), Vec::<String>::new());
    }

    fn found(texts: &[&str], evidence: &[&str], exceptions: &[(&str, &str)]) -> Vec<String> {
        let texts: Vec<Text> = texts.iter().filter_map(|t| of_user("here", t)).collect();
        let evidence: Vec<String> = evidence.iter().map(|e| (*e).to_owned()).collect();
        untested(&texts, &evidence, exceptions)
    }

    #[test]
    fn a_text_is_tested_by_its_longest_piece_or_by_words_of_its_own() {
        let text = "the box {name} is far too small for {{it}}, found {0}";
        assert_eq!(
            found(&[text], &["the box gas is far too small for {it}, found 3"], &[]).len(),
            0
        );
        let piece = "is far too small for {it}, found";
        assert_eq!(found(&[text], &[piece], &[]).len(), 0);
        assert_eq!(found(&[text], &["far too small"], &[]).len(), 0);
        for too_little in ["small", "too sm", "the sphere is far too large", ""] {
            assert_eq!(found(&[text], &[too_little], &[]).len(), 1, "{too_little}");
        }
    }

    #[test]
    fn words_that_stand_in_two_texts_show_neither() {
        let texts = ["the box is far too small", "the skin is far too small"];
        assert_eq!(found(&texts, &["is far too small"], &[]).len(), 2);
        assert_eq!(found(&texts, &["the box is far"], &[]).len(), 1);
    }

    #[test]
    fn what_only_puts_others_together_needs_no_test_and_exceptions_need_a_text_and_a_reason() {
        assert_eq!(found(&["{file}: {problem}{}"], &[], &[]).len(), 0);
        let text = ["this can never happen"];
        assert_eq!(found(&text, &[], &[("can never happen", "it is never made")]).len(), 0);
        assert_eq!(found(&text, &[], &[("can never happen", "")]).len(), 1);
        assert_eq!(found(&text, &["this can never happen"], &[("gone", "was there")]).len(), 1);
    }
}
