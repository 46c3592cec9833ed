//! Why an observable cannot be built.

use lennard_core::PeriodicBox;
use lennard_core::options::upper_bound;

/// An option that cannot be: which key of the observable's table, what was found, what is allowed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{key}` is {found}; allowed: {allowed}")]
pub struct ObservableError {
    key: &'static str,
    found: String,
    allowed: String,
}

impl ObservableError {
    pub(crate) fn new(
        key: &'static str,
        found: impl std::fmt::Display,
        allowed: impl Into<String>,
    ) -> Self {
        Self { key, found: found.to_string(), allowed: allowed.into() }
    }

    /// The key in the observable's table (`r_max`).
    #[must_use]
    pub fn key(&self) -> &'static str {
        self.key
    }

    /// The value found.
    #[must_use]
    pub fn found(&self) -> &str {
        &self.found
    }

    /// What is allowed, in words.
    #[must_use]
    pub fn allowed(&self) -> &str {
        &self.allowed
    }
}

/// Checks that an optional number is finite and positive.
pub(crate) fn positive(key: &'static str, value: Option<f64>) -> Result<(), ObservableError> {
    match value {
        Some(v) if !(v.is_finite() && v > 0.0) => {
            Err(ObservableError::new(key, v, "a finite number greater than 0"))
        }
        _ => Ok(()),
    }
}

/// Checks that an optional distance in σ is positive, and at most half the shortest side of the box.
pub(crate) fn within_box(
    key: &'static str,
    value: Option<f64>,
    cell: &PeriodicBox,
) -> Result<(), ObservableError> {
    positive(key, value)?;
    let largest = cell.largest_cutoff();
    match value {
        Some(distance) if distance > largest => Err(ObservableError::new(
            key,
            distance,
            format!("at most half the shortest side of the box, {}", upper_bound(largest)),
        )),
        _ => Ok(()),
    }
}

/// Checks that a whole number lies in a range.
pub(crate) fn within(
    key: &'static str,
    value: usize,
    range: std::ops::RangeInclusive<usize>,
) -> Result<(), ObservableError> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(ObservableError::new(
        key,
        value,
        format!("a whole number from {} to {}", range.start(), range.end()),
    ))
}
