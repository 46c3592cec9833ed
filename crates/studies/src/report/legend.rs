//! The legend of a figure.

use crate::report::canvas::{AFTER, INK, LINE, MARK, Sheet, TEXT, WIDTH, color, ink, text_width};
use crate::report::{Figure, Look, ReportError, Series};

/// Height of a line of the legend, design units.
pub(crate) const LEGEND_ROW: f64 = 24.0;
/// Width of the sample in the legend, design units.
const SAMPLE: f64 = 34.0;

/// The legend below the plot, in as many columns as the names allow.
pub(crate) struct Legend<'a> {
    entries: Vec<&'a Series>,
    columns: usize,
    failures: bool,
}

impl<'a> Legend<'a> {
    pub(crate) fn of(figure: &'a Figure) -> Self {
        let entries: Vec<&Series> = figure.series.iter().filter(|s| !s.name.is_empty()).collect();
        let widest = entries.iter().map(|s| text_width(&s.name, TEXT)).fold(0.0, f64::max);
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

    pub(crate) fn draw(&self, sheet: &Sheet<'_>, top: f64) -> Result<(), ReportError> {
        let column_width = (WIDTH - 16.0) / self.columns as f64;
        for (i, series) in self.entries.iter().enumerate() {
            let (column, row) = (i / self.rows(), i % self.rows());
            let x = 8.0 + column as f64 * column_width;
            let y = top + (row as f64 + 0.5) * LEGEND_ROW;
            let middle = x + 0.5 * SAMPLE;
            let paint = color(series.color);
            if let Look::Line(dash) | Look::LineAndPoints(dash, _) = series.look {
                sheet.line(&[(x, y), (x + SAMPLE - 6.0, y)], dash, paint, LINE)?;
            }
            if let Look::Points(symbol) | Look::LineAndPoints(_, symbol) = series.look {
                sheet.symbol(symbol, (middle - 3.0, y), MARK, paint)?;
            }
            let room = column_width - SAMPLE - 4.0;
            let height = TEXT * (room / text_width(&series.name, TEXT)).min(1.0);
            sheet.text(&series.name, (x + SAMPLE, y), ink(height), AFTER)?;
        }
        if self.failures {
            let y = top + (self.rows() as f64 + 0.5) * LEGEND_ROW;
            sheet.failure((8.0 + 0.5 * SAMPLE - 3.0, y), MARK, INK)?;
            sheet.text("failed: no value", (8.0 + SAMPLE, y), ink(TEXT), AFTER)?;
        }
        Ok(())
    }
}
