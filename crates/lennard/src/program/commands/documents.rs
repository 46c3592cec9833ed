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
const DATE: &str = "2026-11-27";

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
    std::fs::write(folder.join(man.get_filename()), with_examples(&text))
}

/// The page with its examples under their name, as they are typed.
fn with_examples(page: &str) -> String {
    let Some((before, rest)) = page.split_once(".SH EXTRA\n") else {
        return page.to_owned();
    };
    let end = rest.find(".SH").unwrap_or(rest.len());
    let (examples, after) = rest.split_at(end);
    format!("{before}.SH EXAMPLES\n.nf\n{examples}.fi\n{after}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_page_has_a_title_a_date_and_examples_as_they_are_typed() {
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
            let head = format!(".TH {title} 1 {DATE} \"lennard {version}\" Lennard");
            assert!(text.contains(&head), "{text}");
            let (_, examples) = text.split_once(".SH EXAMPLES\n.nf\n").expect("three examples");
            assert!(examples.contains("\n  lennard") && examples.contains(".fi\n.SH"), "{text}");
        }
    }
}
