//! Median and range of repeats.

use serde::Serialize;

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
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        Self {
            median: 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]),
            lowest: sorted[0],
            highest: sorted[n - 1],
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

    /// Half the range.
    #[must_use]
    pub fn half_range(self) -> f64 {
        0.5 * (self.highest - self.lowest)
    }
}
