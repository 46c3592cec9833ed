//! A figure as data: axes, series, guides.

use serde::Deserialize;

use crate::report::{Axis, Dash, Symbol};

/// A point with an optional error bar.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Point {
    /// Abscissa.
    pub x: f64,
    /// Ordinate; a value that is not finite breaks the line.
    pub y: f64,
    /// Standard error of `y`, drawn as a bar of ± that length. An error that is not finite is not known: the point is then
    /// no result, and its mark is open and grey. `None` for a number without a statistical error.
    pub error: Option<f64>,
    /// What a reader sees who points at it.
    pub note: Option<String>,
    /// A page that a click on it opens, beside the page with the figure.
    pub link: Option<String>,
    /// Lowest and highest abscissa of a value that was measured many times, drawn as a bar without ends.
    pub x_range: Option<(f64, f64)>,
    /// A word or a number written beside it.
    pub label: Option<String>,
}

impl Point {
    /// Whether the value has an error that is not known, so that it is no result.
    pub(crate) fn is_no_result(&self) -> bool {
        self.error.is_some_and(|error| !error.is_finite())
    }
}

impl From<(f64, f64)> for Point {
    fn from((x, y): (f64, f64)) -> Self {
        Self { x, y, ..Self::default() }
    }
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// A line: theory, or a densely sampled run.
    Line(Dash),
    /// Marks: measurement.
    Points(Symbol),
    /// Marks joined by a thin line.
    LineAndPoints(Dash, Symbol),
}

impl Look {
    /// The line of the `index`-th series.
    #[must_use]
    pub fn line(index: usize) -> Self {
        Self::Line(Dash::cycle(index))
    }

    /// The marks of the `index`-th series.
    pub(crate) fn marks(index: usize) -> Self {
        Self::Points(Symbol::cycle(index))
    }

    /// The marks of the `index`-th series, joined by its line.
    pub(crate) fn joined(index: usize) -> Self {
        Self::LineAndPoints(Dash::cycle(index), Symbol::cycle(index))
    }
}

/// One set of points under one name.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; an empty one keeps it out.
    pub name: String,
    /// Line, marks or both.
    pub look: Look,
    /// Index of its colour, going round [`crate::report::COLORS`].
    pub color: usize,
    /// The points, in drawing order.
    pub points: Vec<Point>,
    /// Where there is no value because the run failed: drawn as crosses along the upper edge, whatever the ordinate.
    pub failures: Vec<Point>,
}

impl Series {
    /// A series from pairs, or from points with error bars and notes.
    #[must_use]
    pub fn new<P: Into<Point>>(
        name: impl Into<String>,
        look: Look,
        color: usize,
        points: impl IntoIterator<Item = P>,
    ) -> Self {
        Self {
            name: name.into(),
            look,
            color,
            points: points.into_iter().map(Into::into).collect(),
            failures: Vec::new(),
        }
    }

    /// An entry of the legend without points.
    pub(crate) fn entry(name: impl Into<String>, look: Look, color: usize) -> Self {
        Self::new(name, look, color, std::iter::empty::<Point>())
    }

    /// Marks failed runs, of which the abscissa and the note are shown.
    pub(crate) fn with_failures<P: Into<Point>>(
        self,
        failures: impl IntoIterator<Item = P>,
    ) -> Self {
        Self { failures: failures.into_iter().map(Into::into).collect(), ..self }
    }
}

/// A thin line, or a tinted strip, across the figure with a word beside it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Guide {
    /// At this abscissa, from bottom to top.
    Vertical(f64, String),
    /// At this ordinate, from left to right.
    Horizontal(f64, String),
    /// From the lower edge up to this ordinate, tinted: below it values say nothing.
    UpTo(f64, String),
    /// From the left edge up to this abscissa, tinted: what lies there is left out of means.
    Before(f64, String),
}

/// A figure with two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// File stem.
    pub name: String,
    /// Heading inside the figure.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn, the first lowest.
    pub series: Vec<Series>,
    /// Lines across.
    pub guides: Vec<Guide>,
}

impl Figure {
    /// A figure without series yet.
    #[must_use]
    pub fn new(name: impl Into<String>, title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            x,
            y,
            series: Vec::new(),
            guides: Vec::new(),
        }
    }

    /// Adds a series.
    pub(crate) fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Adds a horizontal guide, with a word beside it or none.
    pub(crate) fn level(self, at: f64, word: impl Into<String>) -> Self {
        self.guided(Guide::Horizontal(at, word.into()))
    }

    /// Whether no series has a point that the axes can show.
    pub(crate) fn is_empty(&self) -> bool {
        let mut points = self.series.iter().flat_map(|s| &s.points);
        !points.any(|point| self.x.can_show(point.x) && self.y.can_show(point.y))
    }

    /// Adds a guide.
    pub(crate) fn guided(mut self, guide: Guide) -> Self {
        self.guides.push(guide);
        self
    }
}
