//! What shells, readers and editors want of the program: completions, man pages and the schema of a scene.

use std::io;
use std::path::Path;

use clap::{Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;

use crate::program::args::Cli;
use crate::program::commands::print_json;
use crate::program::failure::{DONE, Failure, OTHER};

/// The day of the last change to a command; readers of man pages want one.
const DATE: &str = "2026-11-26";
/// The longest line of source, bytes: readers of man pages complain of longer ones.
const LONGEST: usize = 80;
/// The section whose lines keep their breaks and blanks.
const EXAMPLES: &str = ".SH EXTRA";

/// `lennard generate completions`.
pub fn completions(shell: Shell) -> Result<u8, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "lennard", &mut script);
    crate::program::out::text(&String::from_utf8_lossy(&script));
    Ok(DONE)
}

/// `lennard generate man`: a page for the program and one for each command and group of commands.
pub fn man(folder: &Path) -> Result<u8, Failure> {
    write(folder).map_err(|error| {
        let place = folder.display();
        Failure::new("writing man pages", format!("{place}: {error}"), OTHER)
    })?;
    println!("man pages in {}", folder.display());
    Ok(DONE)
}

/// `lennard generate schema`.
pub fn schema() -> Result<u8, Failure> {
    print_json(&lennard_scene::schema())?;
    Ok(DONE)
}

/// Writes man pages to a folder, which is made where it is missing.
fn write(folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    pages(program, folder)
}

/// The page of a command, and the pages of the commands below it.
fn pages(command: Command, folder: &Path) -> io::Result<()> {
    for below in command.get_subcommands() {
        pages(below.clone(), folder)?;
    }
    let name = command.get_display_name().unwrap_or(command.get_name());
    let title = name.to_uppercase();
    let source = format!("lennard {}", command.get_version().unwrap_or_default());
    let man = Man::new(command).title(title).date(DATE).source(source).manual("Lennard");
    let mut text = Vec::new();
    man.render(&mut text)?;
    let text = String::from_utf8(text).map_err(io::Error::other)?;
    std::fs::write(folder.join(man.get_filename()), tidy(&text))
}

/// The page with short lines of source, without blanks at their ends, and with examples as they are typed.
fn tidy(page: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    let mut literal = false;
    for line in page.lines().map(str::trim_end) {
        if line.starts_with(".SH") {
            if literal {
                lines.push(".fi".into());
            }
            literal = line == EXAMPLES;
            lines.push(if literal { ".SH EXAMPLES" } else { line }.into());
            if literal {
                lines.push(".nf".into());
            }
        } else if literal || line.starts_with('.') {
            // An empty line above is a break already.
            if line != ".br" || lines.last().is_none_or(|last| !last.is_empty()) {
                lines.push(line.into());
            }
        } else {
            if line.is_empty() && lines.last().is_some_and(|last| last == ".br") {
                lines.pop();
            }
            lines.extend(filled(line));
        }
    }
    if literal {
        lines.push(".fi".into());
    }
    lines.join("\n") + "\n"
}

/// Bytes of a word as readers count them: a letter outside ASCII becomes `\[u03B5]`.
fn length(word: &str) -> usize {
    let bytes = |c: char| if c.is_ascii() { 1 } else { 8 };
    word.chars().map(bytes).sum()
}

/// A line in lines of at most [`LONGEST`] bytes where its words allow it.
fn filled(line: &str) -> Vec<String> {
    let mut filled = vec![String::new()];
    for word in line.split(' ') {
        let last = filled.last_mut().expect("one at least");
        // A point or an apostrophe at the begin of a line would be a command.
        let starts = !word.starts_with(['.', '\'']) && !word.is_empty();
        if last.is_empty() {
            last.push_str(word);
        } else if length(last) + 1 + length(word) > LONGEST && starts {
            filled.push(word.into());
        } else {
            last.push(' ');
            last.push_str(word);
        }
    }
    filled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_short_and_examples_stay_as_they_are_typed() {
        let long = "word ".repeat(30);
        let page = format!(
            ".TH X 1 \n.SH NAME\n{long}.toml\n.SH EXTRA\n  typed   {long}\n.SH VERSION\nv1\n.br\n\n.br\nend\n"
        );
        let tidied = tidy(&page);
        let (before, examples) = tidied.split_once(".nf\n").unwrap();
        assert!(before.starts_with(".TH X 1\n"), "{before}");
        assert!(before.ends_with("word .toml\n.SH EXAMPLES\n"), "{before}");
        assert!(before.lines().all(|l| length(l) <= LONGEST), "{before}");
        assert_eq!(before.matches("word").count(), 30);
        let end = ".fi\n.SH VERSION\nv1\n\nend\n";
        assert_eq!(examples, format!("  typed   {}\n{end}", long.trim_end()));
    }

    #[test]
    fn every_page_has_a_title_a_date_and_no_line_that_readers_complain_of() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path()).unwrap();
        let pages: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
        assert!(pages.len() > 15);
        for page in pages {
            let page = page.unwrap();
            let text = std::fs::read_to_string(page.path()).unwrap();
            let name = page.file_name().into_string().unwrap();
            let title = name.trim_end_matches(".1").to_uppercase();
            let version = env!("CARGO_PKG_VERSION");
            let head = format!(".TH {title} 1 {DATE} \"lennard {version}\" Lennard\n");
            assert!(text.contains(&head), "{text}");
            let (body, _) = text.split_once(".nf\n").unwrap_or((&text, ""));
            assert!(body.lines().all(|l| length(l) <= LONGEST), "{name}: {body}");
            assert!(text.lines().all(|l| l.trim_end() == l), "{name}: {text}");
        }
    }
}
