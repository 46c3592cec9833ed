//! A measured number beside a reference, and what follows.

use lennard_io::AverageRecord;
use lennard_observables::{Allowed, Estimate, Reference, Verdict, judge};
use serde::Serialize;

/// A quantity of a run beside its reference. Numbers that are not finite are `null` in JSON.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Row {
    /// What it is, as in the run record.
    pub quantity: String,
    /// Unit.
    pub unit: String,
    /// Whether it is among the few that people look for first.
    pub primary: bool,
    /// Measured mean.
    pub measured: f64,
    /// Its standard error; not a number where the run does not give one.
    pub standard_error: f64,
    /// The standard error is itself known to this part of its value.
    pub error_known_to: f64,
    /// Value of the reference at the measured state.
    pub reference: Option<f64>,
    /// One standard error of the reference, where its source gives one.
    pub reference_error: Option<f64>,
    /// How far the reference may be off by a finite-size term that is not small, or not trusted.
    pub finite_size_uncertainty: Option<f64>,
    /// Measured − reference; where there is a range, its distance from the reference (zero inside).
    pub difference: Option<f64>,
    /// The range in which the measured value lies, where it is not known which correction the reference contains.
    pub measured_range: Option<[f64; 2]>,
    /// Standard error of the difference, with the error of the reference where there is one.
    pub combined_error: Option<f64>,
    /// The difference over its standard error.
    pub in_standard_errors: Option<f64>,
    /// The largest difference at which the two are said to agree.
    pub tolerance: Option<f64>,
    /// The size beside which a difference is small or large; a tolerance above 5 % of it sees nothing.
    pub scale: Option<f64>,
    /// What the tolerance is made of, in words.
    pub tolerance_words: String,
    /// The difference that a known bias of the run makes, where it can be predicted.
    pub predicted_bias: Option<f64>,
    /// What can be said.
    pub verdict: Verdict,
    /// Why, in a few words.
    pub reason: String,
    /// The reference.
    pub source: String,
    /// Corrections made and what else is to be known.
    pub remark: String,
}

/// The standard error is said to be uncertain where it is known to less than this part of its value.
const UNCERTAIN_ERROR: f64 = 0.2;

/// How far a difference may go: so many combined standard errors, and something for what errors do not count.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerance {
    errors: f64,
    absolute: f64,
    relative: f64,
    finite_size: f64,
}

impl Tolerance {
    /// So many combined standard errors, a difference, and a part of the reference.
    pub(super) const fn new(errors: f64, absolute: f64, relative: f64) -> Self {
        Self { errors, absolute, relative, finite_size: 0.0 }
    }

    /// The same where the reference itself is known to be off by up to `own`, rounded up to two digits.
    pub(super) fn for_reference(self, own: Option<f64>) -> Self {
        let absolute = own.map_or(self.absolute, rounded_up);
        Self { absolute, ..self }
    }

    /// The same where a finite-size term of the reference is no better than `uncertainty`.
    pub(super) fn holding(self, uncertainty: Option<f64>) -> Self {
        let finite_size = uncertainty.map_or(0.0, rounded_up);
        Self { finite_size, ..self }
    }

    fn of(self, combined: f64, reference: f64) -> f64 {
        self.errors * combined + self.absolute + self.relative * reference.abs() + self.finite_size
    }

    fn words(self) -> String {
        let mut words = format!("{} standard errors", self.errors);
        if self.absolute > 0.0 {
            words += &format!(" + {}", self.absolute);
        }
        if self.relative > 0.0 {
            words += &format!(" + {} %", 100.0 * self.relative);
        }
        if self.finite_size > 0.0 {
            words += &format!(" + {} of the finite-size term", self.finite_size);
        }
        words
    }
}

/// The next larger number of two digits: 0.1551 becomes 0.16.
fn rounded_up(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return x;
    }
    /// A number of two digits may be above itself by rounding.
    const ROUNDING: f64 = 1e-9;
    let last_digit = 10_f64.powf(x.log10().floor() - 1.0);
    let up = (x / last_digit - ROUNDING).ceil() * last_digit;
    format!("{up:.1e}").parse().unwrap_or(up)
}

impl Row {
    /// An average of a run, with what speaks against it, and no reference yet.
    pub(crate) fn measured(quantity: &str, average: &AverageRecord) -> Self {
        let error_known_to = 1.0 / (2.0 * average.estimate.freedom).sqrt();
        Self {
            quantity: quantity.into(),
            unit: average.unit.clone(),
            measured: average.estimate.mean,
            standard_error: average.estimate.standard_error,
            error_known_to,
            verdict: average.standing.into(),
            reason: average.reason.clone(),
            ..Self::default()
        }
    }

    /// The measured mean with its error.
    pub(crate) fn mean(&self) -> Estimate {
        Estimate::new(self.measured, self.standard_error, f64::NAN)
    }

    /// The difference from the reference with its error, where there is one.
    pub(crate) fn off(&self) -> Option<(f64, f64)> {
        self.difference.zip(self.combined_error)
    }

