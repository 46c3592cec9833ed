//! Tables for terminals.

use comfy_table::presets::{NOTHING, UTF8_BORDERS_ONLY, UTF8_FULL_CONDENSED};
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Width};
use lennard_observables::Table;
use lennard_studies::report::{ErrorStyle, cell_text, heading, is_numeric};

use super::text::WIDTH;

/// How tables are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// With a line between all columns.
    Ruled,
    /// Without them, and in lines that fit.
    Open,
    /// In lines that fit, with errors in brackets.
    Narrow,
    /// Names with what they are, without headings.
    Names,
}

impl Style {
    /// A table as text.
    pub(super) fn of(self, shown: &Table) -> String {
        match self {
            Self::Ruled => table(shown).to_string(),
            Self::Open => {
                let mut open = table(shown);
                if !keep_numbers_whole(&mut open, shown) {
                    return Self::Narrow.of(shown);
                }
                open.load_style(UTF8_BORDERS_ONLY).set_width(WIDTH);
                // A hyphen begins a number; elsewhere it joins words.
                open.to_string().replace(" -", " −")
            }
            Self::Narrow => narrow_table(shown).to_string(),
            Self::Names => names(shown),
        }
    }
}

/// Lines without rules. Names stay whole: they are typed again.
fn names(table: &Table) -> String {
    let mut shown = comfy_table::Table::new();
    shown.load_style(NOTHING).set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    let texts = |row| table.row(row).map(|cell| cell_text(&cell, ErrorStyle::PlusMinus));
    let mut longest = 0;
    for row in 0..table.rows() {
        longest = longest.max(texts(row).next().map_or(0, |name| name.chars().count()));
        shown.add_row(texts(row));
    }
    let width = Width::Fixed(u16::try_from(longest + 2).unwrap_or(WIDTH / 2));
    if let Some(names) = shown.column_mut(0) {
        names.set_constraint(ColumnConstraint::Absolute(width));
    }
    let shown = shown.to_string();
    shown.lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
}

/// A table that fits the terminal.
fn table(table: &Table) -> comfy_table::Table {
    styled(table, ErrorStyle::PlusMinus)
}

/// A table of at most [`WIDTH`] columns, with errors in brackets. Where it can, its last column alone takes several lines.
fn narrow_table(table: &Table) -> comfy_table::Table {
    let mut shown = styled(table, ErrorStyle::Brackets);
    shown.load_style(UTF8_BORDERS_ONLY).set_width(WIDTH);
    for column in shown.column_iter_mut().skip(1) {
        column.set_padding((0, 1));
    }
    if leaves_room(&shown) {
        let figures = table.columns.len().saturating_sub(1);
        for column in shown.column_iter_mut().take(figures) {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    } else {
        keep_words_whole(&mut shown, table);
    }
    shown
}

/// Below this width a column of words is hard to read.
const NARROWEST: u16 = 14;

/// Keeps numbers with their errors in one line; `false` where they leave no room for columns of words.
fn keep_numbers_whole(shown: &mut comfy_table::Table, table: &Table) -> bool {
    let widths = shown.column_max_content_widths();
    let needed = widths
        .iter()
        .zip(&table.columns)
        .map(|(width, column)| if is_numeric(column) { *width } else { NARROWEST.min(*width) });
    let spaces = 2 * widths.len() as u16 + 2;
    let fit = needed.sum::<u16>() + spaces <= WIDTH;
    for (column, shown) in table.columns.iter().zip(shown.column_iter_mut()) {
        if fit && is_numeric(column) {
            shown.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    fit
}

/// Whether all columns but the last leave room for words in the last.
fn leaves_room(shown: &comfy_table::Table) -> bool {
    let widths = shown.column_max_content_widths();
    let spaces = 2 * widths.len() as u16 + 2;
    widths.iter().rev().skip(1).sum::<u16>() + spaces + NARROWEST <= WIDTH
}

/// Makes each column as wide as its longest word, where there is room for that.
fn keep_words_whole(shown: &mut comfy_table::Table, table: &Table) {
    let longest = |text: &str| {
        let words = text.split_whitespace().map(console::measure_text_width);
        words.max().unwrap_or(0) as u16
    };
    let mut widths: Vec<u16> = table.columns.iter().map(|c| longest(&heading(c))).collect();
    for row in 0..table.rows() {
        for (width, cell) in widths.iter_mut().zip(table.row(row)) {
            *width = longest(&cell_text(&cell, ErrorStyle::Brackets)).max(*width);
        }
    }
    // Spaces beside each column, and the borders.
    let spaces = widths.len() as u16 + 1;
    if widths.iter().sum::<u16>() + spaces + 2 > WIDTH {
        return;
    }
    for (k, (column, width)) in shown.column_iter_mut().zip(widths).enumerate() {
        let padding = if k == 0 { 2 } else { 1 };
        column.set_constraint(ColumnConstraint::LowerBoundary(Width::Fixed(width + padding)));
    }
}

fn styled(table: &Table, errors: ErrorStyle) -> comfy_table::Table {
    let mut shown = comfy_table::Table::new();
    shown
        .load_style(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_header(table.columns.iter().map(heading));
    // Output that no terminal shows has no width.
    if let Some((_, columns)) = console::Term::stdout().size_checked() {
        shown.set_width(columns);
    }
    for row in 0..table.rows() {
        let cells = table.row(row);
        shown.add_row(cells.map(|cell| cell_text(&cell, errors)));
    }
    for (column, shown) in table.columns.iter().zip(shown.column_iter_mut()) {
        if is_numeric(column) {
            shown.set_cell_alignment(CellAlignment::Right);
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_that_is_too_wide_breaks_between_words_alone() {
        let headings = ["Quantity", "Points judged", "Largest standard error", "p"];
        let mut rows = Table::rows_of("wide", &["configurational temperature"; 2])
            .column("Quantity", |name| *name);
        for heading in &headings[1..] {
            rows = rows.column(heading, |_| "a sentence of words that are short");
        }
        let shown = narrow_table(&rows.table()).to_string();
        assert!(shown.contains("configurational"), "{shown}");
        let widest = shown.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(usize::from(WIDTH)), "{shown}");
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
