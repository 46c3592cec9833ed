//! What a person reads: blocks of a page, as a terminal prints them.
//!
//! A command returns the blocks that it has to say. [`print`] writes them, and `report` writes the same type as HTML.

mod bench;
mod chart;
mod eos;
mod list;
mod literature;
mod plan;
mod run;
mod tables;
mod tune;

pub use bench::bench;
pub use chart::chart;
pub use eos::{coexistence, curve, freezing, state};
pub use list::{entry, list};
pub use literature::{compared, sweep, sweep_header};
pub use plan::plan;
pub use run::{energy, header, results};
pub use tables::Style;
pub use tune::tuning;

use std::path::Path;

use lennard_studies::report::{Block, Page, Section};

use tables::{narrow_table, table};

use crate::program::out;

/// Columns of a terminal for which tables are made, and of output that no terminal shows.
const WIDTH: u16 = 100;

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

/// Lines of at most [`WIDTH`] columns: the first stands two columns to the right, the others four.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::from(" ");
    for word in text.split(' ') {
        let width = line.chars().count() + 1 + word.chars().count();
        if width > usize::from(WIDTH) && !line.trim().is_empty() {
            lines.push(std::mem::replace(&mut line, String::from("   ")));
        }
        line.push(' ');
        line.push_str(word);
    }
    lines.push(line);
    lines
}

/// Wall time in words.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.1} µs", s * 1e6),
        s if s < 1.0 => format!("{:.1} ms", s * 1e3),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.1} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// Bytes in words.
fn bytes(n: u64) -> String {
    match n as f64 {
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.2} GB", b / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use lennard_core::Table;

    use super::*;

    #[test]
    fn notes_are_wrapped_between_words() {
        let lines = wrapped(&["word"; 40].join(" "));
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|l| l.chars().count() <= 100), "{lines:?}");
        assert!(lines[0].starts_with("  word") && lines[1].starts_with("    word"));
        let long = "x".repeat(200);
        assert_eq!(wrapped(&long), [format!("  {long}")]);
    }

    #[test]
    fn numbers_stand_on_the_right_and_errors_beside_them() {
        let items = [("a", Some((1.5, 0.25))), ("longer", None)];
        let items =
            Table::rows_of("t", &items).column("name", |i| i.0).measured("x [σ]", |i| i.1).table();
        let text = table(&items).to_string();
        for line in
            ["│ name   ┆       x / σ │", "│ a      ┆ 1.50 ± 0.25 │", "│ longer ┆           – │"]
        {
            assert!(text.contains(line), "{line} in\n{text}");
        }
    }
}