    /// Whether nothing speaks against the measured side, so that it may be held against a reference.
    pub(super) fn is_sound(&self) -> bool {
        self.verdict == Verdict::NoReference || self.verdict.is_judged()
    }

    /// The verdict and its reason for a cell of a table.
    pub(crate) fn verdict_words(&self) -> String {
        let words = match (self.verdict, self.reason.as_str(), self.predicted_bias) {
            (Verdict::PredictedBias, _, Some(bias)) => {
                format!("predicted bias of {}", crate::report::signed(bias, 2))
            }
            (Verdict::NoReference, "", _) => "–".into(),
            (verdict, "", _) => verdict.words().into(),
            (verdict, reason, _) => format!("{}: {reason}", verdict.words()),
        };
        if self.is_sound() && self.error_known_to > UNCERTAIN_ERROR {
            return format!("{words} (error known to {:.0} %)", 100.0 * self.error_known_to);
        }
        words
    }

    /// Whether the reason would fill several lines of a cell, so that it stands below the table. A predicted bias has a cell of its own.
    pub(crate) fn has_long_reason(&self) -> bool {
        const LONGEST: usize = 20;
        self.reason.chars().count() > LONGEST && self.verdict != Verdict::PredictedBias
    }

    /// Sets a reference with its own error beside a sound number. A number that is no result is left as it is.
    pub(super) fn against(
        self,
        reference: f64,
        reference_error: Option<f64>,
        tolerance: Tolerance,
        source: &str,
    ) -> Self {
        let combined = self.standard_error.hypot(reference_error.unwrap_or(0.0));
        let mut row = self.against_with_error(reference, combined, tolerance, source);
        row.reference_error = row.reference.and(reference_error);
        row
    }

    /// Sets a reference beside a sound number, with the standard error of the difference.
    pub(super) fn against_with_error(
        mut self,
        reference: f64,
        combined: f64,
        tolerance: Tolerance,
        source: &str,
    ) -> Self {
        if !self.is_sound() || !combined.is_finite() {
            return self;
        }
        let difference = self.measured - reference;
        let allowed = tolerance.of(combined, reference);
        self.reference = Some(reference);
        self.difference = Some(difference);
        self.combined_error = Some(combined);
        self.in_standard_errors = Some(difference / combined);
        self.tolerance = Some(allowed);
        let scale = *self.scale.get_or_insert(reference.abs());
        let share = crate::report::significant(100.0 * allowed / scale, 3);
        self.tolerance_words = format!("{}, {share} % of its scale", tolerance.words());
        self.judge();
        self.source = source.to_owned();
        self
    }

    fn judge(&mut self) {
        let (Some(difference), Some(tolerance), Some(scale)) =
            (self.difference, self.tolerance, self.scale)
        else {
            return;
        };
        let allowed = Allowed { scale, bias: self.predicted_bias, ..Allowed::within(tolerance) };
        self.verdict = judge(difference, Reference::value(0.0), allowed);
        self.reason = match self.verdict {
            Verdict::Differs => "not explained".into(),
            _ => String::new(),
        };
    }

    /// Takes a bias that the run is known to have. It explains a difference that is this bias, within the tolerance and a third
    /// of the bias.
    pub(super) fn biased_by(mut self, bias: f64, because: &str) -> Self {
        self.predicted_bias = Some(bias);
        self.judge();
        match self.verdict {
            Verdict::PredictedBias => because.clone_into(&mut self.reason),
            Verdict::Differs => {
                let bias = crate::report::signed(bias, 2);
                self.reason += &format!(": {because} makes {bias}");
            }
            _ => {}
        }
        self
    }

    /// Takes the measured value for anywhere between two values, where the source does not say which of them it gives. The
    /// difference is then the distance to the nearest value. Without a reference nothing changes.
    pub(super) fn between(mut self, low: f64, high: f64) -> Self {
        if let (Some(reference), Some(combined)) = (self.reference, self.combined_error)
            && low <= high
        {
            let difference = reference.max(low).min(high) - reference;
            self.difference = Some(difference);
            self.measured_range = Some([low, high]);
            self.in_standard_errors = Some(difference / combined);
            self.judge();
        }
        self
    }

    /// Whether the reference lies in the range that the measurement stands for.
    pub(crate) fn is_in_range(&self) -> bool {
        self.measured_range.is_some() && self.difference == Some(0.0)
    }

    /// What the difference is taken from, where that is a range and not the measured value.
    pub(crate) fn range_words(&self) -> Option<String> {
        self.measured_range.map(|[low, high]| {
            format!(
                "the difference is taken from the range {low:.4} to {high:.4}, without and with the finite-size correction; the \
                 source names no correction"
            )
        })
    }

    /// The same with the reason why nothing stands beside it; a row that is no result keeps its own.
    pub(super) fn without_reference(self, why: impl Into<String>) -> Self {
        match self.is_sound() {
            true => Self { reason: why.into(), ..self },
            false => self,
        }
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
mod tests;
