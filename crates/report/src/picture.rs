//! A drawing with the words below it.

use crate::{BarFigure, Figure, ParticleFigure, ReportError};

/// A drawing of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawing {
    /// Points and lines.
    Plot(Figure),
    /// Bars in groups.
    Bars(BarFigure),
    /// Particles in their box.
    Particles(ParticleFigure),
}

impl From<Figure> for Drawing {
    fn from(figure: Figure) -> Self {
        Self::Plot(figure)
    }
}

impl From<BarFigure> for Drawing {
    fn from(figure: BarFigure) -> Self {
        Self::Bars(figure)
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
    /// A drawing with its caption and the file with its numbers.
    #[must_use]
    pub fn new(
        drawing: impl Into<Drawing>,
        caption: impl Into<String>,
        data: impl Into<String>,
    ) -> Self {
        Self {
            drawing: drawing.into(),
            caption: caption.into(),
            data: data.into(),
        }
    }

    /// File stem.
    #[must_use]
    pub fn name(&self) -> &str {
        match &self.drawing {
            Drawing::Plot(figure) => &figure.name,
            Drawing::Bars(figure) => &figure.name,
            Drawing::Particles(figure) => &figure.name,
        }
    }

    /// The drawing as one SVG text.
    ///
    /// # Errors
    /// [`ReportError`] where it cannot be drawn.
    pub fn to_svg(&self) -> Result<String, ReportError> {
        match &self.drawing {
            Drawing::Plot(figure) => figure.to_svg(),
            Drawing::Bars(figure) => figure.to_svg(),
            Drawing::Particles(figure) => figure.to_svg(),
        }
    }
}
