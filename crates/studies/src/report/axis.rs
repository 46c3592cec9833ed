//! Axes: ranges, ticks and their labels.

use lennard_core::number::{significant, superscript};
use serde::Deserialize;

use crate::report::ReportError;

/// Share of a linear range left free at each end.
const LINEAR_MARGIN: f64 = 0.04;
/// Factor left free at each end of a logarithmic range.
const LOGARITHMIC_MARGIN: f64 = 1.3;
/// Labels that fit along an axis at phone width.
const MOST_LABELS: usize = 6;

/// How values are laid along an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Equal differences.
    #[default]
    Linear,
    /// Equal ratios; zero and negative values cannot be shown.
    Logarithmic,
}

/// An axis.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Linear or logarithmic.
    #[serde(default)]
    pub scale: Scale,
    /// Fixed ends; fitted to the values where `None`.
    pub range: Option<(f64, f64)>,
    /// What stands at 0, 1, 2, … where the axis has words in place of numbers.
    #[serde(default)]
    pub words: Vec<String>,
}

impl Axis {
    /// A linear axis fitted to the values.
    #[must_use]
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// An axis with words at 0, 1, 2, …
    pub(crate) fn of_words(label: impl Into<String>, words: Vec<String>) -> Self {
        let end = words.len() as f64 - 0.5;
        Self { words, ..Self::linear(label).from_to(-0.5, end) }
    }

    /// A logarithmic axis fitted to the values.
    #[must_use]
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::linear(label) }
    }

    /// With fixed ends: what lies outside is cut off, and marks outside are shown as arrows at the edge.
    #[must_use]
    pub fn from_to(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }

    /// Whether a value has a place on an axis of this scale.
    pub(crate) fn can_show(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || value > f64::MIN_POSITIVE)
    }

    pub(crate) fn span(
        &self,
        figure: &str,
        values: impl Iterator<Item = f64>,
    ) -> Result<Span, ReportError> {
        let showable = |value: &f64| self.can_show(*value);
        let (low, high) = match self.range {
            Some((low, high)) => {
                if !(showable(&low) && showable(&high) && low < high) {
                    return Err(ReportError::BadRange {
                        figure: figure.into(),
                        axis: self.label.clone(),
                        low: low.to_string(),
                        high: high.to_string(),
                    });
                }
                (low, high)
            }
            None => {
                let (low, high) = values
                    .filter(showable)
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
                if low > high {
                    return Err(ReportError::NothingToDraw { figure: figure.into() });
                }
                self.padded(low, high)
            }
        };
        let span = Span::new(self.scale, low, high);
        Ok(match self.words.len() {
            0 => span,
            n => Span {
                major: (0..n).map(|i| i as f64).collect(),
                words: self.words.clone(),
                ..span
            },
        })
    }

    fn padded(&self, low: f64, high: f64) -> (f64, f64) {
        match self.scale {
            Scale::Linear => {
                let width = high - low;
                let margin = if width > 0.0 && width.is_finite() {
                    LINEAR_MARGIN * width
                } else if low == 0.0 {
                    1.0
                } else {
                    0.1 * low.abs()
                };
                (low - margin, high + margin)
            }
            Scale::Logarithmic => {
                let (low, high) = (low / LOGARITHMIC_MARGIN, high * LOGARITHMIC_MARGIN);
                // Less than a decade would leave no two labels.
                let missing = (10.0 / (high / low)).max(1.0).sqrt();
                (low / missing, high * missing)
            }
        }
    }
}

/// A resolved axis.
#[derive(Debug, Clone)]
pub(crate) struct Span {
    scale: Scale,
    low: f64,
    high: f64,
    step: f64,
    major: Vec<f64>,
    minor: Vec<f64>,
    words: Vec<String>,
}

impl Span {
    fn new(scale: Scale, low: f64, high: f64) -> Self {
        let (step, major, minor) = match scale {
            Scale::Linear => linear_ticks(low, high),
            Scale::Logarithmic => logarithmic_ticks(low, high),
        };
        Self { scale, low, high, step, major, minor, words: Vec::new() }
    }

    /// Where a value lies between the ends, 0 to 1; `None` where it cannot be shown at all.
    pub(crate) fn fraction(&self, value: f64) -> Option<f64> {
        if !value.is_finite() {
            return None;
        }
        match self.scale {
            Scale::Linear => Some((value - self.low) / (self.high - self.low)),
            Scale::Logarithmic if value > 0.0 => {
                Some((value / self.low).log10() / (self.high / self.low).log10())
            }
            Scale::Logarithmic => None,
        }
    }

    /// Values with a label.
    pub(crate) fn ticks(&self) -> &[f64] {
        &self.major
    }

    /// Values with a faint line of the grid.
    pub(crate) fn minor(&self) -> &[f64] {
        &self.minor
    }

