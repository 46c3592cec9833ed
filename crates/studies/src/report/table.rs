//! Tables for readers: on a page, or as texts for a terminal.

use lennard_core::number::{plain_or_scientific, plus_minus, significant, with_error};
use lennard_observables::{Cell, Column, Table, Tone, Value};

use crate::report::escape::{escape, inline_markup, made_by};

/// Columns that stand side by side on any screen.
const MOST_SIDE_BY_SIDE: usize = 2;
/// Characters from which a text counts as long.
const LONG_TEXT: usize = 32;

/// How a number with its standard error is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorStyle {
    /// `−5.4812(13)`.
    Brackets,
    /// `-5.4812 ± 0.0013`.
    PlusMinus,
}

/// The heading of a column: its name, and its unit after a stroke.
#[must_use]
pub fn heading(column: &Column) -> String {
    if column.unit.is_empty() {
        column.name.clone()
    } else {
        format!("{} / {}", column.name, column.unit)
    }
}

/// A cell as a reader sees it.
#[must_use]
pub fn cell_text(cell: &Cell, errors: ErrorStyle) -> String {
    let of_figures = |text: &str| match errors {
        ErrorStyle::Brackets => true_minus(text),
        ErrorStyle::PlusMinus => text.to_owned(),
    };
    match &cell.value {
        Value::Missing => "–".into(),
        Value::Words(text) => text.clone(),
        Value::Figures(text) => of_figures(text),
        Value::Whole(value) => of_figures(&value.to_string()),
        Value::Number { value, digits } => match digits {
            Some(digits) => significant(*value, *digits),
            None => plain_or_scientific(*value),
        },
        Value::Measured { value, error } => match errors {
            ErrorStyle::Brackets => with_error(*value, *error),
            ErrorStyle::PlusMinus => plus_minus(*value, *error),
        },
    }
}

/// Figures with a minus sign before each negative number, in place of a hyphen.
fn true_minus(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let begins_number = c == '-'
            && !written.ends_with(char::is_alphanumeric)
            && rest.peek().is_some_and(char::is_ascii_digit);
        written.push(if begins_number { '−' } else { c });
    }
    written
}

/// Whether a column stands on the right: any of its cells is numeric, or all are missing.
#[must_use]
pub fn is_numeric(column: &Column) -> bool {
    let is_missing = |cell: &Cell| cell.value == Value::Missing;
    column.cells.iter().any(|c| c.value.is_numeric()) || column.cells.iter().all(is_missing)
}

/// The table as a figure of a page, with the command that made it.
pub(crate) fn to_html(table: &Table, command: Option<&str>) -> String {
    // On a narrow screen a row of many cells becomes a line of names and values.
    let stacks = table.columns.len() > MOST_SIDE_BY_SIDE;
    let class_of_table = if stacks { " class=\"stacks\"" } else { "" };
    let mut html = format!(
        "<figure class=\"table\">\n<div class=\"scroll\" tabindex=\"0\"><table{class_of_table}>\n<thead><tr>"
    );
    for column in &table.columns {
        let class = if is_numeric(column) { " class=\"number\"" } else { "" };
        html.push_str(&format!(
            "<th scope=\"col\"{class}>{}</th>",
            inline_markup(&heading(column))
        ));
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    for row in 0..table.rows() {
        html.push_str("<tr>");
        for (cell, column) in table.row(row).zip(&table.columns) {
            let text = cell_text(&cell, ErrorStyle::Brackets);
            let name = match stacks {
                true => format!(" data-name=\"{}\"", escape(&heading(column))),
                false => String::new(),
            };
            html.push_str(&format!(
                "<td{}{name}>{}</td>",
                class(&cell, &text, is_numeric(column)),
                inline_markup(&text)
            ));
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody>\n</table></div>\n");
    let caption = inline_markup(&table.caption) + &made_by(command, None);
    if !caption.is_empty() {
        html.push_str(&format!("<figcaption>{caption}</figcaption>\n"));
    }
    html + "</figure>\n"
}

/// The class of a cell: its tone, and where it stands.
fn class(cell: &Cell, text: &str, numeric_column: bool) -> String {
    let tone = match cell.tone {
        Tone::Plain => None,
        Tone::Good => Some("good"),
        Tone::Bad => Some("bad"),
        Tone::Careful => Some("careful"),
        Tone::Faint => Some("faint"),
    };
    let is_words = matches!(cell.value, Value::Words(_));
    let place = if numeric_column && !is_words {
        Some("number")
    } else {
        // A long text keeps a readable width: the table scrolls in its own box instead.
        (tone.is_none() && text.chars().count() > LONG_TEXT).then_some("long")
    };
    let missing = (cell.value == Value::Missing).then_some("missing");
    let classes: Vec<&str> = place.into_iter().chain(tone).chain(missing).collect();
    if classes.is_empty() { String::new() } else { format!(" class=\"{}\"", classes.join(" ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_and_a_terminal_show_the_same_cells_in_their_own_way() {
        let texts = |cell: Cell| {
            [ErrorStyle::Brackets, ErrorStyle::PlusMinus].map(|style| cell_text(&cell, style))
        };
        assert_eq!(texts(Cell::default()), ["–", "–"]);
        assert_eq!(texts(Cell::rounded(0.123_456, 3)), ["0.123", "0.123"]);
        assert_eq!(texts(864_u64.into()), ["864", "864"]);
        assert_eq!(texts(Cell::measured(-5.481_23, 0.001_27)), ["−5.4812(13)", "−5.4812 ± 0.0013"]);
        assert_eq!(texts(Cell::figures("-4.3")), ["−4.3", "-4.3"]);
        assert_eq!(texts(Cell::figures("3-5 at -1e-7")).first().unwrap(), "3-5 at −1e-7");
    }

    #[test]
    fn a_column_with_a_number_stands_on_the_right_and_tones_are_classes() {
        let items = [(Some(1.5), Tone::Good), (None, Tone::Plain)];
        let table = Table::rows_of("t", &items)
            .column("x [σ]", |i| Cell::rounded(i.0, 2).toned(i.1))
            .column("fate", |i| Cell::words(if i.0.is_some() { "bounded" } else { "diverges" }))
            .table();
        let html = to_html(&table, None);
        for text in [
            "<th scope=\"col\" class=\"number\">x / σ</th><th scope=\"col\">fate</th>",
            "<td class=\"number good\">1.5</td><td>bounded</td>",
            "<td class=\"number missing\">–</td><td>diverges</td>",
        ] {
            assert!(html.contains(text), "{text} in\n{html}");
        }
    }
}
