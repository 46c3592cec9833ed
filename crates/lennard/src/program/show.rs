//! What a person reads: blocks of a page, as a terminal prints them.
//!
//! A command returns the blocks that it has to say. [`print`] writes them, and `report` writes the same type as HTML.

mod chart;
mod list;
mod literature;
mod plan;
mod run;
mod tables;
mod text;
mod tune;

pub use chart::chart;
pub use list::{entry, list};
pub use literature::{compared, sweep, sweep_header};
pub use plan::plan;
pub use run::{energy, header, results};
pub use tables::Style;
pub use tune::tuning;

use std::path::Path;

use lennard_studies::report::{Block, Page, Section};

use text::wrapped;

use crate::program::out;

/// Prints a section: its title and its headings in bold type, texts in lines that fit, tables in a style. A terminal shows no
/// figures.
pub fn print(section: &Section, style: Style) {
    if !section.title.is_empty() {
        out::heading(&section.title);
    }
    for block in &section.blocks {
        match block {
            Block::Heading(text) => wrapped(text).into_iter().for_each(out::heading),
            Block::Text(text) | Block::Remark(text) => note(text),
            Block::List(lines) => lines.iter().for_each(|line| note(line)),
            Block::Equations(lines) => lines.iter().for_each(|line| println!("    {line}")),
            Block::Table(table) => println!("{}", style.of(table)),
            Block::Figures(_) => {}
        }
    }
}

/// Prints what a page says first: its title, its lead and its brief sections.
pub fn page(page: &Page, folder: &Path) {
    print(&Section::new(&page.title).text(&page.lead), Style::Open);
    for section in &page.sections {
        let Some(without) = section.brief else {
            continue;
        };
        let mut brief = section.clone();
        for block in &mut brief.blocks {
            if let Block::Table(table) = block {
                *table = table.clone().without(without);
            }
        }
        print(&brief, Style::Open);
    }
    note(&format!("page: {}", folder.join("report.html").display()));
}

/// Prints a text in lines that fit the terminal; an empty one is an empty line.
fn note(text: &str) {
    for line in wrapped(&text.replace("**", "")) {
        println!("{}", line.trim_end());
    }
}
