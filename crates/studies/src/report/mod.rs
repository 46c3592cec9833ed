//! Figures and self-contained pages from results.
//!
//! A [`Figure`] is plain data and becomes one SVG text. A [`Page`] is plain data and becomes one
//! HTML text with everything inside. The same data give the same bytes: nothing here reads a clock, a font, a file
//! or the environment.

mod axis;
mod draw;
mod escape;
mod figure;
mod in_units;
mod page;
mod palette;
mod particles;
mod picture;
mod sheet;
mod table;
mod written;

pub use axis::{Axis, Scale};
pub use escape::{escape, inline_markup};
pub use figure::{Figure, Guide, Look, Point, Series};
pub use in_units::{in_units, in_words, physical};
pub use lennard_core::number::{
    counted, particles, percent, plain_or_scientific, plus_minus, signed, significant, with_error,
};
pub use page::{Block, Page, Section};
pub use palette::{COLORS, Dash, Symbol};
pub use particles::{ParticleFigure, Sphere};
pub use picture::{Drawing, Picture};
pub use table::{ErrorStyle, cell_text, heading, is_numeric};
pub(crate) use written::{Drawn, Given, filled, pictures, thinned, written};

/// Why a figure cannot be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReportError {
    /// No value of the figure can be shown on its axes.
    #[error("figure `{figure}` has no value that its axes can show")]
    NothingToDraw {
        /// Name of the figure.
        figure: String,
    },
    /// A fixed axis range is empty, not finite, or not positive on a logarithmic axis.
    #[error("figure `{figure}`: the axis `{axis}` cannot run from {low} to {high}")]
    BadRange {
        /// Name of the figure.
        figure: String,
        /// Label of the axis.
        axis: String,
        /// Lower end asked for.
        low: String,
        /// Upper end asked for.
        high: String,
    },
    /// The text of a page names what is not there.
    #[error("the text of the page: {0}")]
    Text(String),
}
