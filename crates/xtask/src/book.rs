//! `cargo xtask docs`: the pages of docs/ and a few others as a book in `target/book/site`.
//!
//! Pages of commands and of methods are asked of the program, so that they say what it does.

mod links;
mod lists;
mod page;

use std::error::Error;
use std::fs;

use page::Page;

use crate::python::Environment;
use crate::workspace::Workspace;

/// The engine with everything that it needs, at one version each.
const REQUIREMENTS: &str = "docs/requirements.txt";
/// Title, theme and order of the pages.
const SETTINGS: &str = "docs/zensical.toml";
/// Documents outside docs/ that are pages too: where they lie, and what they are called in the book.
const PAGES: &[(&str, &str)] = &[
    ("README.md", "index.md"),
    ("CHANGELOG.md", "changelog.md"),
    ("CONTRIBUTING.md", "contributing.md"),
    ("benches/NOTES.md", "measurements.md"),
    ("inputs/README.md", "scenes.md"),
    ("validation/README.md", "judges.md"),
];

/// Writes the pages and builds the book.
pub fn build(workspace: &Workspace) -> Result<(), Box<dyn Error>> {
    let folder = workspace.target.join("book");
    let pages = pages(workspace)?;
    let settings = fs::read_to_string(workspace.root.join(SETTINGS))?;
    let lost = pages.iter().find(|page| page.is_document() && !page.is_in(&settings));
    if let Some(page) = lost {
        return Err(format!("{SETTINGS}: `nav` has no line for {}", page.target).into());
    }
    let written = folder.join("pages");
    if written.exists() {
        fs::remove_dir_all(&written)?;
    }
    for page in &pages {
        let target = written.join(&page.target);
        if let Some(parent) = target.parent() {
            fs::create_dir_all(parent)?;
        }
        let source = workspace.root.join(&page.source);
        if page.is_document() {
            let text = fs::read_to_string(&source).map_err(|e| format!("{}: {e}", page.source))?;
            fs::write(target, links::in_book(&text, page, &pages))?;
        } else {
            fs::copy(source, target)?;
        }
    }
    fs::write(written.join("commands.md"), lists::commands(workspace)?)?;
    fs::write(written.join("methods.md"), lists::methods(workspace)?)?;
    fs::write(folder.join("zensical.toml"), settings)?;
    let environment = Environment { folder: folder.join("venv"), requirements: REQUIREMENTS };
    environment.prepare(workspace)?;
    let status = workspace
        .command(environment.program("zensical"))
        .args(["build", "--clean", "--strict"])
        .current_dir(&folder)
        .status()?;
    if !status.success() {
        return Err("the book has faults: the lines above name them".into());
    }
    println!("book: {}", folder.join("site").join("index.html").display());
    Ok(())
}

/// Every page, figure and style.
fn pages(workspace: &Workspace) -> Result<Vec<Page>, Box<dyn Error>> {
    let docs = workspace.tracked(&["docs/*.md", "docs/*.svg", "docs/*.css"])?;
    let mut pages: Vec<Page> = docs
        .into_iter()
        .map(|source| Page { target: source["docs/".len()..].to_owned(), source })
        .collect();
    pages.extend(PAGES.iter().map(|(source, target)| Page {
        source: (*source).to_owned(),
        target: (*target).to_owned(),
    }));
    Ok(pages)
}
