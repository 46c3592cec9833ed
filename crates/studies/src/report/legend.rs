//! The legend of a figure, and the one that figures of a row share.

use crate::report::escape::escape;
use crate::report::sheet::{
    AFTER, INK, LEGEND_ROW, LINE, Place, Sheet, TEXT, WIDTH, color, fitting, text_width,
};
use crate::report::{Figure, Look, Series};

/// Width of the sample in the legend, design units.
const SAMPLE: f64 = 34.0;
/// The fewest entries that figures of a row share in one legend.
const FEWEST_SHARED: usize = 4;

/// An entry of a legend.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    name: String,
    look: Look,
    color: usize,
}

impl Entry {
    fn of(series: &Series) -> Self {
        Self { name: series.name.clone(), look: series.look, color: series.color }
    }

    /// Whether two entries say the same, be the marks joined by a line or not.
    fn is_like(&self, other: &Self) -> bool {
        let mark = |look: Look| match look {
            Look::Line(_) => None,
            Look::Points(symbol) | Look::LineAndPoints(_, symbol) => Some(symbol),
        };
        let [own, others] = [self, other].map(|e| (&e.name, e.color, mark(e.look)));
        own == others
    }

    fn sample(&self, sheet: &mut Sheet, (x, y): Place) {
        let paint = color(self.color);
        if let Look::Line(dash) | Look::LineAndPoints(dash, _) = self.look {
            sheet.line(&[(x, y), (x + SAMPLE - 6.0, y)], dash, paint, LINE);
        }
        if let Look::Points(symbol) | Look::LineAndPoints(_, symbol) = self.look {
            sheet.symbol(symbol, (x + 0.5 * SAMPLE - 3.0, y), paint);
        }
    }
}

/// The entries of a figure.
fn entries(figure: &Figure) -> impl Iterator<Item = Entry> {
    figure.series.iter().filter(|series| !series.name.is_empty()).map(Entry::of)
}

/// The entries that figures of a row share; none where they are few, or of one figure alone.
pub(crate) fn shared<'a>(figures: impl Iterator<Item = &'a Figure>) -> Vec<Entry> {
    let all: Vec<Vec<Entry>> = figures.map(|figure| entries(figure).collect()).collect();
    let Some(first) = all.first() else {
        return Vec::new();
    };
    let is_in = |entry: &Entry, entries: &[Entry]| entries.iter().any(|e| e.is_like(entry));
    let mut others = all[1..].iter();
    let mut shared = first.clone();
    shared.retain(|entry| others.clone().any(|entries| is_in(entry, entries)));
    // A legend in two places is harder to read than two.
    let are_most = shared.len() >= FEWEST_SHARED && 4 * shared.len() >= 3 * first.len();
    match are_most && others.all(|entries| entries.iter().any(|e| is_in(e, &shared))) {
        true => shared,
        false => Vec::new(),
    }
}

/// A legend of a page, beside the figures that share it.
pub(crate) fn to_html(entries: &[Entry]) -> String {
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

/// The legend below the plot, in as many columns as the names allow.
pub(crate) struct Legend {
    entries: Vec<Entry>,
    columns: usize,
    failures: bool,
}

impl Legend {
    /// The legend of a figure without the entries of one that stands beside it.
    pub(crate) fn of(figure: &Figure, beside: &[Entry]) -> Self {
        let is_beside = |entry: &Entry| beside.iter().any(|e| e.is_like(entry));
        let entries: Vec<Entry> = entries(figure).filter(|entry| !is_beside(entry)).collect();
        let widest = entries.iter().map(|e| text_width(&e.name, TEXT)).fold(0.0, f64::max);
        let columns = ((WIDTH - 16.0) / (widest + SAMPLE + 8.0)).floor() as usize;
        Self {
            columns: columns.clamp(1, entries.len().max(1)),
            entries,
            failures: figure.series.iter().any(|s| !s.failures.is_empty()),
        }
    }

    fn rows(&self) -> usize {
        self.entries.len().div_ceil(self.columns)
    }

    pub(crate) fn height(&self) -> f64 {
        (self.rows() + usize::from(self.failures)) as f64 * LEGEND_ROW
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
        if self.failures {
            let y = top + (self.rows() as f64 + 0.5) * LEGEND_ROW;
            sheet.failure((8.0 + 0.5 * SAMPLE - 3.0, y), 4.2, INK);
            sheet.text("failed: no value", (8.0 + SAMPLE, y), (TEXT, INK), AFTER);
        }
    }
}
