//! Horizontal bars: cost or speed of named things.

use lennard_core::number::significant;

use crate::report::axis::Span;
use crate::report::sheet::{
    AFTER, BEFORE, BELOW, GREY, GRID, INK, LEGEND_ROW, Sheet, TEXT, WIDTH, color, fitting,
    text_width,
};
use crate::report::{Axis, Dash, ReportError};

/// Height of a bar, design units.
const BAR: f64 = 20.0;
/// Room between groups, design units.
const GAP: f64 = 14.0;
/// Room above the first group for the title, design units.
const TOP: f64 = 40.0;
/// Largest share of the width that names may take.
const NAMES: f64 = 0.42;

/// One bar in each group.
#[derive(Debug, Clone, PartialEq)]
pub struct BarSeries {
    /// Name in the legend.
    pub name: String,
    /// Index of its colour.
    pub color: usize,
    /// Value and standard error for each group; `None` where it failed, and it is said so.
    pub values: Vec<Option<(f64, Option<f64>)>>,
}

/// Groups of horizontal bars, with the value written at the end of each.
#[derive(Debug, Clone, PartialEq)]
pub struct BarFigure {
    /// File stem.
    pub name: String,
    /// Heading inside the figure.
    pub title: String,
    /// The axis of the values; a linear one starts at zero.
    pub axis: Axis,
    /// Names of the groups, from the top.
    pub groups: Vec<String>,
    /// The bars.
    pub series: Vec<BarSeries>,
}

impl BarFigure {
    /// The figure as one SVG text that scales to the width it is given.
    ///
    /// # Errors
    /// [`ReportError`] where nothing can be drawn or a series does not fit the groups.
    pub fn to_svg(&self) -> Result<String, ReportError> {
        for series in &self.series {
            if series.values.len() != self.groups.len() {
                return Err(ReportError::BarCount {
                    figure: self.name.clone(),
                    series: series.name.clone(),
                    found: series.values.len(),
                    wanted: self.groups.len(),
                });
            }
        }
        let values = self
            .series
            .iter()
            .flat_map(|s| s.values.iter().flatten().map(|(v, e)| v + e.unwrap_or(0.0)));
        let is_linear = self.axis.scale == crate::report::Scale::Linear;
        let zero = is_linear.then_some(0.0);
        let span = self.axis.span(&self.name, values.chain(zero))?;

        let widest = self.groups.iter().map(|g| text_width(g, TEXT));
        let names = widest.fold(0.0, f64::max).min(NAMES * WIDTH);
        let group_height = BAR * self.series.len() as f64 + GAP;
        let frame = Frame {
            left: names + 16.0,
            right: WIDTH - 90.0,
            bottom: TOP + group_height * self.groups.len() as f64,
            is_linear,
            span,
        };
        // One series alone needs no legend.
        let legend = if self.series.len() > 1 { &self.series[..] } else { &[] };
        let below = frame.bottom + TEXT + 14.0;
        let height = below + TEXT + 20.0 + LEGEND_ROW * legend.len() as f64;
        let mut sheet = Sheet::titled(&self.title, height);
        for tick in frame.span.ticks() {
            let x = frame.place(*tick);
            sheet.line(&[(x, TOP), (x, frame.bottom)], Dash::Solid, GRID, 1.0);
            let label = frame.span.label(*tick);
            sheet.text(&label, (x, frame.bottom + 6.0), (TEXT, INK), BELOW);
        }
        let middle = 0.5 * (frame.left + frame.right);
        sheet.text(&self.axis.label, (middle, below), (TEXT, INK), BELOW);
        for (g, group) in self.groups.iter().enumerate() {
            let top = TOP + 0.5 * GAP + g as f64 * group_height;
            let centre = top + 0.5 * (group_height - GAP);
            let size = fitting(group, TEXT, names);
            sheet.text(group, (frame.left - 8.0, centre), (size, INK), BEFORE);
            for (s, series) in self.series.iter().enumerate() {
                frame.draw_bar(&mut sheet, series, g, top + s as f64 * BAR);
            }
        }
        let start = frame.start();
        sheet.line(&[(start, TOP), (start, frame.bottom)], Dash::Solid, GREY, 1.2);
        for (row, series) in legend.iter().enumerate() {
            let y = below + TEXT + 14.0 + LEGEND_ROW * row as f64;
            sheet.filled_rectangle((8.0, y), (28.0, y + 14.0), color(series.color));
            sheet.text(&series.name, (36.0, y + 7.0), (TEXT, INK), AFTER);
        }
        Ok(sheet.finish())
    }
}

/// Where names, bars and axis stand, design units.
struct Frame {
    left: f64,
    right: f64,
    bottom: f64,
    is_linear: bool,
    span: Span,
}

impl Frame {
    fn place(&self, value: f64) -> f64 {
        let fraction = self.span.fraction(value).unwrap_or(0.0).clamp(0.0, 1.0);
        self.left + fraction * (self.right - self.left)
    }

    /// Where bars begin.
    fn start(&self) -> f64 {
        if self.is_linear { self.place(0.0) } else { self.left }
    }

    fn draw_bar(&self, sheet: &mut Sheet, series: &BarSeries, g: usize, y: f64) {
        let (start, paint) = (self.start(), color(series.color));
        let at = |x: f64| (x, y + 0.5 * BAR);
        let Some((value, error)) = series.values[g] else {
            sheet.failure(at(start + 8.0), 5.0, paint);
            return sheet.text("failed", at(start + 20.0), (TEXT, GREY), AFTER);
        };
        let end = self.place(value);
        let (from, to) = (start.min(end), start.max(end));
        sheet.filled_rectangle((from, y + 1.0), (to, y + BAR - 1.0), paint);
        let mut text_from = to;
        if let Some(e) = error.filter(|e| *e > 0.0) {
            let (a, b) = (self.place(value - e), self.place(value + e));
            sheet.line(&[at(a), at(b)], Dash::Solid, INK, 1.4);
            text_from = text_from.max(b);
        }
        sheet.text(&significant(value, 3), at(text_from + 5.0), (0.94 * TEXT, INK), AFTER);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> BarFigure {
        BarFigure {
            name: "cost".into(),
            title: "Cost".into(),
            axis: Axis::linear("ns per atom and step"),
            groups: vec!["velocity-verlet".into(), "implicit-euler".into()],
            series: vec![BarSeries {
                name: "double".into(),
                color: 0,
                values: vec![Some((40.0, Some(2.0))), None],
            }],
        }
    }

    #[test]
    fn bars_carry_their_values_and_failures_are_named() {
        let svg = example().to_svg().unwrap();
        assert_eq!(svg, example().to_svg().unwrap());
        for word in ["40.0", "failed", "implicit-euler", "ns per atom and step"] {
            assert!(svg.contains(word), "{word}");
        }
    }

    #[test]
    fn a_bar_too_few_is_an_error() {
        let mut wrong = example();
        wrong.series[0].values.pop();
        assert!(matches!(wrong.to_svg(), Err(ReportError::BarCount { found: 1, wanted: 2, .. })));
    }
}
