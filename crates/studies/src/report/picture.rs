//! A drawing with the words below it.

use crate::report::{Figure, ParticleFigure, Point, ReportError};

/// What the caption of a figure says where some of its points are no results.
const NO_RESULTS: &str = "Open grey marks have no known error: they are no results.";

/// A drawing of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawing {
    /// Points and lines.
    Plot(Figure),
    /// Particles in their box.
    Particles(ParticleFigure),
}

impl From<Figure> for Drawing {
    fn from(figure: Figure) -> Self {
        Self::Plot(figure)
    }
}

impl From<ParticleFigure> for Drawing {
    fn from(figure: ParticleFigure) -> Self {
        Self::Particles(figure)
    }
}

/// A drawing with its caption.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The drawing.
    pub drawing: Drawing,
    /// What it shows, with inline markup.
    pub caption: String,
    /// Name of the file with the numbers.
    pub data: String,
}

impl Picture {
    /// A drawing with its caption and the file with its numbers. The caption of a plot says which marks are no results.
    #[must_use]
    pub fn new(
        drawing: impl Into<Drawing>,
        caption: impl Into<String>,
        data: impl Into<String>,
    ) -> Self {
        let (drawing, mut caption) = (drawing.into(), caption.into());
        if let Drawing::Plot(figure) = &drawing {
            let mut points = figure.series.iter().flat_map(|series| &series.points);
            if points.any(Point::is_no_result) {
                caption = format!("{caption} {NO_RESULTS}").trim_start().to_owned();
            }
        }
        Self { drawing, caption, data: data.into() }
    }

    /// File stem.
    #[must_use]
    pub fn name(&self) -> &str {
        match &self.drawing {
            Drawing::Plot(figure) => &figure.name,
            Drawing::Particles(figure) => &figure.name,
        }
    }

    /// The drawing as one SVG text.
    ///
    /// # Errors
    /// [`ReportError`] where it cannot be drawn.
    pub(crate) fn to_svg(&self) -> Result<String, ReportError> {
        match &self.drawing {
            Drawing::Plot(figure) => figure.to_svg(),
            Drawing::Particles(figure) => figure.to_svg(),
        }
    }

    /// Its plot, where it is one.
    pub(crate) fn plot(&self) -> Option<&Figure> {
        match &self.drawing {
            Drawing::Plot(figure) => Some(figure),
            _ => None,
        }
    }

    /// The drawing for a page, which has the legend beside it.
    pub(crate) fn to_svg_without_legend(&self) -> Result<String, ReportError> {
        self.plot().map_or_else(|| self.to_svg(), Figure::to_svg_without_legend)
    }
}

#[cfg(test)]
mod tests {
    use crate::report::{Axis, Figure, Look, Picture, Point, Series, Symbol};

    #[test]
    fn a_point_without_a_known_error_is_open_and_grey_and_the_caption_says_so() {
        let point = |x: f64, error: Option<f64>| Point { error, ..Point::from((x, 1.0 + x)) };
        for (error, is_result) in [(None, true), (Some(0.1), true), (Some(f64::NAN), false)] {
            let axes = || Axis::linear("x");
            let figure = Figure::new("f", "F", axes(), axes());
            let points = [point(1.0, Some(0.2)), point(2.0, error)];
            let look = Look::Points(Symbol::Disc);
            let picture =
                Picture::new(figure.with(Series::new("", look, 0, points)), "About.", "f.csv");
            assert_eq!(picture.caption.contains("no results"), !is_result, "{error:?}");
            let svg = picture.to_svg().unwrap();
            let open =
                svg.lines().filter(|l| l.starts_with("<circle") && l.contains("fill=\"none\""));
            assert_eq!(open.count(), usize::from(!is_result), "{error:?}: {svg}");
        }
    }
}
