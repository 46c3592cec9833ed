//! Tables of a page.

use lennard_core::Table;

use crate::escape::inline_markup;
use crate::number::plain_or_scientific;

/// Characters from which a text counts as long.
const LONG_TEXT: usize = 32;

/// What a cell says beyond its text.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Tone {
    /// Words.
    #[default]
    Plain,
    /// A number, aligned to the right.
    Number,
    /// Something that holds.
    Good,
    /// Something that does not hold.
    Bad,
    /// Something to be careful with.
    Careful,
}

/// A cell.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Cell {
    /// Its text, with inline markup.
    pub text: String,
    /// How it is shown.
    pub tone: Tone,
}

impl Cell {
    /// Words.
    #[must_use]
    pub fn text(text: impl Into<String>) -> Self {
        Self::toned(text, Tone::Plain)
    }

    /// A number, already written as text.
    #[must_use]
    pub fn number(text: impl Into<String>) -> Self {
        Self::toned(text, Tone::Number)
    }

    /// Text with a tone.
    #[must_use]
    pub fn toned(text: impl Into<String>, tone: Tone) -> Self {
        Self {
            text: text.into(),
            tone,
        }
    }
}

/// A table with a caption and the command that made it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PageTable {
    /// What it shows.
    pub caption: String,
    /// The command that makes it again.
    pub command: Option<String>,
    /// Headings.
    pub header: Vec<String>,
    /// Rows, each as long as the header.
    pub rows: Vec<Vec<Cell>>,
}

impl PageTable {
    /// A table of numbers as it stands in the CSV file, shortened for reading.
    #[must_use]
    pub fn from_table(table: &Table) -> Self {
        let rows = table
            .columns
            .iter()
            .map(|c| c.values.len())
            .max()
            .unwrap_or(0);
        Self {
            caption: table.caption.clone(),
            command: None,
            header: table
                .columns
                .iter()
                .map(|c| {
                    if c.unit.is_empty() {
                        c.name.clone()
                    } else {
                        format!("{} / {}", c.name, c.unit)
                    }
                })
                .collect(),
            rows: (0..rows)
                .map(|r| {
                    table
                        .columns
                        .iter()
                        .map(|c| match c.values.get(r) {
                            Some(v) => Cell::number(plain_or_scientific(*v)),
                            None => Cell::default(),
                        })
                        .collect()
                })
                .collect(),
        }
    }

    pub(crate) fn to_html(&self) -> String {
        let mut html = String::from(
            "<figure class=\"table\">\n<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>",
        );
        for (k, heading) in self.header.iter().enumerate() {
            // A heading stands where its numbers stand.
            let mut column = self.rows.iter().filter_map(|row| row.get(k));
            let class = if column.any(|cell| cell.tone == Tone::Number) {
                " class=\"number\""
            } else {
                ""
            };
            html.push_str(&format!(
                "<th scope=\"col\"{class}>{}</th>",
                inline_markup(heading)
            ));
        }
        html.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            html.push_str("<tr>");
            for cell in row {
                let class = match cell.tone {
                    // A long text keeps a readable width: the table scrolls in its own box instead.
                    Tone::Plain if cell.text.chars().count() > LONG_TEXT => " class=\"long\"",
                    Tone::Plain => "",
                    Tone::Number => " class=\"number\"",
                    Tone::Good => " class=\"good\"",
                    Tone::Bad => " class=\"bad\"",
                    Tone::Careful => " class=\"careful\"",
                };
                html.push_str(&format!("<td{class}>{}</td>", inline_markup(&cell.text)));
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody>\n</table></div>\n<figcaption>");
        html.push_str(&inline_markup(&self.caption));
        html.push_str(&crate::page::made_by(self.command.as_deref(), None));
        html.push_str("</figcaption>\n</figure>\n");
        html
    }
}
