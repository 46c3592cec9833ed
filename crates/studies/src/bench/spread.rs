//! Median and range of repeats.

use lennard_report::significant;
use serde::Serialize;

use crate::settings::{BUSY, lowest_median_highest};

/// What repeats of one measurement gave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// The middle one; the mean of the two in the middle where their number is even.
    pub median: f64,
    /// The smallest.
    pub lowest: f64,
    /// The largest.
    pub highest: f64,
}

impl Spread {
    /// # Panics
    /// Where there are no values: nothing is measured less than once.
    pub(super) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        let [lowest, median, highest] =
            lowest_median_highest(&values).expect("measured at least once");
        Self {
            median,
            lowest,
            highest,
        }
    }

    /// The same measurement in other units, where more stays more.
    #[must_use]
    pub(super) fn scaled(self, by: f64) -> Self {
        Self {
            median: self.median * by,
            lowest: self.lowest * by,
            highest: self.highest * by,
        }
    }

    /// For a reader: `12.3 (11.9–13.0)`, the median with its range.
    #[must_use]
    pub fn with_range(self) -> String {
        format!(
            "{} ({}–{})",
            significant(self.median, 3),
            significant(self.lowest, 3),
            significant(self.highest, 3)
        )
    }

    /// Whether the range is so wide that the machine was busy.
    #[must_use]
    pub fn is_scattered(self) -> bool {
        self.highest - self.lowest > BUSY * self.median.abs()
    }

    /// Half the range.
    #[must_use]
    pub fn half_range(self) -> f64 {
        0.5 * (self.highest - self.lowest)
    }
}
