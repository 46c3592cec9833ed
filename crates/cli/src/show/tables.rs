//! Tables for terminals.

use comfy_table::presets::{UTF8_BORDERS_ONLY, UTF8_FULL_CONDENSED};
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement};
use lennard_core::Table;
use lennard_report::{ErrorStyle, cell_text, heading, is_numeric};

use super::WIDTH;

/// A table that fits the terminal.
pub(super) fn table(table: &Table) -> comfy_table::Table {
    styled(table, ErrorStyle::PlusMinus)
}

/// A table of at most [`WIDTH`] columns, with errors in brackets. Where it can, its last column alone takes several lines.
pub(super) fn narrow_table(table: &Table) -> comfy_table::Table {
    /// Below this width a column of words is hard to read.
    const NARROWEST: u16 = 14;
    let mut shown = styled(table, ErrorStyle::Brackets);
    shown.load_style(UTF8_BORDERS_ONLY).set_width(WIDTH);
    for column in shown.column_iter_mut().skip(1) {
        column.set_padding((0, 1));
    }
    let widths = shown.column_max_content_widths();
    let (spaces, figures) = (2 * widths.len() + 2, widths.len().saturating_sub(1));
    let all = widths.iter().take(figures).sum::<u16>() + spaces as u16;
    if all + NARROWEST <= WIDTH {
        for column in shown.column_iter_mut().take(figures) {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    shown
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
