//! The legend of a figure, and the one that figures of a row share.

use crate::report::escape::escape;
use crate::report::sheet::{
    AFTER, INK, LEGEND_ROW, LINE, MARK, Place, Sheet, TEXT, WIDTH, color, fitting, text_width,
};
use crate::report::{Figure, Look, Series};

/// Width of the sample in the legend, design units.
const SAMPLE: f64 = 34.0;
/// An entry of a legend.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    name: String,
    /// `None` for the cross of failed runs, whatever their color.
    look: Option<Look>,
    color: usize,
}

impl Entry {
    fn of(series: &Series) -> Self {
        Self { name: series.name.clone(), look: Some(series.look), color: series.color }
    }

    fn of_failures() -> Self {
        Self { name: "failed: no value".to_owned(), look: None, color: 0 }
    }

    /// Whether two entries say the same, be the marks joined by a line or not.
    fn is_like(&self, other: &Self) -> bool {
        let mark = |look: Option<Look>| match look {
            None | Some(Look::Line(_)) => None,
            Some(Look::Points(symbol) | Look::LineAndPoints(_, symbol)) => Some(symbol),
        };
        let [own, others] = [self, other].map(|e| (&e.name, e.color, mark(e.look)));
        own == others
    }

    fn sample(&self, sheet: &mut Sheet, (x, y): Place) {
        let (paint, middle) = (color(self.color), (x + 0.5 * SAMPLE - 3.0, y));
        let Some(look) = self.look else {
            return sheet.failure(middle, MARK, INK);
        };
        if let Look::Line(dash) | Look::LineAndPoints(dash, _) = look {
            sheet.line(&[(x, y), (x + SAMPLE - 6.0, y)], dash, paint, LINE);
        }
        if let Look::Points(symbol) | Look::LineAndPoints(_, symbol) = look {
            sheet.symbol(symbol, middle, paint);
        }
    }
}

/// The entries of a figure, each once.
fn entries(figure: &Figure) -> Vec<Entry> {
    let mut found: Vec<Entry> = Vec::new();
    let failures = figure.series.iter().any(|series| !series.failures.is_empty());
    let named = figure.series.iter().filter(|series| !series.name.is_empty()).map(Entry::of);
    for entry in named.chain(failures.then(Entry::of_failures)) {
        if !is_in(&entry, &found) {
            found.push(entry);
        }
    }
    found
}

fn is_in(entry: &Entry, entries: &[Entry]) -> bool {
    entries.iter().any(|known| known.is_like(entry))
}

/// The entries that several figures of a row have: they stand once, above the row.
pub(crate) fn shared<'a>(figures: impl Iterator<Item = &'a Figure>) -> Vec<Entry> {
    let (mut seen, mut shared) = (Vec::new(), Vec::new());
    for entry in figures.flat_map(entries) {
        if !is_in(&entry, &seen) {
            seen.push(entry);
        } else if !is_in(&entry, &shared) {
            shared.push(entry);
        }
    }
    shared
}

/// The entries of a figure that do not stand above its row.
pub(crate) fn own(figure: &Figure, shared: &[Entry]) -> Vec<Entry> {
    entries(figure).into_iter().filter(|entry| !is_in(entry, shared)).collect()
}

/// A legend of a page; nothing without entries.
pub(crate) fn to_html(entries: &[Entry]) -> String {
    if entries.is_empty() {
        return String::new();
    }
    let items: String = entries
        .iter()
        .map(|entry| {
            let mut sheet = Sheet::new(SAMPLE, LEGEND_ROW);
            entry.sample(&mut sheet, (3.0, 0.5 * LEGEND_ROW));
            format!("<li>{}{}</li>\n", sheet.finish().trim_end(), escape(&entry.name))
        })
        .collect();
    format!("<ul class=\"legend\">\n{items}</ul>\n")
}

/// The legend below the plot of a figure that is a file, in as many columns as the names allow.
pub(crate) struct Legend {
    entries: Vec<Entry>,
    columns: usize,
}

impl Legend {
    pub(crate) fn of(figure: &Figure) -> Self {
        let entries = entries(figure);
        let widest = entries.iter().map(|e| text_width(&e.name, TEXT)).fold(0.0, f64::max);
        let columns = ((WIDTH - 16.0) / (widest + SAMPLE + 8.0)).floor() as usize;
        Self { columns: columns.clamp(1, entries.len().max(1)), entries }
    }

    fn rows(&self) -> usize {
        self.entries.len().div_ceil(self.columns)
    }

    pub(crate) fn height(&self) -> f64 {
        self.rows() as f64 * LEGEND_ROW
    }

    pub(crate) fn draw(&self, sheet: &mut Sheet, top: f64) {
        let column_width = (WIDTH - 16.0) / self.columns as f64;
        for (i, entry) in self.entries.iter().enumerate() {
            let (column, row) = (i / self.rows(), i % self.rows());
            let x = 8.0 + column as f64 * column_width;
            let y = top + (row as f64 + 0.5) * LEGEND_ROW;
            entry.sample(sheet, (x, y));
            let height = fitting(&entry.name, TEXT, column_width - SAMPLE - 4.0);
            sheet.text(&entry.name, (x + SAMPLE, y), (height, INK), AFTER);
        }
    }
}
