//! A measured number beside a reference, and what follows.

use serde::Serialize;

/// What a comparison says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Within the tolerance.
    Agrees,
    /// Outside the tolerance.
    Differs,
    /// Outside the tolerance, as a known bias of the run makes it.
    Biased,
    /// Shown beside a reference, and not judged: the state is no single stable phase, or the reference is of
    /// another kind.
    NotJudged,
    /// There is no reference for it.
    NoReference,
}

impl Verdict {
    /// A word or two for a table.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Differs => "differs",
            Self::Biased => "biased by the short cutoff",
            Self::NotJudged => "not judged",
            Self::NoReference => "no reference",
        }
    }
}

/// A quantity of a run beside its reference. Numbers that are not finite are `null` in JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// What it is, as in the run record.
    pub quantity: String,
    /// Unit.
    pub unit: String,
    /// Measured mean.
    pub measured: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Value of the reference at the measured state.
    pub reference: Option<f64>,
    /// One standard error of the reference, where its source gives one.
    pub reference_error: Option<f64>,
    /// Measured − reference.
    pub difference: Option<f64>,
    /// Standard error of the difference, that of the reference included where there is one.
    pub combined_error: Option<f64>,
    /// The difference in combined standard errors.
    pub in_standard_errors: Option<f64>,
    /// The largest difference at which the two are said to agree, and what it is made of.
    pub tolerance: Option<f64>,
    /// What the tolerance is, in words.
    pub tolerance_words: String,
    /// What the verdict is.
    pub verdict: Verdict,
    /// The reference.
    pub source: String,
    /// Corrections made and what else is to be known.
    pub remark: String,
}

/// How far a difference may go: so many combined standard errors, and something for what errors do not count.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerance {
    pub(super) errors: f64,
    pub(super) absolute: f64,
    pub(super) relative: f64,
}

impl Tolerance {
    fn of(self, combined: f64, reference: f64) -> f64 {
        self.errors * combined + self.absolute + self.relative * reference.abs()
    }

    fn words(self) -> String {
        let mut words = format!("{} standard errors", self.errors);
        if self.absolute > 0.0 {
            words += &format!(" + {}", self.absolute);
        }
        if self.relative > 0.0 {
            words += &format!(" + {} %", 100.0 * self.relative);
        }
        words
    }
}

impl Row {
    /// A measured quantity for which there is no reference yet.
    pub(super) fn measured(quantity: &str, unit: &str, mean: f64, error: f64) -> Self {
        Self {
            quantity: quantity.into(),
            unit: unit.into(),
            measured: mean,
            standard_error: error,
            reference: None,
            reference_error: None,
            difference: None,
            combined_error: None,
            in_standard_errors: None,
            tolerance: None,
            tolerance_words: String::new(),
            verdict: Verdict::NoReference,
            source: String::new(),
            remark: String::new(),
        }
    }

    /// Sets a reference beside it; `error` is the standard error of the measured side of the difference.
    pub(super) fn against(
        mut self,
        reference: f64,
        reference_error: Option<f64>,
        error: f64,
        tolerance: Tolerance,
        source: &str,
    ) -> Self {
        let combined = error.hypot(reference_error.unwrap_or(0.0));
        let difference = self.measured - reference;
        let allowed = tolerance.of(combined, reference);
        self.reference = Some(reference);
        self.reference_error = reference_error;
        self.difference = Some(difference);
        self.combined_error = Some(combined);
        self.in_standard_errors = Some(difference / combined);
        self.tolerance = Some(allowed);
        self.tolerance_words = tolerance.words();
        self.verdict = if difference.abs() <= allowed {
            Verdict::Agrees
        } else {
            Verdict::Differs
        };
        self.source = source.to_owned();
        self
    }

    /// Takes the measured value for anywhere between two, where it is not known which of them the reference is of: the
    /// difference is then that of the nearest one. Without a reference nothing changes.
    pub(super) fn between(mut self, low: f64, high: f64) -> Self {
        if let (Some(reference), Some(combined), Some(allowed)) =
            (self.reference, self.combined_error, self.tolerance)
            && low <= high
        {
            let difference = reference.max(low).min(high) - reference;
            self.difference = Some(difference);
            self.in_standard_errors = Some(difference / combined);
            self.verdict = if difference.abs() <= allowed {
                Verdict::Agrees
            } else {
                Verdict::Differs
            };
        }
        self
    }

    /// Adds what is to be known.
    pub(super) fn noted(mut self, remark: impl Into<String>) -> Self {
        let remark = remark.into();
        if !remark.is_empty() {
            if !self.remark.is_empty() {
                self.remark += "; ";
            }
            self.remark += &remark;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: Tolerance = Tolerance {
        errors: 4.0,
        absolute: 0.003,
        relative: 0.0,
    };

    #[test]
    fn a_verdict_weighs_both_errors_and_the_allowance() {
        let row = |measured| {
            Row::measured("u", "ε", measured, 3e-4).against(-5.0, Some(4e-4), 3e-4, TOLERANCE, "x")
        };
        // 4·√(3² + 4²)·1e-4 + 0.003 = 0.005.
        assert_eq!(row(-5.0049).verdict, Verdict::Agrees);
        assert_eq!(row(-5.0051).verdict, Verdict::Differs);
        assert!((row(-4.999).in_standard_errors.unwrap() - 2.0).abs() < 1e-9);
        assert_eq!(row(f64::NAN).verdict, Verdict::Differs);
    }

    #[test]
    fn a_value_known_to_lie_in_a_stretch_differs_by_its_distance_from_it() {
        let row = |low, high| {
            Row::measured("d", "σ²/τ", high, 3e-4)
                .against(-5.0, Some(4e-4), 3e-4, TOLERANCE, "x")
                .between(low, high)
        };
        let inside = row(-5.1, -4.9);
        assert_eq!(
            (inside.difference, inside.verdict),
            (Some(0.0), Verdict::Agrees)
        );
        let above = row(-4.998, -4.9);
        assert!((above.in_standard_errors.unwrap() - 4.0).abs() < 1e-9);
        assert_eq!(above.verdict, Verdict::Agrees);
        assert_eq!(row(-5.2, -5.01).verdict, Verdict::Differs);
        // What is no stretch changes nothing.
        assert_eq!(row(f64::NAN, f64::NAN).verdict, Verdict::Differs);
    }
}
