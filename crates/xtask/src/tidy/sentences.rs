//! Sentences that a reader understands at once: short, and with nouns.
//!
//! The check reads comments of sources and paragraphs of documents. A sentence is at fault where it has too many words,
//! or a word in place of a noun.
//! The check cannot see texts in quotes, tables, code, comments behind code, or a riddle in short words.

use std::error::Error;

use crate::workspace::Workspace;

/// The most words of a sentence.
const MOST_WORDS: usize = 25;

/// Words in place of a noun, split so that the check does not find itself.
const WITHOUT_NOUN: [&str; 6] = [
    concat!("those", " of"),
    concat!("that", " of"),
    concat!("some", "body"),
    concat!("no", "body"),
    concat!("any", "body"),
    concat!("every", "body"),
];

/// Documents that programs write.
const NOT_OURS: [&str; 2] = ["benches/results/", "validation/results/"];

/// The sentences at fault of all sources and documents that git does not ignore.
pub fn faults(workspace: &Workspace) -> Result<Vec<String>, Box<dyn Error>> {
    let mut faults = Vec::new();
    for name in workspace.tracked(&["*.rs", "*.md"])? {
        // A file that is deleted and still tracked has no sentences.
        let Ok(text) = std::fs::read_to_string(workspace.root.join(&name)) else {
            continue;
        };
        if !NOT_OURS.iter().any(|folder| name.starts_with(folder)) {
            faults.extend(at_fault(&name, &text));
        }
    }
    Ok(faults)
}

/// The sentences at fault of one file, each with the line of its paragraph and the reason.
fn at_fault(name: &str, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    for (line, paragraph) in paragraphs(text, name.ends_with(".rs")) {
        for sentence in sentences(&paragraph) {
            let reason = match (words_in(sentence), without_noun(sentence)) {
                (_, Some(word)) => format!("`{word}` stands for a noun"),
                (words, None) if words > MOST_WORDS => format!("{words} words"),
                _ => continue,
            };
            faults.push(format!("{name}:{line}: {reason}: {sentence}"));
        }
    }
    faults
}

/// Prose with the line on which it begins: runs of comment lines of a source, or of lines of a document.
fn paragraphs(text: &str, is_source: bool) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let (mut is_fenced, mut is_open) = (false, false);
    for (number, original) in (1..).zip(text.lines()) {
        let line = original.trim();
        let prose = match (is_source, line.strip_prefix("//")) {
            (true, comment) => comment.unwrap_or_default().trim_start_matches(['/', '!']).trim(),
            (false, _) => line,
        };
        let is_fence = prose.starts_with("```");
        is_fenced ^= is_fence;
        let is_indented = !is_source && !is_open && original.starts_with("    ");
        if is_fence || is_fenced || is_indented || prose.is_empty() || prose.starts_with(['|', '#'])
        {
            is_open = false;
            continue;
        }
        let numbered = prose.trim_start_matches(|c: char| c.is_ascii_digit());
        let item = ["- ", "* "]
            .iter()
            .find_map(|mark| prose.strip_prefix(mark))
            .or_else(|| numbered.strip_prefix(". ").filter(|_| numbered != prose));
        match (item, found.last_mut()) {
            (None, Some((_, paragraph))) if is_open => {
                paragraph.push(' ');
                paragraph.push_str(prose);
            }
            _ => found.push((number, item.unwrap_or(prose).to_owned())),
        }
        is_open = true;
    }
    found
}

/// A paragraph cut behind `.`, `!` and `?` with a space, and behind `:` and `;` before a word that begins a sentence.
fn sentences(paragraph: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut start = 0;
    for (at, mark) in paragraph.match_indices(['.', '!', '?', ':', ';']) {
        let (end, rest) = (at + mark.len(), &paragraph[at + mark.len()..]);
        let begins = |c: char| c.is_uppercase() || "`[(".contains(c);
        let is_end = matches!(mark, "." | "!" | "?") || rest.trim_start().starts_with(begins);
        if rest.starts_with(' ') && is_end {
            found.push(paragraph[start..end].trim());
            start = end;
        }
    }
    found.push(paragraph[start..].trim());
    found
}

/// Words are letters, two at least or an article: symbols and numbers of an equation do not count.
/// Code in backticks is one word, and the target of a link is none.
fn words_in(sentence: &str) -> usize {
    let is_word = |word: &&str| {
        let letters = word.chars().filter(|c| c.is_alphabetic()).count();
        letters > 1 || ["a", "A", "I"].contains(word)
    };
    let within = |c: char| c.is_alphabetic() || "'’-".contains(c);
    let words = |text: &str| text.split(|c| !within(c)).filter(is_word).count();
    let prose: usize =
        sentence.split('`').step_by(2).map(|text| words(&without_targets(text))).sum();
    prose + sentence.matches('`').count() / 2
}

/// The text without the targets of links.
fn without_targets(text: &str) -> String {
    let mut pieces = text.split("](");
    let mut kept = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        kept.push_str(piece.split_once(')').map_or(piece, |(_, rest)| rest));
    }
    kept
}

/// The first word of a sentence that stands for a noun.
fn without_noun(sentence: &str) -> Option<&'static str> {
    let lower = sentence.to_lowercase();
    let mut words = WITHOUT_NOUN.into_iter();
    words.find(|word| {
        lower.match_indices(word).any(|(at, _)| {
            let before = lower[..at].ends_with(char::is_alphabetic);
            let after = lower[at + word.len()..].starts_with(char::is_alphabetic);
            !before && !after
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_is_too_long_one_word_beyond_the_limit() {
        let words = |n: usize| format!("/// {}.\n", vec!["word"; n].join(" "));
        assert_eq!(at_fault("a.rs", &words(MOST_WORDS)), Vec::<String>::new());
        let fault = at_fault("a.rs", &words(MOST_WORDS + 1));
        assert_eq!(fault.len(), 1);
        assert!(fault[0].contains("a.rs:1: 26 words: word word"), "{fault:?}");
    }

    #[test]
    fn equations_and_ends_of_sentences_do_not_make_a_sentence_longer() {
        let half = vec!["word"; MOST_WORDS].join(" ");
        for fine in [
            format!("/// {half}. {half}\n"),
            format!("/// {half}: `{}`\n", vec!["x = 3 + 1"; 30].join(" ")),
            format!("/// {half}\n\n/// {half}\n"),
            format!("/// - {half}\n/// - {half}\n"),
            format!("/// 1. {half}\n/// 2. {half}\n"),
            format!("/// [{half}](a/long/path/to/a/file.rs)\n"),
            format!("/// ```\n/// {half} {half}\n/// ```\n"),
            format!("let x = 1;\n{half} {half}\n"),
        ] {
            assert_eq!(at_fault("a.rs", &fine), Vec::<String>::new());
        }
        assert_eq!(at_fault("a.md", &format!("{half}\n{half}\n")).len(), 1);
        let code = format!("    {half} {half}\n");
        assert_eq!(at_fault("a.md", &code), Vec::<String>::new());
    }

    #[test]
    fn words_in_place_of_a_noun_are_found_and_parts_of_words_are_not() {
        for word in WITHOUT_NOUN {
            let fault = at_fault("a.md", &format!("The line.\n\nThe mass is {word} argon.\n"));
            assert_eq!(fault.len(), 1, "{word}");
            assert!(fault[0].contains("a.md:3:"), "{fault:?}");
        }
        assert!(at_fault("a.md", "We know that often it rains.\n").is_empty());
    }
}