    #[cfg(test)]
    pub(crate) fn ends(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// Number of characters of the longest label.
    pub(crate) fn widest_label(&self) -> usize {
        self.major.iter().map(|v| self.label(*v).chars().count()).max().unwrap_or(0)
    }

    pub(crate) fn label(&self, value: f64) -> String {
        if let Some(word) = self.words.get(value as usize) {
            return word.clone();
        }
        let largest = self.low.abs().max(self.high.abs());
        match self.scale {
            Scale::Logarithmic if self.low >= 0.9e-3 && self.high <= 1.1e4 => significant(value, 1),
            Scale::Logarithmic => {
                let exponent = value.log10().floor() as i32;
                match (value / 10f64.powi(exponent)).round() as i32 {
                    1 => format!("10{}", superscript(exponent)),
                    10 => format!("10{}", superscript(exponent + 1)),
                    mantissa => format!("{mantissa}·10{}", superscript(exponent)),
                }
            }
            Scale::Linear if value.abs() < 1e-9 * largest => "0".into(),
            Scale::Linear if (1e-3..1e5).contains(&largest) => {
                let decimals = (-self.step.log10().floor()).clamp(0.0, 9.0) as usize;
                format!("{value:.decimals$}").replace('-', "−")
            }
            Scale::Linear => {
                let decades = largest.log10().floor() - self.step.log10().floor();
                significant(value, decades.clamp(0.0, 8.0) as usize + 1)
            }
        }
    }
}

/// Ticks at multiples of 1, 2 or 5 times a power of ten.
fn linear_ticks(low: f64, high: f64) -> (f64, Vec<f64>, Vec<f64>) {
    let rough = (high - low) / MOST_LABELS as f64;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|s| *s >= rough)
        .unwrap_or(10.0 * power);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    let major = (first..=last).map(|i| i as f64 * step).collect();
    (step, major, Vec::new())
}

/// Ticks at powers of ten, every so many of them; at 2 and 5 too where there are few powers.
fn logarithmic_ticks(low: f64, high: f64) -> (f64, Vec<f64>, Vec<f64>) {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let inside = |v: &f64| (low * (1.0 - 1e-12)..=high * (1.0 + 1e-12)).contains(v);
    let powers: Vec<i32> = (first..=last).filter(|e| inside(&10f64.powi(*e))).collect();
    let with_multiples = |multiples: &[f64]| -> Vec<f64> {
        (first..=last)
            .flat_map(|e| multiples.iter().map(move |m| m * 10f64.powi(e)))
            .filter(inside)
            .collect()
    };
    if powers.len() < 3 {
        let major = with_multiples(&[1.0, 2.0, 5.0]);
        return (1.0, major, with_multiples(&[3.0, 4.0, 6.0, 7.0, 8.0, 9.0]));
    }
    let stride = powers.len().div_ceil(MOST_LABELS) as i32;
    let major =
        powers.iter().filter(|e| e.rem_euclid(stride) == 0).map(|e| 10f64.powi(*e)).collect();
    let minor = if stride == 1 && powers.len() <= 4 {
        with_multiples(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
    } else {
        powers.iter().map(|e| 10f64.powi(*e)).collect()
    };
    (1.0, major, minor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stand_in_place_of_numbers() {
        let axis = Axis::of_words("kind", vec!["cut".into(), "shift".into()]);
        let span = axis.span("f", std::iter::empty()).unwrap();
        let labels: Vec<String> = span.ticks().iter().map(|v| span.label(*v)).collect();
        assert_eq!((labels, span.ends()), (vec!["cut".into(), "shift".into()], (-0.5, 1.5)));
    }

    fn labels(axis: Axis, values: &[f64]) -> Vec<String> {
        let span = axis.span("test", values.iter().copied()).unwrap();
        span.major.iter().map(|v| span.label(*v)).collect()
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        assert_eq!(
            labels(Axis::linear("x"), &[0.0, 1.0]),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"].map(|s| if s == "0.0" { "0" } else { s })
        );
        assert_eq!(labels(Axis::linear("x"), &[-3e7, 3e7]), ["−2·10⁷", "0", "2·10⁷"]);
        assert_eq!(
            labels(Axis::logarithmic("x"), &[1e-12, 1.0]),
            ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰"]
        );
        assert_eq!(labels(Axis::logarithmic("x"), &[0.01, 0.02]), ["0.005", "0.01", "0.02"]);
    }

    #[test]
    fn a_single_value_still_has_an_axis_around_it() {
        for axis in [Axis::linear("x"), Axis::logarithmic("x")] {
            let span = axis.span("test", [7.0].into_iter()).unwrap();
            let (low, high) = span.ends();
            assert!(low < 7.0 && 7.0 < high);
        }
    }

    #[test]
    fn what_cannot_be_shown_is_an_error_or_left_out() {
        let log = Axis::logarithmic("y");
        assert!(matches!(
            log.span("f", [0.0, -1.0, f64::NAN].into_iter()),
            Err(ReportError::NothingToDraw { .. })
        ));
        for (low, high) in [(0.0, 1.0), (2.0, 1.0), (1.0, f64::INFINITY)] {
            assert!(matches!(
                log.clone().from_to(low, high).span("f", std::iter::empty()),
                Err(ReportError::BadRange { .. })
            ));
        }
        let span = log.from_to(1.0, 100.0).span("f", std::iter::empty()).unwrap();
        assert_eq!(span.fraction(10.0), Some(0.5));
        assert_eq!(span.fraction(0.0), None);
    }
}
