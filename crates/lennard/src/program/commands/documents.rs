//! What shells, readers and editors want of the program: completions, man pages and the schema of a scene.

use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::program::args::Cli;
use crate::program::commands::print_json;
use crate::program::failure::{DONE, Failure, OTHER};

/// `lennard completions`.
pub fn completions(shell: Shell) -> Result<u8, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "lennard", &mut script);
    crate::program::out::text(&String::from_utf8_lossy(&script));
    Ok(DONE)
}

/// `lennard man`: a page for the program and one for each command.
pub fn man(folder: &Path) -> Result<u8, Failure> {
    crate::program::man::write(folder).map_err(|error| {
        let place = folder.display();
        Failure::new("writing man pages", format!("{place}: {error}"), OTHER)
    })?;
    println!("man pages in {}", folder.display());
    Ok(DONE)
}

/// `lennard schema`.
pub fn schema() -> Result<u8, Failure> {
    print_json(&lennard_scene::schema())?;
    Ok(DONE)
}
