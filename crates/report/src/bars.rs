//! Horizontal bars: cost or speed of named things.

use plotters::style::WHITE;
use plotters::style::text_anchor::{HPos, VPos};

use crate::canvas::{GREY, GRID, INK, Sheet, TEXT, WIDTH, color, dress, font, text_width};
use crate::number::significant;
use crate::{Axis, Dash, ReportError};

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
        let zero = (self.axis.scale == crate::Scale::Linear).then_some(0.0);
        let span = self.axis.span(&self.name, values.chain(zero))?;

        let names = self
            .groups
            .iter()
            .map(|g| text_width(g, TEXT))
            .fold(0.0, f64::max)
            .min(NAMES * WIDTH);
        let (left, right) = (names + 16.0, WIDTH - 90.0);
        let group_height = BAR * self.series.len() as f64 + GAP;
        let bottom = TOP + group_height * self.groups.len() as f64;
        let legend_rows = if self.series.len() > 1 {
            self.series.len()
        } else {
            0
        };
        let height = bottom + 2.0 * TEXT + 34.0 + 24.0 * legend_rows as f64;
        let place =
            |v: f64| left + span.fraction(v).unwrap_or(0.0).clamp(0.0, 1.0) * (right - left);
        let start = if self.axis.scale == crate::Scale::Linear {
            place(0.0)
        } else {
            left
        };

        let mut svg = String::new();
        {
            let sheet = Sheet::new(&self.name, &mut svg, height);
            sheet.area.fill(&WHITE).map_err(|e| sheet.failed(e))?;
            sheet.title(&self.title)?;
            for tick in span.ticks() {
                let x = place(*tick);
                sheet.line(&[(x, TOP), (x, bottom)], Dash::Solid, GRID, 1.0)?;
                let label = span.label(*tick);
                sheet.text(
                    &label,
                    (x, bottom + 6.0),
                    font(TEXT, INK),
                    HPos::Center,
                    VPos::Top,
                )?;
            }
            let middle = 0.5 * (left + right);
            let below = bottom + TEXT + 14.0;
            sheet.text(
                &self.axis.label,
                (middle, below),
                font(TEXT, INK),
                HPos::Center,
                VPos::Top,
            )?;
            for (g, group) in self.groups.iter().enumerate() {
                let top = TOP + 0.5 * GAP + g as f64 * group_height;
                let centre = top + 0.5 * (group_height - GAP);
                let size = TEXT * (names / text_width(group, TEXT)).min(1.0);
                sheet.text(
                    group,
                    (left - 8.0, centre),
                    font(size, INK),
                    HPos::Right,
                    VPos::Center,
                )?;
                for (s, series) in self.series.iter().enumerate() {
                    let y = top + s as f64 * BAR;
                    let at = |x: f64| (x, y + 0.5 * BAR);
                    let Some((value, error)) = series.values[g] else {
                        sheet.failure(at(start + 8.0), 5.0, color(series.color))?;
                        sheet.text(
                            "failed",
                            at(start + 20.0),
                            font(TEXT, GREY),
                            HPos::Left,
                            VPos::Center,
                        )?;
                        continue;
                    };
                    let end = place(value);
                    let (from, to) = (start.min(end), start.max(end));
                    sheet.filled_rectangle(
                        (from, y + 1.0),
                        (to, y + BAR - 1.0),
                        color(series.color),
                    )?;
                    let mut text_from = to;
                    if let Some(e) = error.filter(|e| *e > 0.0) {
                        let (a, b) = (place(value - e), place(value + e));
                        sheet.line(&[at(a), at(b)], Dash::Solid, INK, 1.4)?;
                        text_from = text_from.max(b);
                    }
                    let label = significant(value, 3);
                    sheet.text(
                        &label,
                        at(text_from + 5.0),
                        font(0.94 * TEXT, INK),
                        HPos::Left,
                        VPos::Center,
                    )?;
                }
            }
            sheet.line(&[(start, TOP), (start, bottom)], Dash::Solid, GREY, 1.2)?;
            for (row, series) in self.series.iter().enumerate().take(legend_rows) {
                let y = below + TEXT + 14.0 + 24.0 * row as f64;
                sheet.filled_rectangle((8.0, y), (28.0, y + 14.0), color(series.color))?;
                sheet.text(
                    &series.name,
                    (36.0, y + 7.0),
                    font(TEXT, INK),
                    HPos::Left,
                    VPos::Center,
                )?;
            }
            sheet.finish()?;
        }
        Ok(dress(&svg, &self.title, &[]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> BarFigure {
        BarFigure {
            name: "cost".into(),
            title: "Cost".into(),
            axis: Axis::linear("ns an atom and step"),
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
        for word in ["40.0", "failed", "implicit-euler", "ns an atom and step"] {
            assert!(svg.contains(word), "{word}");
        }
    }

    #[test]
    fn a_bar_too_few_is_an_error() {
        let mut wrong = example();
        wrong.series[0].values.pop();
        assert!(matches!(
            wrong.to_svg(),
            Err(ReportError::BarCount {
                found: 1,
                wanted: 2,
                ..
            })
        ));
    }
}
